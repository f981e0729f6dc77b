# SPDX-License-Identifier: MIT
"""Renders a scene by mitransient, lit at one point of the wall, once for every seed.

Conventions, and how they are met. Unit: a projector of irradiance 1 sheds pi cos / distance^2 on its
spot, which counts as one unit of area; dividing by that gives radiance for 1 W, as ours. Orders:
`max_depth` is the number of bounces, as the segment from the laser is none of its loop. Lengths: rays
start 9e-5 (1 + |p|) off a surface at p, in the scene's unit, which shortens paths; in metres by
0.11 mm, so that the scene is given in millimetres, where 0.02 mm are left. Faces: one-sided, so that
the request has to turn them to the light. Laser and detector stand beside the wall, where nothing
hides it, and paths count from wall to wall. Rows of the image run along y.
Hidden-geometry sampling counts a direction once for every surface that it crosses from the front:
scenes whose surfaces hide one another come out too bright, which is left as it is.
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


def scene_of(request, device):
    wall = request["relay_wall"]
    pose = np.eye(4)
    pose[:3] = MM * np.stack([np.array(wall["x_axis"]) * wall["size_m"][0] / 2,
                              np.array(wall["y_axis"]) * wall["size_m"][1] / 2,
                              np.array(wall["normal"]) / MM, wall["center_m"]], axis=1)
    film = {"type": "transient_hdr_film", "rfilter": {"type": "box"}, "temporal_bins": request["num_bins"],
            "start_opl": MM * request["opl_start_m"], "bin_width_opl": MM * request["bin_width_m"],
            **dict(zip(("width", "height"), request["sensing_points"]))}
    is_hidden = request["sampling"] == "hidden"
    scene = {
        "type": "scene",
        "integrator": {"type": "transient_nlos_path", "nlos_laser_sampling": True, "temporal_filter": "box",
                       "nlos_hidden_geometry_sampling": is_hidden, "discard_direct_paths": True,
                       "nlos_hidden_geometry_sampling_includes_relay_wall": is_hidden and request["max_bounces"] > 3,
                       "max_depth": request["max_bounces"], "rr_depth": 1000},
        "relay_wall": {"type": "rectangle", "to_world": mi.ScalarTransform4f(pose),
                       "bsdf": {"type": "diffuse", "reflectance": wall["albedo"]},
                       "sensor": {"type": "nlos_capture_meter", "sensor_origin": list(MM * device), "film": film}},
        "laser": {"type": "projector", "irradiance": 1.0, "fov": 0.2, "to_world": mi.ScalarTransform4f().look_at(
            origin=list(MM * device), target=[MM * v for v in request["illumination_m"]], up=wall["normal"])}}
    for number, mesh in enumerate(request["meshes"]):
        bsdf = {"type": "diffuse", "reflectance": mesh["albedo"]}
        scene[f"hidden{number}"] = {"type": "ply", "filename": mesh["file"], "face_normals": True, "bsdf": bsdf,
                                    "to_world": mi.ScalarTransform4f().scale(MM)}
    return mi.load_dict(scene)


def work(request):
    dr.set_thread_count(1)
    centre, x, normal = (np.array(request["relay_wall"][key]) for key in ("center_m", "x_axis", "normal"))
    device = centre + request["relay_wall"]["size_m"][0] * (x + 0.2 * normal)
    scene = scene_of(request, device)
    to_laser = device - request["illumination_m"]
    watts = np.pi * (to_laser @ normal) / np.linalg.norm(to_laser)**3 / MM**2  # on the spot of 1 mm^2
    said = render_seeds(request, lambda seed: np.array(mi.render(scene, spp=request["samples"], seed=seed)[1])[..., 0],
                        MM**2 / watts)
    return {"version": VERSION, **said}


serve(work)
