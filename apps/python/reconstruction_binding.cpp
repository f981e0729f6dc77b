// SPDX-License-Identifier: MIT
#include "apps/python/bindings.h"
#include "apps/python/wall_frame_binding.h"
#include "nlos/formats/volume_file.h"
#include "nlos/pictures/pictures.h"
#include "nlos/reconstruction/surface_mesh.h"
#include "nlos/setup_uncertainty.h"
#include "renderer/core/mesh_formats/ply_writer.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace python {
namespace {

namespace nb = nanobind;
using nlos::Reconstruction;

Extents columns_of(const Reconstruction& result) {
    return {result.volume.axes.x_m.size(), result.volume.axes.y_m.size()};
}

Array<float> volume_view(nb::handle self) {
    auto& volume = nb::cast<Reconstruction&>(self).volume;
    const nlos::VolumeAxes& axes = volume.axes;
    return array_view(
        volume.values.data(), {axes.x_m.size(), axes.y_m.size(), axes.z_m.size()}, self);
}

template <auto Axis>
Array<double> axis_view(nb::handle self) {
    auto& values = nb::cast<Reconstruction&>(self).volume.axes.*Axis;
    return array_view(values.data(), {values.size()}, self);
}

// Of what is reported per column, where it is.
template <auto ValuesOf>
std::optional<Array<double>> column_view(nb::handle self) {
    auto& result = nb::cast<Reconstruction&>(self);
    std::vector<double>& values = ValuesOf(result);
    if (values.empty()) return std::nullopt;
    return array_view(values.data(), columns_of(result), self);
}

nb::tuple mesh_of(const Reconstruction& result) {
    core::TriangleMesh mesh = nlos::surface_mesh(result.depth);
    return nb::make_tuple(array_of(std::move(mesh.vertices)), array_of(std::move(mesh.triangles)));
}

nb::object setup_of(const Reconstruction& result) {
    if (!result.setup) return nb::none();
    core::Json setup = nlos::setup_json(result);
    setup["text"] = nlos::describe(*result.setup);
    return python_from_json(setup);
}

void write(const Reconstruction& result, nb::handle target) {
    const std::string path = path_from(target);
    with_files([&] {
        if (path.ends_with(".ply")) {
            core::write_ply(path, result.points);
        } else {
            nlos::write_volume(path, result);
        }
    });
}

std::string reconstruction_text(const Reconstruction& result) {
    const nlos::VolumeAxes& axes = result.volume.axes;
    return fmt::format("Reconstruction by {}: {} x {} x {} voxels, {} surface points, {:.2f} s",
                       result.method,
                       axes.x_m.size(),
                       axes.y_m.size(),
                       axes.z_m.size(),
                       result.points.positions.size(),
                       result.seconds);
}

void bind_arrays(nb::class_<Reconstruction>& binding) {
    using nlos::VolumeAxes;
    binding.def_prop_ro("volume", &volume_view, "(X, Y, Z) float32, in the result's own memory")
        .def_prop_ro("x_m", &axis_view<&VolumeAxes::x_m>, "(X,) voxel centres along wall x [m]")
        .def_prop_ro("y_m", &axis_view<&VolumeAxes::y_m>, "(Y,) voxel centres along wall y [m]")
        .def_prop_ro(
            "z_m", &axis_view<&VolumeAxes::z_m>, "(Z,) depths of voxel centres from the wall [m]")
        .def_prop_ro("depth_m",
                     &column_view<[](auto& r) -> auto& { return r.depth.depth_m; }>,
                     "(X, Y) float64 depth of the surface from the wall [m]; NaN: background")
        .def_prop_ro("depth_sigma_m",
                     &column_view<[](auto& r) -> auto& { return r.depth_sigma_m; }>,
                     "(X, Y) standard deviation of depth_m [m]; None where the noise is not known")
        .def_prop_ro("surface_probability",
                     &column_view<[](auto& r) -> auto& { return r.surface_probability; }>,
                     "(X, Y) probability that a column holds a surface; None: not given")
        .def_prop_ro(
            "normals",
            [](nb::handle self) -> std::optional<Array<double>> {
                auto& result = nb::cast<Reconstruction&>(self);
                if (result.depth.normals.empty()) return std::nullopt;
                return array_view(result.depth.normals, columns_of(result), self);
            },
            "(X, Y, 3) float64 normals of the surface, world, unit; None: not known")
        .def_prop_ro(
            "points_m",
            [](nb::handle self) {
                auto& points = nb::cast<Reconstruction&>(self).points.positions;
                return array_view(points, {points.size()}, self);
            },
            "(N, 3) float64 surface points, world [m]");
}

}  // namespace

void bind_reconstruction(nb::module_& module) {
    nb::class_<Reconstruction> binding(module,
                                       "Reconstruction",
                                       nb::is_weak_referenceable(),
                                       "What reconstruct() found, and what it took.");
    bind_arrays(binding);
    bind_wall_frame(
        binding,
        [](const Reconstruction& r) -> const auto& { return r.volume.axes.world_from_wall; });
    binding.def_ro("method", &Reconstruction::method, "the one that ran")
        .def_ro("reason", &Reconstruction::reason, "why `auto` took it")
        .def_ro("findings", &Reconstruction::findings, "what `auto` found, a line each")
        .def_ro("warnings", &Reconstruction::warnings)
        .def_ro("seconds", &Reconstruction::seconds)
        .def_prop_ro(
            "settings",
            [](const Reconstruction& r) { return python_from_json(core::write_value(r.settings)); },
            "with every choice filled in")
        .def_prop_ro("setup",
                     &setup_of,
                     "what an uncertain set-up (reconstruct(..., setup={...})) does to depths, "
                     "which depth_sigma_m counts: dict of its standard deviations, the medians of "
                     "what noise and set-up make of depths [m] and a text; None: it is exact")
        .def("mesh",
             &mesh_of,
             "The surface as (vertices (N, 3) float64, world [m]; faces (M, 3) uint32).")
        .def("write",
             &write,
             nb::arg("path").none(),
             "Writes the volume (.h5) or its points (.ply).")
        .def("__repr__", &reconstruction_text);
    bind_pictures(binding,
                  &nlos::volume_panels,
                  2,
                  "PNG, SVG or PDF: projections, depth, and what is reported about it.");
    module.def(
        "read_volume",
        [](const std::string& path) { return with_files([&] { return nlos::read_volume(path); }); },
        nb::arg("path"));
}

}  // namespace python
