# SPDX-License-Identifier: MIT
"""Layouts of sequences: an object that moves before one wall point, and the logs of sensors."""
from __future__ import annotations

import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from capture import Capture
from case import Case, Source, Written, extents_m, picoseconds_m, require, require_confocal_grid
from matlab_files import write_v73

KEYHOLE_BIN_PS = 16
KEYHOLE_PEAK = 635
ST_BIN_PS = 250
TMF882X_BIN_PS = 88
TMF882X_PEAK = 13
TMF882X_START_M = -(TMF882X_PEAK + 0.5) * picoseconds_m(TMF882X_BIN_PS)
TMF8829_BINS = 64


def _frames(capture: Capture, count: int = 3) -> np.ndarray:
    """(F, as H): the capture moved along x, frame by frame, until it is the capture itself."""
    return np.stack([np.roll(capture.H, count - 1 - i, axis=1) for i in range(count)])


def write_keyhole_2020(capture: Capture, folder: Path) -> Written:
    """data (bins, positions) seen from one wall point, its direct return, of length 0, centred in
    bin 635; beside it long exposures without the object, to be subtracted, which leaves no counts.
    Every object position is a frame."""
    counted = replace(capture.as_counts(), unit="radiance")
    histograms = counted.H.reshape(counted.num_bins, -1)
    background = np.zeros((KEYHOLE_PEAK + counted.num_bins, 1))
    background[KEYHOLE_PEAK] = 5000.0
    background[100::7] = 3.0
    data = background + np.concatenate([np.zeros((KEYHOLE_PEAK, histograms.shape[1])), histograms])
    positions = -counted.sensing.reshape(-1, 3)
    for when in ("before", "after"):
        name = f"LongExpNoObject_{when}"
        write_v73(folder / f"{name}.mat", {name: background.astype(np.uint32)})
    path = folder / "scan_10-15-19_21-12.mat"
    write_v73(path, {"data": data, "xpos": positions[:, 0], "zpos": positions[:, 2]})
    frames = np.moveaxis(data - background, 1, 0)[..., np.newaxis].astype(np.float32)
    expected = replace(counted.with_points(np.zeros((1, 3))), H=frames[-1], frames=frames,
                       bin_width_m=picoseconds_m(KEYHOLE_BIN_PS),
                       start_m=-(KEYHOLE_PEAK + 0.5) * picoseconds_m(KEYHOLE_BIN_PS))
    return Written(path, expected)


def write_st_vl53l8(capture: Capture, folder: Path) -> Written:
    """A folder with a file per frame: hists (zones, bins) and where the zones' rays meet the wall,
    pt_cloud (zones, 3) [m]. Each zone sees the point that it lights. The published numbers are
    not whole, and so no counts."""
    counted = capture.as_counts()
    expected = replace(counted, H=counted.H / 4, start_m=0.0, unit="radiance",
                       bin_width_m=picoseconds_m(ST_BIN_PS))
    frames = _frames(expected)
    for number, frame in enumerate(frames):
        np.savez(folder / f"volume_{number:06}.npz",
                 hists=frame.reshape(expected.num_bins, -1).T.astype(np.float64),
                 pt_cloud=expected.sensing.reshape(-1, 3), particles=np.zeros((5, 3), np.float32))
    return Written(folder, replace(expected, frames=frames))


def _rows_down(H: np.ndarray) -> np.ndarray:
    """(y, x, t) with y falling, as an image of zones, of (t, x, y)."""
    return np.moveaxis(H, 0, 2)[:, ::-1].swapaxes(0, 1)


def _wall(capture: Capture) -> str:
    x_m, y_m = extents_m(capture.sensing)
    return f"capture.wall_size_m=[{x_m!r},{y_m!r}]"


def _distance(capture: Capture) -> str:
    return f"capture.distance_m={float(capture.laser_m[2])!r}"


def write_ams_tmf8829(capture: Capture, folder: Path) -> Written:
    """A log of Result_Set: per frame rows of zones with {"bin": 64 counts}. Neither the wall nor
    the width of bins is in it. Lengths start and end at the sensor."""
    require_confocal_grid(capture, "ams-tmf8829")
    require(capture.opl_origin == "device", "ams-tmf8829", "lengths that include the segments")
    expected = replace(capture.as_counts(), start_m=0.0)
    frames = _frames(expected)

    def zones(frame: np.ndarray) -> list:
        return [[{"bin": zone.astype(int).tolist()} for zone in row] for row in _rows_down(frame)]
    reference = [{"bin": [0] * TMF8829_BINS}] * 2
    log = {"configuration": {"fp_mode": 1, "period": 33},
           "info": [{"host": "example", "version": 3}],
           "Result_Set": [{"info": {"frame": number}, "results": [[{"noise": 0}]],
                           "ref_histo": reference, "mp_histo": zones(frame)}
                          for number, frame in enumerate(frames)]}
    path = folder / "tmf8829_log.json"
    path.write_text(json.dumps(log, indent=2))
    return Written(path, replace(expected, frames=frames),
                   (_wall(capture), _distance(capture),
                    f"capture.bin_width_m={capture.bin_width_m!r}"))


def write_ams_tmf882x_log(capture: Capture, folder: Path) -> Written:
    """A list of measurements: hists of 9 zones, row by row from the top left, and the histogram of
    the light inside the device, reference_hist, whose peak is time zero. Its largest single value
    stands in another bin than the peak of all frames together. Where the device stands and what
    its zones see of the wall is not in it."""
    require_confocal_grid(capture, "ams-tmf882x-log")
    require(capture.opl_origin == "device", "ams-tmf882x-log", "lengths that include the segments")
    expected = replace(capture.as_counts(), start_m=TMF882X_START_M)
    frames = _frames(expected)
    reference = np.zeros((len(frames), expected.num_bins), int)
    reference[:, TMF882X_PEAK - 1:TMF882X_PEAK + 2] = (300, 800, 250)
    reference[0, TMF882X_PEAK + 5] = 900
    log = [{"num_zones": 9, "num_bins": expected.num_bins, "tick": 1000 + number,
            "temperature": 31, "depths_1": [400] * 9, "reference_hist": reference[number].tolist(),
            "hists": _rows_down(frame).reshape(9, -1).astype(int).tolist()}
           for number, frame in enumerate(frames)]
    path = folder / "measurements.json"
    path.write_text(json.dumps(log))
    return Written(path, replace(expected, frames=frames), (_wall(capture), _distance(capture)))


def write_ams_tmf882x(capture: Capture, folder: Path, suffix: str) -> Written:
    """A file per frame: histogram (x, y, bins) of 3 by 3 zones, and where their rays meet the wall,
    point_cloud (zones, 3) [m], as the device sees it, which stands at the origin and looks along z.
    Lengths start and end at the device; the reflection inside it, of length 0, is centred in bin
    13."""
    require_confocal_grid(capture, "ams-tmf882x")
    require(capture.opl_origin == "device", "ams-tmf882x", "lengths that include the segments")
    seen_from_device = [-1.0, 1.0, -1.0]
    turned = capture.with_points((capture.sensing - capture.laser_m) * seen_from_device)
    towards_device = -turned.sensing_normals
    expected = replace(turned.as_counts(), sensing_normals=towards_device,
                       illumination_normals=towards_device,
                       start_m=TMF882X_START_M, bin_width_m=picoseconds_m(TMF882X_BIN_PS),
                       opl_origin="device", laser_m=np.zeros(3), detector_m=np.zeros(3))
    frames = _frames(expected)
    points = expected.sensing.reshape(-1, 3)
    for number, frame in enumerate(frames):
        arrays = {"histogram": np.moveaxis(frame, 0, -1).astype(np.float64), "point_cloud": points,
                  "distance": np.full((3, 3), 400.0)}
        path = folder / f"iter_{number}.{suffix}"
        if suffix == "npz":
            np.savez(path, **arrays)
        else:
            path.write_text(json.dumps({name: array.tolist() for name, array in arrays.items()}))
    return Written(folder, replace(expected, frames=frames))


CASES = [
    Case("keyhole-2020", Source(points=(9, 1), size_m=(0.8, 0.0), num_bins=512,
                                bin_width_m=picoseconds_m(KEYHOLE_BIN_PS)), write_keyhole_2020),
    Case("st-vl53l8", Source(points=(4, 4), num_bins=128, bin_width_m=picoseconds_m(ST_BIN_PS)),
         write_st_vl53l8),
    Case("ams-tmf8829", Source(points=(16, 16), num_bins=TMF8829_BINS, bin_width_m=0.05,
                               segments=True, device_m=0.4), write_ams_tmf8829),
    Case("ams-tmf882x-log",
         Source(points=(3, 3), num_bins=128, bin_width_m=picoseconds_m(TMF882X_BIN_PS),
                start_m=TMF882X_START_M, segments=True, device_m=0.4), write_ams_tmf882x_log),
    *(Case(f"ams-tmf882x as {suffix}",
           Source(points=(3, 3), num_bins=128, bin_width_m=picoseconds_m(TMF882X_BIN_PS),
                  start_m=TMF882X_START_M, segments=True, device_m=0.4),
           partial(write_ams_tmf882x, suffix=suffix)) for suffix in ("npz", "json")),
]
