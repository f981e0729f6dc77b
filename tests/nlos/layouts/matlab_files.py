# SPDX-License-Identifier: MIT
"""MATLAB files as MATLAB writes them: v5 by scipy, v7.3 as the HDF5 that it is.

Arrays are given as MATLAB shows them; its first index is the fastest on disk, so HDF5 has the axes
in reverse.
"""
import h5py
import numpy as np
import scipy.io

_USER_BLOCK = 512
_CLASSES = {"float64": "double", "float32": "single", "bool": "logical"}


def write_v5(path: str, variables: dict) -> None:
    """Writes numbers, texts and nested dictionaries (structs)."""
    scipy.io.savemat(path, variables, do_compression=True, oned_as="row")


def write_v73(path: str, variables: dict) -> None:
    """Writes numbers, texts and nested dictionaries (structs) as `save -v7.3` does."""
    with h5py.File(path, "w", userblock_size=_USER_BLOCK) as file:
        for name, value in variables.items():
            _write_variable(file, name, value)
    header = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon Jan 06 10:00:00 2020"
    header += b" HDF5 schema 1.00 ."
    with open(path, "r+b") as file:
        file.write(header.ljust(124) + b"\x00\x02IM")


def _write_variable(group: h5py.Group, name: str, value) -> None:
    if isinstance(value, dict):
        struct = group.create_group(name)
        struct.attrs["MATLAB_class"] = np.bytes_("struct")
        for key, member in value.items():
            _write_variable(struct, key, member)
        return
    if isinstance(value, str):
        codes = np.frombuffer(value.encode("utf-16-le"), np.uint16)
        dataset = group.create_dataset(name, data=codes.reshape(-1, 1))
        dataset.attrs["MATLAB_class"] = np.bytes_("char")
        dataset.attrs["MATLAB_int_decode"] = np.int32(2)
        return
    array = np.atleast_2d(np.asarray(value))
    stored = array.astype(np.uint8) if array.dtype == bool else array
    dataset = group.create_dataset(name, data=stored.T, chunks=stored.size > 1000 or None,
                                   compression="gzip" if stored.size > 1000 else None)
    dataset.attrs["MATLAB_class"] = np.bytes_(_CLASSES.get(array.dtype.name, array.dtype.name))
    if array.dtype == bool:
        dataset.attrs["MATLAB_int_decode"] = np.int32(1)
