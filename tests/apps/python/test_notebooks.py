# SPDX-License-Identifier: MIT
"""Every notebook of the guide runs, draws figures, and is stored without outputs.

NLOS_PEERS_PYTHON names the interpreter of an environment that apps/bench/field/install_peers.sh
made; without it the notebook of mitransient and y-tal is skipped.
"""

import json
import os
import pathlib
import subprocess
import sys

import pytest

from conftest import ROOT

FOLDER = ROOT / "apps" / "guide" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
PEERS = "mitransient_and_ytal"
EXECUTE = pathlib.Path(__file__).with_name("execute_notebook.py")


def test_all_are_here():
    names = {path.stem for path in NOTEBOOKS}
    assert names == {"first_capture", "your_own_mesh", "your_labs_file", "which_method", "fit_with_gradients", PEERS}
    readme = (FOLDER / "README.md").read_text()
    assert [name for name in names if f"{name}.ipynb" not in readme] == []


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_is_stored_without_outputs(path):
    notebook = json.loads(path.read_text())
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    assert set(notebook["metadata"]) == {"kernelspec", "language_info"}
    identifiers = [cell["id"] for cell in notebook["cells"]]
    assert len(set(identifiers)) == len(identifiers)
    for cell in notebook["cells"]:
        assert cell["metadata"] == {}
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_runs(path, tmp_path):
    """Beside the scenes that it reads, by a kernel of the interpreter that is tested."""
    python = sys.executable
    if path.stem == PEERS:
        python = os.environ.get("NLOS_PEERS_PYTHON")
        if not python:
            pytest.skip("NLOS_PEERS_PYTHON is not set: it names an environment with mitransient and y-tal")
        if subprocess.run([python, "-c", "import tal"], capture_output=True, check=False).returncode != 0:
            pytest.skip("the environment of NLOS_PEERS_PYTHON has no y-tal, as on Debian 13")
    else:
        pytest.importorskip("IPython")
        if path.stem == "fit_with_gradients":
            pytest.importorskip("torch")
    before = sorted(FOLDER.iterdir())
    environment = {**os.environ, "NLOS_QUICK": "1", "IPYTHONDIR": str(tmp_path)}
    done = subprocess.run([python, str(EXECUTE), str(path)], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-4000:]
    assert int(done.stdout.split()[-1]) >= 2, "a notebook draws two pictures at least"
    assert sorted(FOLDER.iterdir()) == before, "a notebook left files beside it"
