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


class ThisInterpreter(KernelManager):
    """Starts this Python, whatever kernels are installed under the notebook's name."""

    @property
    def kernel_spec(self):
        return KernelSpec(argv=[sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"],
                          display_name="Python 3", language="python")


def main(source, target):
    notebook = nbformat.read(source, as_version=4)
    client = NotebookClient(notebook, timeout=600, kernel_manager_class="execute_notebook.ThisInterpreter",
                            resources={"metadata": {"path": str(pathlib.Path(source).parent)}})
    client.execute()
    nbformat.write(notebook, target)


if __name__ == "__main__":
    main(*sys.argv[1:])
