// SPDX-License-Identifier: MIT
#include "apps/python/bindings.h"
#include "apps/python/capture_histograms.h"
#include "nlos/formats/capture_file.h"
#include "nlos/pictures/pictures.h"
#include "renderer/core/capture/left_out_orders.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/ranges.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace python {
namespace {

namespace nb = nanobind;
using core::Capture;

/// What a capture that is made from arrays says of itself beside them.
struct CaptureFields {
    Capture& capture;
    std::optional<core::ScanPattern> pattern;
    std::optional<core::Vec3> laser_m;
    std::optional<core::Vec3> detector_m;
};

template <class Visitor>
void for_each_field(CaptureFields& s, Visitor&& visit) {
    Capture& c = s.capture;
    core::TimeAxis& t = c.time_axis;
    visit("bin_width_m", t.bin_width_m, core::above(0, "width of a bin in path length [m]"));
    visit("opl_start_m", t.opl_start_m, core::Ranged{"path length at the start of bin 0 [m]", {}});
    visit("pattern", s.pattern, "how illumination and sensing points pair up");
    visit("opl_origin", c.scan.wall().opl_origin, "where path lengths start and end");
    visit("laser_m", s.laser_m, "laser position, world [m]");
    visit("detector_m", s.detector_m, "detector position, world [m]");
    visit("unit", c.unit, "what the numbers of H are");
    visit("counts_per_radiance", c.counts_per_radiance, core::above(0, "of counts"));
}

core::WallPoints points_from(nb::handle positions, nb::handle normals, const std::string& name) {
    core::WallPoints points;
    points.positions = vectors_from(positions, name + "_points_m");
    const Extents shape = shape_of(doubles_from(positions, name + "_points_m"));
    if (shape.size() == 3) points.grid = {shape[0], shape[1]};
    points.normals = normals.is_none() ? std::vector<core::Vec3>(points.size(), core::Vec3::UnitZ())
                                       : vectors_from(normals, name + "_normals");
    for (core::Vec3& normal : points.normals) {
        if (normal.norm() > 1e-6) normal.normalize();
    }
    return points;
}

core::ScanPattern pattern_of(const Capture& capture) {
    const core::WallScan& scan = capture.scan.wall();
    if (scan.illumination.size() == 0) return core::ScanPattern::Confocal;
    return scan.illumination.size() == 1 && capture.transient.num_pairs() == scan.sensing.size()
               ? core::ScanPattern::Single
               : core::ScanPattern::Exhaustive;
}

Capture capture_from_arrays(nb::handle values,
                            nb::handle sensing,
                            nb::handle sensing_normals,
                            nb::handle illumination,
                            nb::handle illumination_normals,
                            const nb::kwargs& keywords) {
    Capture capture;
    capture.time_axis.bin_width_m = 0.0;  // to be given
    const auto fields = settings_from_python(keywords, CaptureFields{capture, {}, {}, {}});
    core::check_ranges(fields, "");
    core::WallScan& scan = capture.scan.wall();
    scan.sensing = points_from(sensing, sensing_normals, "sensing");
    if (!illumination.is_none()) {
        scan.illumination = points_from(illumination, illumination_normals, "illumination");
    }
    const HistogramArray histograms = histograms_from(values, "H");
    capture.transient = transient_from(histograms);
    scan.pattern = fields.pattern ? *fields.pattern : pattern_of(capture);
    if (scan.is_confocal()) {
        scan.illumination = scan.sensing;
    }
    capture.time_axis.num_bins = static_cast<int>(capture.transient.num_bins());
    if (scan.opl_origin == core::OplOrigin::Device && (!fields.laser_m || !fields.detector_m)) {
        throw core::Error("opl_origin",
                          "found device without laser_m and detector_m",
                          "must be relay_wall, or both positions given");
    }
    scan.laser_position = fields.laser_m.value_or(core::Vec3::Zero());
    scan.detector_position = fields.detector_m.value_or(core::Vec3::Zero());
    const Extents expected = histogram_shape(capture.scan, capture.transient.num_bins());
    if (shape_of(histograms) != expected) {
        throw core::Error("H",
                          "has shape " + shape_text(shape_of(histograms)),
                          fmt::format("must have shape {}: time, then the points of this {} scan",
                                      shape_text(expected),
                                      core::enum_name(scan.pattern)));
    }
    core::validate(capture, "capture");
    return capture;
}

Capture read_capture(const std::vector<std::string>& paths, const nb::dict& settings) {
    const auto options = settings_from_python<nlos::CaptureReadSettings>(settings);
    return with_files([&] { return nlos::read_capture(paths, options); });
}

std::vector<std::string> write_capture(const Capture& capture,
                                       nb::handle path,
                                       const std::string& layout,
                                       bool for_ytal) {
    const std::string target = path_from(path);
    return with_files([&] {
        core::validate(capture, "capture");
        return nlos::write_capture(target, capture, {for_ytal, layout});
    });
}

// Views of points in the shape of their list or grid.
template <auto List, auto Vectors>
Array<double> points_property(nb::handle self) {
    static core::WallPoints none;  // of an image
    core::Scan& scan = nb::cast<Capture&>(self).scan;
    core::WallPoints& points = scan.has_wall() ? scan.wall().*List : none;
    return array_view(points.*Vectors, points.extents(), self);
}

std::optional<Array<std::int32_t>> observed_bins(const Capture& capture) {
    if (!capture.observed) return std::nullopt;
    std::vector<std::int32_t> ranges;
    for (const core::BinRange& range : *capture.observed) {
        ranges.insert(ranges.end(), {range.begin, range.end});
    }
    return array_of(std::move(ranges), {capture.observed->size(), 2});
}

nb::list frames_of(nb::handle self) {
    auto& capture = nb::cast<Capture&>(self);
    nb::list frames;
    if (!capture.sequence) return frames;
    for (core::Transient& frame : capture.sequence->frames) {
        frames.append(histogram_view(frame, capture.scan, self));
    }
    return frames;
}

nb::dict orders_of(nb::handle self) {
    auto& capture = nb::cast<Capture&>(self);
    nb::dict orders;
    for (std::size_t i = 0; i < capture.orders.size(); ++i) {
        orders[nb::int_(capture.orders[i])] =
            histogram_view(capture.by_order[i], capture.scan, self);
    }
    return orders;
}

std::string capture_text(const Capture& capture) {
    return fmt::format("{}", fmt::join(nlos::describe_capture(capture), "\n"));
}

template <class T, class Enum>
auto name_of(Enum T::*member) {
    return [member](const T& holder) { return std::string(core::enum_name(holder.*member)); };
}

void bind_arrays(nb::class_<Capture>& binding) {
    using core::WallPoints;
    using core::WallScan;
    binding
        .def_prop_ro(
            "H",
            [](nb::handle self) {
                auto& capture = nb::cast<Capture&>(self);
                return histogram_view(capture.transient, capture.scan, self);
            },
            "float32 histograms in the capture's own memory: (T, Sx, Sy) or (T, S), exhaustive "
            "(T, Lx, Ly, Sx, Sy) or (T, L, S), of cameras (T, width, height)")
        .def_prop_ro(
            "variance",
            [](nb::handle self) -> std::optional<Array<float>> {
                auto& capture = nb::cast<Capture&>(self);
                if (!capture.variance) return std::nullopt;
                return histogram_view(*capture.variance, capture.scan, self);
            },
            "of each value of H, where known, else None")
        .def_prop_ro("frames", &frames_of, "list of arrays like H; empty unless a sequence")
        .def_prop_ro("by_order", &orders_of, "dict of bounce order: array like H")
        .def_prop_ro("sensing_points_m",
                     &points_property<&WallScan::sensing, &WallPoints::positions>,
                     "(Sx, Sy, 3) or (S, 3) float64, world [m]")
        .def_prop_ro("sensing_normals", &points_property<&WallScan::sensing, &WallPoints::normals>)
        .def_prop_ro("illumination_points_m",
                     &points_property<&WallScan::illumination, &WallPoints::positions>,
                     "(Lx, Ly, 3) or (L, 3) float64, world [m]; confocal: the sensing points")
        .def_prop_ro("illumination_normals",
                     &points_property<&WallScan::illumination, &WallPoints::normals>)
        .def_prop_ro("observed_bins",
                     &observed_bins,
                     nb::rv_policy::reference,
                     "(pairs, 2) int32, first bin and end of what was observed; None: all");
}

void bind_facts(nb::class_<Capture>& binding) {
    binding
        .def_prop_rw(
            "opl_start_m",
            [](const Capture& c) { return c.time_axis.opl_start_m; },
            [](Capture& c, double value) { c.time_axis.opl_start_m = value; },
            "path length at the start of bin 0 [m]")
        .def_prop_rw(
            "bin_width_m",
            [](const Capture& c) { return c.time_axis.bin_width_m; },
            [](Capture& c, double value) { c.time_axis.bin_width_m = value; },
            "width of a bin in path length [m]")
        .def_prop_ro("num_bins", [](const Capture& c) { return c.time_axis.num_bins; })
        .def_prop_ro(
            "axis",
            [](Capture& c) { return python_from_json(core::write_value(c.time_axis)); },
            "dict of opl_start_m, bin_width_m, num_bins")
        .def_prop_ro(
            "pattern",
            [](const Capture& c) { return std::string(core::enum_name(c.scan.pattern())); })
        .def_prop_ro(
            "opl_origin",
            [](const Capture& c) { return std::string(core::enum_name(c.scan.opl_origin())); })
        .def_prop_ro("unit", name_of(&Capture::unit), "radiance or counts")
        .def_prop_ro("laser_m",
                     [](const Capture& c) {
                         return python_from_json(core::write_value(c.scan.devices().laser));
                     })
        .def_prop_ro("detector_m",
                     [](const Capture& c) {
                         return python_from_json(core::write_value(c.scan.devices().detector));
                     })
        .def_prop_ro("is_image", [](const Capture& c) { return !c.scan.has_wall(); })
        .def_prop_ro("counts_per_radiance", [](const Capture& c) { return c.counts_per_radiance; })
        .def_prop_rw(
            "scene_info",
            [](const Capture& c) { return python_from_json(*c.scene_info); },
            [](Capture& c, const nb::dict& info) {
                c.scene_info = json_from_python(info, "scene_info");
            },
            "free dict that is stored with the capture; what is read is a copy")
        .def_prop_ro(
            core::kLeftOutOrdersKey,
            [](const Capture& c) {
                return python_from_json(core::write_value(core::recorded_left_out_orders(c)));
            },
            "bounce orders that render() did not compute since target_error allowed it: dict of "
            "first, last, error (relative L2 over all of H that this costs) and share (of the "
            "light); None: none, or not known")
        .def_ro("notes", &Capture::notes, "what the reader assumed or changed");
}

}  // namespace

void bind_capture(nb::module_& module) {
    nb::class_<Capture> binding(
        module, "Capture", nb::is_weak_referenceable(), "Transients and where they belong.");
    binding.def("__init__",
                constructor(&capture_from_arrays),
                nb::arg("H").none(),
                nb::arg("sensing_points_m").none(),
                nb::arg("sensing_normals").none() = nb::none(),
                nb::arg("illumination_points_m").none() = nb::none(),
                nb::arg("illumination_normals").none() = nb::none(),
                nb::arg("fields"));
    bind_arrays(binding);
    bind_facts(binding);
    binding
        .def("write",
             &write_capture,
             nb::arg("path").none(),
             nb::arg("layout") = "",
             nb::arg("for_ytal") = false,
             "Writes the capture by its suffix (.h5, .npz, .exr, .mat) or in a layout; returns "
             "what that does not keep, a sentence each.")
        .def(
            "copy", [](const Capture& c) { return c; }, "A capture with memory of its own.")
        .def(
            "to_xarray",
            [](const nb::object& self) {
                return nb::module_::import_("nlos.neighbours").attr("to_xarray")(self);
            },
            "H as an xarray.DataArray with named axes and units, in the same memory.")
        .def("__repr__", &capture_text);
    bind_pictures(binding,
                  &nlos::capture_panels,
                  3,
                  "PNG, SVG or PDF: streak image, light over the wall, mean transient.");
    module.def("read_capture", &read_capture, nb::arg("paths"), nb::arg("settings"));
}

}  // namespace python
