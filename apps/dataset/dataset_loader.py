# SPDX-License-Identifier: MIT
"""A PyTorch data set over the shards of `nlos generate`, in either of its formats.

    from dataset_loader import Captures

    captures = Captures("set", ["H", "depth"], shuffle_seed=0)
    for batch in torch.utils.data.DataLoader(captures, batch_size=32, num_workers=4):
        train(batch["H"], batch["depth"])      # (32, bins, x, y) and (32, x, y)

Files without manifest are left out: a data set may be read while it grows. Copy this file into your
project and change it as you like.
"""
from __future__ import annotations

import io
import json
import tarfile
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import torch
from torch.utils.data import IterableDataset, get_worker_info


class Captures(IterableDataset):
    """Items as dictionaries of tensors: `item` is the item's number, the others are as stored, but
    histograms are always float32, whatever they are stored as.

    folder        of a data set
    arrays        the names of those to read; None: all
    shuffle_seed  None: items in their order; a number: shards in random order and the items of a
                  shard too, in another order in every epoch that set_epoch() names
    rank, ranks   this process of a training on several: each reads every ranks-th shard, so that
                  all together read each item once
    """

    def __init__(self, folder: str, arrays: Sequence[str] | None = None,
                 shuffle_seed: int | None = None, rank: int = 0, ranks: int = 1):
        manifests = [json.loads(path.read_text(encoding="utf-8"))
                     for path in sorted(Path(folder).glob("shard-*.json"))]
        if not manifests:
            raise FileNotFoundError(f"{folder} holds no shards")
        self.shards = [Path(folder) / manifest["file"] for manifest in manifests]
        self.arrays = arrays
        self.shuffle_seed = shuffle_seed
        self.rank, self.ranks = rank, ranks
        self.epoch = 0

    def set_epoch(self, epoch: int) -> None:
        """Call it before each epoch, and before DataLoader starts its workers."""
        self.epoch = epoch

    def __iter__(self) -> Iterator[dict[str, torch.Tensor | int]]:
        worker = get_worker_info()
        workers = worker.num_workers if worker else 1
        part = self.rank * workers + (worker.id if worker else 0)
        # The order of shards is the same for all, that of their items need not be.
        for shard in self._shuffled(len(self.shards), 0)[part::self.ranks * workers]:
            read = _read_hdf5 if self.shards[shard].suffix == ".h5" else _read_webdataset
            order = partial(self._shuffled, stream=1 + shard)
            for number, values in read(self.shards[shard], self.arrays, order):
                yield {"item": number, **_to_tensors(values)}

    def _shuffled(self, count: int, stream: int) -> list[int]:
        if self.shuffle_seed is None:
            return list(range(count))
        rng = np.random.default_rng([self.shuffle_seed, self.epoch, stream])
        return rng.permutation(count).tolist()


def _read_hdf5(path, names, order):
    import h5py

    with h5py.File(path) as file:  # opened here, in the worker: HDF5 must not be shared by a fork
        numbers = file["item"][()]
        stored = [name for name in file if name not in ("item", "parameters")]
        columns = {name: file[name] for name in _with_scale(names, stored)}
        for i in order(len(numbers)):
            yield int(numbers[i]), {name: column[i] for name, column in columns.items()}


def _read_webdataset(path, names, order):
    with tarfile.open(path) as archive:
        members = [member for member in archive.getmembers() if member.name.endswith(".npz")]
        for i in order(len(members)):
            with np.load(io.BytesIO(archive.extractfile(members[i]).read())) as item:
                values = {name: item[name] for name in _with_scale(names, item)}
            yield int(Path(members[i].name).stem), values


def _with_scale(names, stored):
    if names is None:
        return list(stored)
    return [*names, *(["H_scale"] if "H" in names and "H_scale" in stored else [])]


def _to_tensors(values):
    scale = values.pop("H_scale", None)  # of half precision
    if "H" in values:
        values["H"] = np.asarray(values["H"], dtype=np.float32) * (1 if scale is None else scale)
    return {name: torch.from_numpy(np.array(value)) for name, value in values.items()}
