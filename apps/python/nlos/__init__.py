# SPDX-License-Identifier: MIT
"""Non-line-of-sight imaging: simulate, reconstruct, fit, compare.

The functions are the commands of the program `nlos` from objects to objects, without files in
between; they give the same bits. Lengths are in metres, path lengths too (never in seconds), and
arrays have time as first axis: ``capture.H`` is (T, Sx, Sy).

Points, poses and normals are in the world. What is seen from the wall is in the wall's frame:
``x_m`` and ``y_m`` of a result run along wall x and wall y, ``z_m`` and ``depth_m`` away from the
wall. ``result.to_world(x_m, y_m, depth_m)`` leads from there to the world, as the matrix
``result.world_from_wall`` does; for a wall at z = 0 around the origin both are the same.

    import nlos
    capture = nlos.render("scenes/letter/scene.json")
    result = nlos.reconstruct(capture, method="lct")
    print(nlos.compare(result, nlos.load_scene("scenes/letter/scene.json")))

Long calls release Python's lock, stop on Ctrl-C, and take

* ``progress``: True shows a bar (of tqdm where it is installed), or a function that is called with
  the fraction done and a text; when it returns False, the work stops with what it has;
* ``threads``: how many to use at most; 0 takes all processors.

Settings are keyword arguments with the names that ``--set`` has on the command line, dots being
nested dictionaries: ``solver={"tv": 0.3}``. ``nlos.settings("reconstruct")`` lists them all. Wrong
input raises ``nlos.Error``, a ValueError that says where, what was found, what is allowed; work that
could not be done raises ``nlos.Failure``, a RuntimeError. What looks doubtful is given to Python's
``warnings``.
"""

from __future__ import annotations

import os
import pathlib
from typing import Any, Callable, Mapping, Sequence, Union

import numpy as np

from . import _core
from ._core import (Capture, FitResult, LightConeOperator, Object, PairOperator, Reconstruction, Scene)
from ._errors import Error, Failure
from .neighbours import from_mitransient, from_tal, from_trimesh, to_tal

__version__ = _core.version.split()[1]
__all__ = [
    "Capture", "Error", "Failure", "FitResult", "LightConeOperator", "Object", "PairOperator",
    "Reconstruction", "Scene",
    "calibrate", "compare", "data_folder", "fit", "from_mitransient", "from_tal", "from_trimesh", "generate",
    "info",
    "load_scene", "read", "read_volume", "reconstruct", "render", "report", "settings",
    "simulate_noise", "third_bounce_vjp", "to_tal",
]

Path = Union[str, "os.PathLike[str]"]
Progress = Union[None, bool, Callable[[float, str], Any]]


def data_folder() -> pathlib.Path:
    """The folder of the scenes and small captures that come with the module: scenes/ and data/."""
    return pathlib.Path(_core.data_folder())


def load_scene(path: Path, **settings: Any) -> Scene:
    """Reads a scene.json and the geometry that it names.

    path      scene description
    settings  keys of scene.json in place of the file's, such as ``scan={"sensing_points": [32, 32]}``
    """
    return _core.load_scene(_path(path), settings)


def read(path: Path | Sequence[Path], layout: str | None = None, **settings: Any) -> Capture:
    """Reads a capture in any known layout.

    path      file or folder; a list of files: the frames of a sequence
    layout    name or JSON file of the layout; None: recognised by content
    settings  what the file leaves open, as ``--set capture.`` has it: pitch_m, bin_width_m, ...
    """
    if layout is not None:
        settings["layout"] = layout
    return _core.read_capture(_paths(path), settings)


def read_volume(path: Path) -> Reconstruction:
    """Reads a volume that ``Reconstruction.write`` or the program wrote (.h5)."""
    return _core.read_volume(_path(path))


def render(
    scene: Scene | Path,
    scan: Mapping[str, Any] | Capture | None = None,
    axis: Mapping[str, Any] | str | None = None,
    *,
    calibration: Mapping[str, Any] | None = None,
    progress: Progress = None,
    threads: int = 0,
    **settings: Any,
) -> Capture:
    """Simulates what a scan, or a camera, records of a scene.

    scene        Scene, or path of a scene.json
    scan         keys of ``scan`` in scene.json; a Capture: its points and bins; None: the scene's
    axis         dict of opl_start_m, bin_width_m, num_bins, or "auto"; None: the scene's
    calibration  what calibrate() returned, of the device that records
    settings     of the renderer: method, samples, seconds, target_error, max_bounces, seed, ...; and
                 any key of scene.json: relay_wall, camera, frames, velocity_axis, objects
    returns      Capture with H in W/(m^2 sr) for 1 W, per bin; how it was computed is in scene_info
    """
    return _core.render(_scene(scene), scan, axis, calibration, settings,
                        _show_progress(progress, "render"), _thread_count(threads))


def simulate_noise(capture: Capture | Path, *, sensor: bool = False, threads: int = 0, **settings: Any) -> Capture:
    """Turns a capture into what a detector counts.

    sensor    start from the detector of the capture's sensor, its crosstalk and what its firmware
              cuts included
    settings  photons, photons_per_point, exposure_s, response, ambient, dark_counts_hz, pile_up,
              dead_time_ns, expected, seed, ...
    returns   Capture with the unit counts
    """
    return _core.simulate_noise(_capture(capture), sensor, settings, _thread_count(threads))


def reconstruct(
    capture: Capture | Path,
    method: str = "auto",
    *,
    calibration: Mapping[str, Any] | None = None,
    progress: Progress = None,
    threads: int = 0,
    **settings: Any,
) -> Reconstruction:
    """Reconstructs the hidden scene from a capture.

    capture      Capture, or path of one
    method       auto, lct, dlct, fk, phasor, bp, fbp or solver
    calibration  what calibrate() returned, to apply to the capture
    settings     volume, crop, snr, response, falloff, solver, phasor, ...
    returns      Reconstruction: volume (X, Y, Z) at x_m, y_m, z_m and depth_m (X, Y) in the wall's
                 frame, points_m (N, 3) in the world, all in metres
    raises       Error when the method cannot serve this capture (it names one that can); Failure
                 when memory does not suffice
    """
    return _core.reconstruct(_capture(capture), {"method": method, **settings},
                             calibration, _show_progress(progress, "reconstruct"),
                             _thread_count(threads))


def fit(
    capture: Capture | Path,
    scene: Scene | Path,
    *,
    start: str | Reconstruction = "given",
    calibration: Mapping[str, Any] | None = None,
    progress: Progress = None,
    threads: int = 0,
    **settings: Any,
) -> FitResult:
    """Finds the scene whose third bounce explains a capture.

    scene     Scene, or path of one: its geometry and poses are the start
    start     "given", "search", or a Reconstruction whose points are started from
    settings  of MODEL.json: ``free={"letter": ["pose"]}``, response, blur_schedule_m, residual, ...
    returns   FitResult; ``converged`` is False when the last solve ran out of iterations
    """
    points: Any = []
    if isinstance(start, Reconstruction):
        points, start = start.points_m, "volume"
    return _core.fit(_capture(capture), _scene(scene), {**settings, "start": start},
                     calibration, points, _show_progress(progress, "fit"), _thread_count(threads))


def calibrate(setup: Path, **settings: Any) -> dict[str, Any]:
    """Calibrates wall, spots, time zero and response of a set-up.

    setup     SETUP.json with the direct returns and commands
    settings  its keys with other values, and ``capture={...}`` for what its file leaves open
    returns   what CALIBRATION.json holds, for ``calibration=`` of the other functions
    """
    return _core.calibrate(_path(setup, "setup"), settings)


def compare(
    result: Reconstruction | Capture | FitResult | Scene | Path,
    reference: Scene | Reconstruction | Capture | Path,
    *,
    fscore_threshold_m: float | None = None,
) -> dict[str, float]:
    """Scores a result against the truth or another result.

    result              Reconstruction, FitResult or Scene against a Scene; or two Reconstructions or
                        two Captures; or two files of any kind that the program compares
    fscore_threshold_m  distance that counts as a match of points [m]; None: 0.01, of volumes a
                        voxel's diagonal
    returns             dict of scores, such as depth_mae_m, mask_iou, chamfer_m, rel_l2
    """
    if fscore_threshold_m is not None and not 0.0 < fscore_threshold_m < float("inf"):
        raise Error("fscore_threshold_m", f"found {fscore_threshold_m}", "must be positive and finite [m]")
    if _is_path(result) and _is_path(reference):
        return _core.compare_files(os.fspath(result), os.fspath(reference), fscore_threshold_m)
    if _is_path(result):
        result = read(result) if isinstance(reference, Capture) else read_volume(result)
    if _is_path(reference):
        reference = read(reference) if isinstance(result, Capture) else load_scene(reference)
    pairs = {
        Reconstruction: (Scene, Reconstruction), Capture: (Capture,), FitResult: (Scene,), Scene: (Scene,)
    }
    if not isinstance(reference, pairs.get(type(result), ())):
        raise Error("result", f"found {type(result).__name__} against {type(reference).__name__}",
                    "must be a Reconstruction, FitResult or Scene against a Scene, or two of one kind")
    return _core.compare(result, reference, fscore_threshold_m)


def third_bounce_vjp(
    scene: Scene | Path,
    scan: Mapping[str, Any] | Capture | None = None,
    axis: Mapping[str, Any] | None = None,
    **settings: Any,
) -> tuple[np.ndarray, Callable[[Any], list[tuple[np.ndarray, float]]]]:
    """The third bounce of a scene, and the way back from a loss by H to one by the scene.

    scene     Scene of Lambertian objects, or path of one; scan and axis as of render()
    settings  tolerance: relative L2 error that surfaces are cut for (0.02; gradients are those of
              the H returned, to rounding, and as far from those of the exact one as several times
              its error); sigma_m: standard deviation of a Gaussian response in path length
    returns   (H, pullback): H is float64 in the shape of Capture.H; pullback(dL/dH) gives a list of
              (dL/dvertices (N, 3), dL/dalbedo), one per object. The edges of shadows are found
              exactly, so that gradients count how they move.
    """
    pullback = _core.third_bounce_pullback(_scene(scene), scan, axis, settings)
    return pullback.H, pullback


def info(path: Path | Sequence[Path], **settings: Any) -> str:
    """Says what a file is and what it holds, in lines for people."""
    return _core.info(_paths(path), settings)


def report(folder: Path, path: Path) -> None:
    """Makes one self-contained HTML page of a folder of results."""
    _core.report(_path(folder, "folder"), _path(path))


def settings(function: str) -> dict[str, tuple[str, str]]:
    """All settings of render, reconstruct, simulate_noise, fit or read.

    returns   dict of dotted key: (default, meaning)
    """
    return {key: (default, meaning) for key, default, meaning in _core.settings(function)}


def generate(
    recipe: Path,
    folder: Path,
    *,
    shard: tuple[int, int] | None = None,
    item_range: tuple[int, int] | None = None,
    progress: Progress = None,
    threads: int = 0,
    **settings: Any,
) -> dict[str, Any]:
    """Makes a data set of captures of random scenes, or a part of it; what is there is kept.

    recipe      path of a recipe (.json)
    folder      of the data set; several processes may work in it
    shard       (i, n): make the part i of n, from 0 to n - 1
    item_range  (a, b): make only the items from a to b - 1
    settings    keys of the recipe with other values
    returns     dict with shards_written, shards_there, items_written, dark_items, seconds, interrupted
    """
    return _core.generate(_path(recipe, "recipe"), _path(folder, "folder"), shard, item_range, settings,
                          _show_progress(progress, "generate"), _thread_count(threads))


def _is_path(value: Any) -> bool:
    return isinstance(value, (str, os.PathLike))


def _path(value: Any, name: str = "path") -> str:
    if not _is_path(value):
        raise Error(name, f"found {type(value).__name__}", "must be a path")
    return os.fspath(value)


def _paths(value: Any) -> list[str]:
    """One path or several."""
    values = [value] if _is_path(value) else value
    if not isinstance(values, (list, tuple)) or not values:
        raise Error("path", f"found {type(value).__name__}", "must be a path or a list of them")
    for item in values:
        if not _is_path(item):
            raise Error("path", f"found {type(item).__name__} in the list", "must be paths")
    return [os.fspath(item) for item in values]


def _capture(value: Any) -> Capture:
    return _given(value, Capture, read)


def _scene(value: Any) -> Scene:
    return _given(value, Scene, load_scene)


def _given(value: Any, kind: type, read_file: Callable[[Any], Any]) -> Any:
    """An object as it is given, or read from the path that is given."""
    if isinstance(value, kind):
        return value
    if _is_path(value):
        return read_file(value)
    name = kind.__name__
    raise Error(name.lower(), f"found {type(value).__name__}", f"must be a {name} or a path")


def _thread_count(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= 1024:
        raise Error("threads", f"found {value!r}", "must be a whole number from 0 to 1024")
    return value


def _show_progress(value: Any, title: str) -> Callable[[float, str], Any] | None:
    """What is called with the fraction done: nothing, the caller's own, or a bar."""
    if value is None or value is False:
        return None
    if value is True:
        return _bar(title)
    if callable(value):
        return value
    raise Error("progress", f"found {type(value).__name__}", "must be True or a function of a fraction and a text")


def _bar(title: str) -> Callable[[float, str], Any]:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return lambda fraction, text: print(f"{title} {100 * fraction:3.0f} %  {text}")
    bar = tqdm(total=100, desc=title, unit="%", bar_format="{desc} {percentage:3.0f} %|{bar}| {postfix}")

    def update(fraction: float, text: str) -> None:
        bar.update(100 * fraction - bar.n)
        bar.set_postfix_str(text, refresh=fraction >= 1.0)
        if fraction >= 1.0:
            bar.close()

    return update
