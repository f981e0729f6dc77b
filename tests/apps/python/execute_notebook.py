# SPDX-License-Identifier: MIT
"""Executes a notebook in its folder by a kernel of this interpreter; stores it with its outputs.

execute_notebook.py NOTEBOOK.ipynb DONE.ipynb
"""

import pathlib
import sys

import nbformat
from jupyter_client import KernelManager
from jupyter_client.kernelspec import KernelSpec
from nbclient import NotebookClient
from nbclient.exceptions import CellTimeoutError


class ThisInterpreter(KernelManager):
    """Starts this Python, whatever kernels are installed under the notebook's name."""

    @property
    def kernel_spec(self):
        return KernelSpec(argv=[sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"],
                          display_name="Python 3", language="python")


def run(source):
    notebook = nbformat.read(source, as_version=4)
    client = NotebookClient(notebook, timeout=300, kernel_manager_class="execute_notebook.ThisInterpreter",
                            resources={"metadata": {"path": str(pathlib.Path(source).parent)}})
    client.execute()
    return notebook


def main(source, target):
    try:
        notebook = run(source)
    except CellTimeoutError:  # on a busy machine kernel and client may both wait for the other's message
        notebook = run(source)
    nbformat.write(notebook, target)


if __name__ == "__main__":
    main(*sys.argv[1:])
