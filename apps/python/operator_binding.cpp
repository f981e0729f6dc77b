// SPDX-License-Identifier: MIT
// The statistical solver's linear operators, from voxels to histograms and back.
#include "apps/python/bindings.h"
#include "apps/python/operators.h"
#include "apps/python/wall_frame_binding.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace python {
namespace {

namespace nb = nanobind;

using VolumeArray = nb::ndarray<const float, nb::device::cpu, nb::c_contig>;

OperatorSettings read_settings(const nb::dict& keywords) {
    const auto settings = settings_from_python<OperatorSettings>(keywords);
    core::check_ranges(settings, "");
    if (settings.falloff == nlos::Falloff::Auto) {
        throw core::Error("falloff", "found auto", "must be diffuse, retro or facing");
    }
    return settings;
}

std::vector<float> volume_from(nb::handle value, const Extents& shape) {
    const auto array = nb::cast<VolumeArray>(numbers_from(value, "float32", "volume"));
    require_shape(shape_of(array), shape, "volume");
    return {array.data(), array.data() + array.size()};
}

core::Transient light_from(nb::handle value, const Extents& shape) {
    const HistogramArray array = histograms_from(value, "H");
    require_shape(shape_of(array), shape, "H");
    return transient_from(array);
}

/// Histograms of one's own as an array with time first.
Array<float> as_array(core::Transient light, const core::Scan& scan) {
    auto* const owned = new core::Transient(std::move(light));
    return histogram_view(*owned, scan, owner_of(owned));
}

template <auto Axis, class Operator>
Array<double> axis_of(const Operator& self) {
    const std::vector<double>& centres = self.domain().axes.*Axis;
    return array_of(centres, {centres.size()});
}

template <class Operator>
void bind_application(nb::class_<Operator>& binding) {
    binding
        .def(
            "forward",
            [](Operator& self, nb::handle volume) {
                const auto values = volume_from(volume, self.domain().volume_shape());
                return as_array(
                    run_long(
                        nb::none(), 0, [&](const core::Progress&) { return self.forward(values); }),
                    self.domain().scan);
            },
            nb::arg("volume"),
            "(X, Y, Z) albedo to histograms of the shape of the capture's H.")
        .def(
            "adjoint",
            [](Operator& self, nb::handle histograms) {
                const auto light = light_from(histograms, self.domain().light_shape());
                return array_of(
                    run_long(
                        nb::none(), 0, [&](const core::Progress&) { return self.adjoint(light); }),
                    self.domain().volume_shape());
            },
            nb::arg("H"),
            "The exact transpose of forward().")
        .def_prop_ro(
            "volume_shape",
            [](const Operator& self) { return nb::tuple(nb::cast(self.domain().volume_shape())); })
        .def_prop_ro("x_m",
                     &axis_of<&nlos::VolumeAxes::x_m, Operator>,
                     nb::rv_policy::reference,
                     "(X,) voxel centres along wall x [m]")
        .def_prop_ro("y_m",
                     &axis_of<&nlos::VolumeAxes::y_m, Operator>,
                     nb::rv_policy::reference,
                     "(Y,) voxel centres along wall y [m]")
        .def_prop_ro("z_m",
                     &axis_of<&nlos::VolumeAxes::z_m, Operator>,
                     nb::rv_policy::reference,
                     "(Z,) depths of voxel centres from the wall [m]");
    bind_wall_frame(
        binding,
        [](const Operator& self) -> const auto& { return self.domain().axes.world_from_wall; });
}

std::vector<double> centres_from(nb::handle value, const std::string& name) {
    const auto array = doubles_from(value, name);
    if (array.ndim() != 1 || array.size() == 0) {
        throw core::Error(name,
                          "has shape " + shape_text(shape_of(array)),
                          "must be a list of voxel centres in the wall's frame [m]");
    }
    return {array.data(), array.data() + array.size()};
}

const core::Capture& checked(const core::Capture& capture) {
    core::validate(capture, "capture");
    capture.scan.wall("capture");  // or throws
    return capture;
}

}  // namespace

void bind_operators(nb::module_& module) {
    nb::class_<PairLight> pairs(module,
                                "PairOperator",
                                "Light of voxels at any pairs of wall points, albedo over squared "
                                "segments, and its exact adjoint, which is backprojection.");
    pairs.def(
        "__init__",
        [](PairLight* self,
           const core::Capture& capture,
           nb::handle x_m,
           nb::handle y_m,
           nb::handle z_m,
           const nb::kwargs& settings) {
            new (self) PairLight(
                checked(capture),
                {centres_from(x_m, "x_m"), centres_from(y_m, "y_m"), centres_from(z_m, "z_m")},
                read_settings(settings));
        },
        nb::arg("capture"),
        nb::arg("x_m"),
        nb::arg("y_m"),
        nb::arg("z_m"),
        nb::arg("settings"));
    bind_application(pairs);
    nb::class_<LightCone> cone(module,
                               "LightConeOperator",
                               "The light-cone model of a confocal grid by Fourier transforms, up "
                               "to a factor, and its exact adjoint. Voxels stand at the wall "
                               "points, in even bins of squared depth.");
    cone.def(
        "__init__",
        [](LightCone* self, const core::Capture& capture, const nb::kwargs& settings) {
            new (self) LightCone(checked(capture), read_settings(settings));
        },
        nb::arg("capture"),
        nb::arg("settings"));
    bind_application(cone);
}

}  // namespace python
