# SPDX-License-Identifier: MIT
"""Long calls: progress, interruption, warnings, threads and forks."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
import warnings

import numpy as np
import pytest

import nlos
from conftest import LETTER


def test_progress_is_told_and_can_stop(letter):
    fractions = []
    nlos.render(letter, method="path", samples=512, progress=lambda fraction, text: fractions.append((fraction, text)))
    assert len(fractions) >= 2 and fractions == sorted(fractions, key=lambda s: s[0])
    assert fractions[-1][0] == pytest.approx(1.0)
    stopped = nlos.render(letter, method="path", samples=1_000_000, progress=lambda fraction, text: False)
    assert stopped.scene_info["interrupted"] and stopped.H.any()


def test_exceptions_of_the_callback_come_back(letter):
    def fail(fraction, text):
        raise KeyError("mine")

    for call in (lambda: nlos.render(letter, method="path", samples=1_000_000, progress=fail),
                 lambda: nlos.reconstruct(nlos.render(letter), "bp", progress=fail)):
        with pytest.raises(KeyError, match="mine"):
            call()


def test_progress_bar(letter, capfd):
    nlos.render(letter, method="path", samples=256, progress=True)
    assert "render" in "".join(capfd.readouterr())


INTERRUPTED = f"""
import nlos, time
start = time.time()
print("begin", flush=True)
try:
    nlos.render({str(LETTER)!r}, method="path", samples=100000000)
except KeyboardInterrupt:
    print("stopped", flush=True)
"""


def test_interruption_ends_the_call():
    child = subprocess.Popen([sys.executable, "-c", INTERRUPTED], stdout=subprocess.PIPE, text=True, env=os.environ)
    assert child.stdout.readline() == "begin\n"
    time.sleep(1.5)
    child.send_signal(signal.SIGINT)
    began = time.time()
    out, _ = child.communicate(timeout=60)
    assert out == "stopped\n" and child.returncode == 0
    assert time.time() - began < 30.0


def test_doubts_become_warnings(letter):
    with pytest.warns(UserWarning, match="time axis"):
        nlos.render(letter, axis={"opl_start_m": 50.0, "bin_width_m": 0.01, "num_bins": 64})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(UserWarning):
            nlos.render(letter, axis={"opl_start_m": 50.0, "bin_width_m": 0.01, "num_bins": 64})


def test_orders_that_are_left_out_are_said(letter, tmp_path):
    assert nlos.render(letter).orders_left_out is None
    capture = nlos.render(letter, max_bounces=5, target_error=0.02)
    orders = capture.orders_left_out
    assert (orders["first"], orders["last"]) == (4, 5)
    assert 0.0 < orders["share"] and 0.0 < orders["error"] < 0.02
    assert "left out: bounces of orders 4 to 5" in repr(capture)
    capture.write(tmp_path / "c.h5")
    assert nlos.read(tmp_path / "c.h5").orders_left_out == orders


def test_other_threads_run_meanwhile(letter):
    turns = 0
    done = threading.Event()

    def count():
        nonlocal turns
        while not done.is_set():
            turns += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    began = time.time()
    nlos.render(letter, method="path", samples=2000)
    took = time.time() - began
    done.set()
    counter.join()
    assert turns > 20 * took  # of about 1000 per second


def test_threads_at_once_get_the_bits_of_one(capture, tmp_path):
    expected = nlos.reconstruct(capture, "lct").volume.copy()
    failures = []

    def work(index):
        try:
            for _ in range(3):
                path = tmp_path / f"{index}.h5"
                capture.write(str(path))
                again = nlos.read(path)
                if not np.array_equal(nlos.reconstruct(again, "lct").volume, expected):
                    failures.append(index)
        except Exception as error:
            failures.append(error)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures


def in_child(path, queue):
    capture = nlos.read(path)
    queue.put(float(nlos.reconstruct(capture, "bp").volume.sum()))
    queue.put(float(nlos.render(LETTER, scan={"sensing_points": [4, 4]}).H.sum()))


@pytest.mark.parametrize("how", ["fork", "spawn"])
def test_processes(capture, tmp_path, how):
    capture.write(str(tmp_path / "capture.h5"))
    expected = [float(nlos.reconstruct(capture, "bp").volume.sum()),
                float(nlos.render(LETTER, scan={"sensing_points": [4, 4]}).H.sum())]
    context = multiprocessing.get_context(how)
    queue = context.Queue()
    children = [context.Process(target=in_child, args=(tmp_path / "capture.h5", queue)) for _ in range(2)]
    for child in children:
        child.start()
    got = [queue.get(timeout=120) for _ in range(4)]
    for child in children:
        child.join()
        assert child.exitcode == 0
    assert sorted(got) == sorted(2 * expected)


def test_import_needs_numpy_alone():
    code = "import sys, nlos; print(sorted(m for m in ('torch', 'xarray', 'tal', 'tqdm') if m in sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=os.environ)
    assert done.stdout.strip() == "[]"


def test_scenes_come_with_it():
    scene = nlos.load_scene(nlos.data_folder() / "scenes" / "letter" / "scene.json")
    assert [shape.name for shape in scene.objects]
    assert (nlos.data_folder() / "data" / "letter.h5").exists()


def test_settings_are_listed():
    for function in ("render", "reconstruct", "simulate_noise", "fit", "read"):
        assert all(len(entry) == 2 and entry[1] for entry in nlos.settings(function).values())
    assert nlos.settings("reconstruct")["solver.tv"][0] == "null"


def test_help_tells_shapes_and_units():
    for name in nlos.__all__:
        assert getattr(nlos, name).__doc__, name
    assert "(T, Sx, Sy)" in nlos.Capture.H.__doc__
    assert "metres" in nlos.reconstruct.__doc__


def test_an_uncertain_setup_widens_depths(letter):
    counts = nlos.simulate_noise(nlos.render(letter), photons_per_point=3000)
    exact = nlos.reconstruct(counts, "lct")
    assert exact.setup is None
    wide = nlos.reconstruct(counts, "lct", setup={"time_zero_sigma_ps": 50})
    assert wide.setup["time_zero_sigma_ps"] == 50 and "time zero" in wide.setup["text"]
    # 15 mm of path, a third to a half of it in depth.
    assert 0.004 < wide.setup["depth_sigma_m"]["setup"] < 0.009
    assert np.nanmedian(wide.depth_sigma_m) > np.nanmedian(exact.depth_sigma_m)
