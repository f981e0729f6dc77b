# SPDX-License-Identifier: MIT
"""What the tests of the Python module share. NLOS_PROGRAM names the program to compare with."""

import os
import pathlib
import subprocess

import numpy as np
import pytest

import nlos

ROOT = pathlib.Path(__file__).resolve().parents[3]
LETTER = ROOT / "scenes" / "letter" / "scene.json"


@pytest.fixture
def program(tmp_path):
    """Runs the program in an empty folder; returns what it printed."""

    def run(*arguments):
        command = [os.environ["NLOS_PROGRAM"], *map(str, arguments)]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture(scope="session")
def letter():
    return nlos.load_scene(LETTER, scan={"sensing_points": [16, 16]}, time_axis={"bin_width_m": 0.016, "num_bins": 200})


@pytest.fixture(scope="session")
def capture(letter):
    return nlos.render(letter)


@pytest.fixture
def square():
    """A square of 0.2 m, 0.5 m before the wall, from arrays."""
    corners = np.array([[-0.1, -0.1, 0.5], [0.1, -0.1, 0.5], [0.1, 0.1, 0.5], [-0.1, 0.1, 0.5]])
    return nlos.Object(corners, [[0, 1, 2], [0, 2, 3]], name="square", albedo=0.5)
