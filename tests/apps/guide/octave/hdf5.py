# SPDX-License-Identifier: MIT
"""MATLAB's HDF5 functions, which Octave lacks, for the functions beside this file.

    hdf5.py create|write|read FILE DATASET DATA.mat       create: DATA.mat holds the extents

MATLAB counts dimensions fastest first, HDF5 slowest first.
"""
import sys

import h5py
import scipy.io

action, path, dataset, exchange = sys.argv[1:]
if action == "read":
    with h5py.File(path) as file:
        scipy.io.savemat(exchange, {"data": file[dataset][()].T}, oned_as="column")
else:
    data = scipy.io.loadmat(exchange)["data"]
    with h5py.File(path, "a") as file:
        if action == "create":
            file.create_dataset(dataset, data.astype(int).ravel()[::-1])
        else:
            file[dataset][...] = data.T.reshape(file[dataset].shape)
