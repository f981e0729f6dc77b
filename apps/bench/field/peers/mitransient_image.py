# SPDX-License-Identifier: MIT
"""Renders an image of a scene lit by a point light by mitransient, once for every seed.

Conventions, and how they are met. Unit: a light of intensity 1 / (4 pi) sheds 1 W, as ours. Orders:
`max_depth` counts the segment from the light, too. Lengths: a path counts from the camera's near plane
on, which is therefore moved to the camera, and rays start off surfaces, so that the scene is given
in millimetres (see mitransient_render.py). Sides: `twosided`, as ours.
"""
from importlib import metadata

import drjit as dr
import mitsuba as mi
import numpy as np

from adapter import render_seeds, serve

mi.set_variant("llvm_ad_mono" if "llvm_ad_mono" in mi.variants() else "llvm_ad_rgb")
import mitransient  # needs a variant

VERSION = "mitransient " + metadata.version("mitransient")
MM = 1000.0  # in a metre


def scene_of(request):
    camera = request["camera"]
    film = {"type": "transient_hdr_film", "rfilter": {"type": "box"}, "temporal_bins": request["num_bins"],
            "start_opl": MM * request["opl_start_m"], "bin_width_opl": MM * request["bin_width_m"],
            **dict(zip(("width", "height"), camera["resolution"]))}
    pose = mi.ScalarTransform4f().look_at(
        origin=[MM * v for v in camera["position_m"]], target=[MM * v for v in camera["look_at_m"]], up=camera["up"])
    scene = {
        "type": "scene",
        "integrator": {"type": "transient_path", "max_depth": request["max_bounces"] + 1, "rr_depth": 1000,
                       "temporal_filter": "box"},
        "sensor": {"type": "perspective", "fov": camera["fov_y_deg"], "fov_axis": "y", "near_clip": 0.01,
                   "far_clip": 1e6, "to_world": pose, "film": film},
        "light": {"type": "point", "position": [MM * v for v in request["light_m"]], "intensity": MM**2 / (4 * np.pi)}}
    for number, mesh in enumerate(request["meshes"]):
        bsdf = {"type": "twosided", "side": {"type": "diffuse", "reflectance": mesh["albedo"]}}
        scene[f"mesh{number}"] = {"type": "ply", "filename": mesh["file"], "face_normals": True, "bsdf": bsdf,
                                  "to_world": mi.ScalarTransform4f().scale(MM)}
    return mi.load_dict(scene)


def work(request):
    dr.set_thread_count(1)
    scene = scene_of(request)
    said = render_seeds(request, lambda seed: np.array(mi.render(scene, spp=request["samples"], seed=seed)[1])[..., 0])
    return {"version": VERSION, **said}


serve(work)
