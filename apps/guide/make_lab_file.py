#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the histograms of a confocal capture as many a lab has them: one cube in a MATLAB file.

    make_lab_file.py CAPTURE.h5 LAB.mat

The cube is `transients` (y, x, t) in MATLAB's order, y falling, in a file of version 7.3. Nothing
in it says how large the wall was, how wide a bin is, or which axis is which.
"""
import sys

import h5py
import numpy as np


def main(source: str, target: str) -> None:
    with h5py.File(source) as capture:
        H = capture["H"][()]  # (t, x, y)
    with h5py.File(target, "w", userblock_size=512) as file:
        cube = file.create_dataset("transients", data=H[:, :, ::-1], compression="gzip")
        cube.attrs["MATLAB_class"] = np.bytes_("single")
    with open(target, "r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, HDF5 schema 1.00 .".ljust(124) + b"\x00\x02IM")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
