# SPDX-License-Identifier: MIT
"""What the same work costs in the Python module and in the program, in turns.

    NLOS_PROGRAM=build/release/apps/nlos PYTHONPATH=build/release/apps/python \\
        python3 tests/benchmark/python_speed.py [repeats]

Compares what both say their work took (the program's start, files and pictures are no part of it),
on one thread, by the median of the ratios of neighbouring runs; and the peak of memory.
"""

import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

import nlos

LETTER = str(pathlib.Path(__file__).resolve().parents[2] / "scenes" / "letter" / "scene.json")


def program(*arguments):
    subprocess.run([os.environ["NLOS_PROGRAM"], *arguments], check=True, capture_output=True)


def works(folder):
    """Name, seconds of the program and seconds of the module of each piece of work."""
    capture, volume, noisy, fit = (str(folder / name) for name in ("c.h5", "v.h5", "n.h5", "f.json"))
    program("render", LETTER, "-o", capture)
    program("simulate-noise", capture, "-o", noisy, "--photons-per-point", "200")
    model = folder / "model.json"
    model.write_text(json.dumps({"scene": LETTER, "free": {"letter": ["pose", "albedo"]}}))
    samples = {"method": "path", "samples": 1024, "threads": 1}

    def render_theirs():
        program("render", LETTER, "-o", capture, "--method", "path", "--samples", "1024", "--threads", "1")
        return nlos.read(capture).scene_info["seconds"]

    def fit_theirs():
        program("fit", noisy, str(model), "-o", fit, "--threads", "1")
        return json.loads(pathlib.Path(fit).read_text())["seconds"]

    yield "render path", render_theirs, lambda: nlos.render(LETTER, **samples).scene_info["seconds"]
    data = nlos.read(noisy)
    for method in ("lct", "fk", "phasor", "solver"):

        def theirs(method=method):
            program("reconstruct", noisy, "-o", volume, "--method", method, "--threads", "1")
            return nlos.read_volume(volume).seconds

        yield f"reconstruct {method}", theirs, lambda method=method: nlos.reconstruct(data, method, threads=1).seconds
    free = {"letter": ["pose", "albedo"]}
    yield "fit", fit_theirs, lambda: nlos.fit(data, LETTER, free=free, threads=1).seconds


def main():
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    print(f"{'work':<20} {'program [s]':>12} {'module [s]':>12} {'ratio':>7}")
    with tempfile.TemporaryDirectory() as folder:
        for name, theirs, ours in works(pathlib.Path(folder)):
            runs = [(theirs(), ours()) for _ in range(repeats)]
            ratio = statistics.median(b / a for a, b in runs)
            print(f"{name:<20} {min(a for a, _ in runs):12.3f} {min(b for _, b in runs):12.3f} {ratio:7.3f}")
    print(f"peak of memory: {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")


if __name__ == "__main__":
    main()
