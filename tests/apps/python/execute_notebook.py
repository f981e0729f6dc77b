# SPDX-License-Identifier: MIT
"""Runs the code of a notebook in its folder, as Jupyter's kernel would but without its sockets, and
prints how many pictures it draws.

execute_notebook.py NOTEBOOK.ipynb
"""

import json
import os
import pathlib
import sys

from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output


class NotebookShell(InteractiveShell):
    """Draws into the notebook, so that no window's event loop is needed."""

    def enable_gui(self, gui=None):
        pass


def run(path):
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    os.chdir(path.parent)
    sys.path.insert(0, "")
    shell = NotebookShell.instance()
    shell.run_line_magic("matplotlib", "inline")
    pictures = 0
    for cell in cells:
        if cell["cell_type"] == "code":
            with capture_output() as captured:
                done = shell.run_cell("".join(cell["source"]))
            if not done.success:
                sys.exit(f"{captured.stdout}{captured.stderr}\ncell {cell['id']} of {path.name} failed")
            pictures += sum("image/png" in output.data for output in captured.outputs)
    return pictures


if __name__ == "__main__":
    print(run(pathlib.Path(sys.argv[1]).resolve()))
