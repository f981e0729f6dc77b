#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks the loader of apps/dataset on both formats, with several workers and ranks, without a GPU.

    torch_loader_test.py NLOS        exit status 77 if torch, numpy or h5py are missing
"""
from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from tiny_data_set import generate, write_recipe

try:
    import h5py
    import numpy as np
    import torch
    from torch.utils.data import DataLoader
except ModuleNotFoundError as missing:
    print(f"skipped: {missing}; install python3-torch, python3-numpy and python3-h5py")
    sys.exit(77)

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "apps" / "dataset"))
from dataset_loader import Captures  # noqa: E402

ITEMS, SHARDS = 23, 5  # the last shard has fewer items
ARRAYS = ["H", "depth", "mask", "poses"]


def read(captures: Captures, workers: int = 0) -> list[dict]:
    return list(DataLoader(captures, batch_size=None, num_workers=workers))


def numbers(items: list[dict]) -> list[int]:
    return [item["item"] for item in items]


def check_same(a: list[dict], b: list[dict]) -> None:
    """The same items, in any order, with the same tensors."""
    assert sorted(numbers(a)) == sorted(numbers(b)) == list(range(ITEMS))
    by_number = {item["item"]: item for item in b}
    for item in a:
        other = by_number[item["item"]]
        assert item.keys() == other.keys()
        for name in item.keys() - {"item"}:
            assert item[name].dtype == other[name].dtype, name
            assert np.array_equal(item[name].numpy(), other[name].numpy(), equal_nan=True), name


def check_against_file(items: list[dict], folder: Path, tolerance: float) -> None:
    """The histograms are those of the shards, read here as float64."""
    for path in sorted(folder.glob("shard-*.h5")):
        with h5py.File(path) as file:
            H = file["H"][()].astype(np.float64)
            if "H_scale" in file:
                H *= file["H_scale"][()].reshape(-1, 1, 1, 1)
            for number, expected, depth in zip(file["item"], H, file["depth"]):
                item = items[int(number)]
                assert item["item"] == number
                assert item["H"].dtype == torch.float32 and item["H"].shape == (64, 4, 4)
                assert np.abs(item["H"].numpy() - expected).max() <= tolerance * expected.max()
                assert np.array_equal(item["depth"].numpy(), depth, equal_nan=True)
    assert any(item["H"].max() > 0 for item in items)


def check_formats(program: str, folder: Path, storage: str, detector: object) -> None:
    sets = {}
    for data_format in ("hdf5", "webdataset"):
        recipe = write_recipe(folder / "recipe.json", ITEMS, SHARDS, detector=detector, draw={},
                              storage={"histograms": storage}, format=data_format)
        sets[data_format] = folder / f"{storage}_{data_format}"
        generate(program, recipe, "-o", sets[data_format])
    in_order = read(Captures(sets["hdf5"]))
    assert numbers(in_order) == list(range(ITEMS))
    assert in_order[0].keys() == {"item", *ARRAYS}
    check_against_file(in_order, sets["hdf5"], 0.0 if storage == "uint16" else 1e-6)
    for path in sets.values():
        for workers in (0, 1, 3):
            check_same(in_order, read(Captures(path, ARRAYS), workers))
            ranks = [read(Captures(path, ARRAYS, 5, rank, 2), workers) for rank in (0, 1)]
            assert all(ranks)
            check_same(in_order, ranks[0] + ranks[1])
        assert read(Captures(path, ["depth"]))[0].keys() == {"item", "depth"}
        check_shuffling(path)
    batch = next(iter(DataLoader(Captures(sets["hdf5"], ["H"]), batch_size=4)))
    assert batch["H"].shape == (4, 64, 4, 4)


def check_shuffling(path: Path) -> None:
    def order(seed: int, epoch: int) -> list[int]:
        captures = Captures(path, ["mask"], seed)
        captures.set_epoch(epoch)
        return numbers(read(captures))

    orders = [order(0, 0), order(0, 1), order(1, 0), list(range(ITEMS))]
    assert order(0, 0) == orders[0]
    assert all(sorted(numbers_) == orders[-1] for numbers_ in orders)
    assert len(set(map(tuple, orders))) == len(orders)


def main(program: str) -> int:
    with tempfile.TemporaryDirectory(prefix="loader_") as name:
        check_formats(program, Path(name), "uint16", {"photons_per_point": 1000})
        check_formats(program, Path(name), "float16", None)
    print("both formats give the same tensors, each item once for 0, 1 and 3 workers and 2 ranks")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
