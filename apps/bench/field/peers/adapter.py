# SPDX-License-Identifier: MIT
"""What all adapters share: they read a request, do its work, and end with a line of JSON."""
import json
import pathlib
import re
import sys
import time


class Timer:
    """CPU time of all threads within `with` blocks [s], in `seconds`."""

    def __init__(self):
        self.seconds = 0.0

    def __enter__(self):
        self.started = time.process_time()

    def __exit__(self, *_):
        self.seconds += time.process_time() - self.started


def render_seeds(request, image_of, scale=1.0):
    """Writes `scale` times `image_of(seed)`, which is (height, width, bins), for every seed; returns CPU times."""
    import h5py
    import numpy as np

    first, timer = Timer(), Timer()
    with first:  # compiles
        image_of(10**6)
    for seed, output in zip(request["seeds"], request["outputs"]):
        with timer:
            image = image_of(seed)
        with h5py.File(output, "w") as file:
            file["H"] = (scale * np.moveaxis(image, -1, 0).swapaxes(1, 2)).astype(np.float32)
    each = timer.seconds / len(request["seeds"])
    return {"work_cpu_s": each, "compile_cpu_s": max(0.0, first.seconds - each)}


def serve(work):
    """Calls `work(request)` and prints the dictionary it returns, with the memory that it took."""
    said = work(json.loads(pathlib.Path(sys.argv[1]).read_text()))
    status = pathlib.Path("/proc/self/status").read_text()
    said["peak_rss_bytes"] = 1024 * int(re.search(r"VmHWM:\s*(\d+)", status)[1])
    print(json.dumps(said))
