# SPDX-License-Identifier: MIT
"""nlos.generate against the program."""

import os
import signal
import subprocess
import sys
import time

import pytest

import nlos
from conftest import ROOT

RECIPE = ROOT / "data" / "recipes" / "shapes.json"
TINY = {"items": 6, "items_per_shard": 2, "scene": {"scan": {"sensing_points": [4, 4]}},
        "meshes": {"shapes": ["plate", "box"]}, "calibration_items": 0}


def test_shards_of_module_and_program_have_the_same_bytes(program, tmp_path):
    parts = [nlos.generate(RECIPE, tmp_path / "module", shard=(i, 2), **TINY) for i in range(2)]
    assert [part["shards_written"] for part in parts] == [2, 1]
    assert nlos.generate(RECIPE, tmp_path / "module", **TINY)["shards_there"] == 3
    program("generate", RECIPE, "-o", tmp_path / "program", "--set", "items=6", "items_per_shard=2",
            "scene.scan.sensing_points=[4,4]", 'meshes.shapes=["plate","box"]', "calibration_items=0")
    for shard in range(3):
        name = f"shard-0000{shard}.h5"
        assert (tmp_path / "module" / name).read_bytes() == (tmp_path / "program" / name).read_bytes()


def test_progress_stops_between_items(tmp_path):
    fractions = []

    def report(fraction, text):
        fractions.append(fraction)
        return len(fractions) < 3

    stopped = nlos.generate(RECIPE, tmp_path / "set", progress=report, **TINY)
    assert stopped["interrupted"] and stopped["shards_written"] < 3
    assert fractions == sorted(fractions)


@pytest.mark.parametrize("arguments, part", [
    ({"shard": (3, 3)}, "must be I/N"),
    ({"items": 0}, "items"),
    ({"storage": {"histograms": "int8"}}, "storage.histograms"),
    ({"objects": {"albedo": 2}}, "objects.albedo"),
    ({"nothing": 1}, "nothing"),
])
def test_bad_input_is_named(tmp_path, arguments, part):
    with pytest.raises(nlos.Error, match=part):
        nlos.generate(RECIPE, tmp_path / "set", **arguments)


def test_bad_paths_are_named(tmp_path):
    with pytest.raises(nlos.Error, match="recipe"):
        nlos.generate(3, tmp_path / "set")
    with pytest.raises(nlos.Error, match="nowhere.json"):
        nlos.generate(tmp_path / "nowhere.json", tmp_path / "set")


def test_ctrl_c_ends_the_call_and_leaves_nothing_half(tmp_path):
    script = (f"import nlos\nprint('begin', flush=True)\n"
              f"try:\n    nlos.generate({str(RECIPE)!r}, {str(tmp_path / 'set')!r}, items=100000)\n"
              f"except KeyboardInterrupt:\n    print('stopped', flush=True)\n")
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, env=os.environ)
    assert child.stdout.readline() == "begin\n"
    time.sleep(6.0)
    child.send_signal(signal.SIGINT)
    assert child.stdout.read() == "stopped\n"
    assert child.wait() == 0
    assert not [name for name in os.listdir(tmp_path / "set") if ".partial" in name]
