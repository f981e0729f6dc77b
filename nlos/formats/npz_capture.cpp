// SPDX-License-Identifier: MIT
#include "nlos/containers/writers/npz_writer.h"
#include "nlos/formats/capture_array_reader.h"
#include "nlos/formats/capture_arrays.h"
#include "nlos/formats/capture_format.h"
#include "nlos/formats/ytal_layout.h"
#include "renderer/core/settings/settings_json.h"

namespace nlos {
namespace {

using core::Capture;
using core::WallPoints;

// A capture as a NumPy .npz file, for which numpy alone is needed. Names and shapes are y-tal's:
//
//   H                                        float32, time slowest, see histogram_shape()
//   sensor_grid_xyz, laser_grid_xyz          float64 (X, Y, 3) or (N, 3) [m, world]; none: an image
//   sensor_grid_normals, laser_grid_normals  as these
//   sensor_xyz, laser_xyz                    float64 (3,) [m, world]
//   t_start, delta_t                         float64 () [m of path length]
//   pattern, opl_origin, unit                text: confocal | single | exhaustive,
//                                            relay_wall | device, radiance | counts
//   scene_info                               text: JSON, where the capture came from
//   counts_per_radiance                      float64 (), when known
//   variance                                 as H, when known
//   orders, H_by_order                       int32 (K,) and float32 (K, as H), when resolved
//   observed_bins                            int32 (2, as H without T): first observed bin and the
//                                            one after the last, where some were not observed
//   frames, gate_step_m, frame_s             float32 (F, as H) and float64 (), of a sequence
//   frame_error                              float64 (F), relative L2 of each frame, NaN: not known
//   frames_observed_bins                     int32 (F, as observed_bins), where frames differ

void write_points(NpzWriter& file,
                  const std::string& device,
                  const WallPoints& points,
                  const ArrayLayout& layout) {
    Shape shape = point_extents(points, layout);
    shape.push_back(3);
    const auto write = [&](const std::string& name, const std::vector<core::Vec3>& vectors) {
        std::vector<double> values;
        values.reserve(3 * vectors.size());
        for (const core::Vec3& vector : vectors) {
            values.insert(values.end(), vector.begin(), vector.end());
        }
        file.write(name, shape, values);
    };
    write(device + "_grid_xyz", points.positions);
    write(device + "_grid_normals", points.normals);
}

void write_scan(NpzWriter& file, const core::Scan& scan) {
    const ArrayLayout layout = array_layout(scan);
    if (scan.has_wall()) {
        write_points(file, "sensor", scan.wall().sensing, layout);
        write_points(file, "laser", scan.wall().illumination, layout);
    }
    const core::Devices devices = scan.devices();
    file.write("sensor_xyz", {3}, std::span<const double>(devices.detector.data(), 3));
    file.write("laser_xyz", {3}, std::span<const double>(devices.laser.data(), 3));
    file.write_text("pattern", std::string(enum_name(scan.pattern())));
    file.write_text("opl_origin", std::string(enum_name(scan.opl_origin())));
}

Capture read_npz(const ArrayReader& file, const CaptureReadSettings& settings) {
    Capture capture = read_histograms(file, settings);
    if (file.has("unit")) {
        core::read_value(core::Json(file.read_text("unit")), file.where("unit"), capture.unit);
    } else {
        capture.notes.emplace_back("unit is missing: radiance assumed");
    }
    if (file.has("counts_per_radiance")) {
        capture.counts_per_radiance =
            checked_scale(file.read_real("counts_per_radiance"), file.where("counts_per_radiance"));
    }
    read_optional_arrays(file, "", capture);
    if (capture.sequence && file.has("gate_step_m")) {
        capture.sequence->gate_step_m = file.read_real("gate_step_m");
    }
    if (capture.sequence && file.has("frame_s")) {
        capture.sequence->frame_s = file.read_real("frame_s");
    }
    return capture;
}

CaptureFormat::Read open_npz(const std::string& path) {
    const auto file = open_arrays(path);
    if (!file || file->container() != "npz" || !file->has_object("H")) return nullptr;
    return [file](const CaptureReadSettings& settings) { return read_npz(*file, settings); };
}

}  // namespace

CaptureFormat npz_format() {
    return {"NumPy .npz", open_npz};
}

std::vector<std::string> write_npz(const std::string& path,
                                   const Capture& capture,
                                   const CaptureWriteSettings&) {
    const Shape shape = histogram_shape(capture);

    NpzWriter file(path);
    write_transient(file, "H", shape, capture.transient);
    write_scan(file, capture.scan);
    file.write_real("t_start", capture.time_axis.opl_start_m);
    file.write_real("delta_t", capture.time_axis.bin_width_m);
    file.write_text("unit", std::string(enum_name(capture.unit)));
    file.write_text(
        "scene_info",
        scene_info_of(capture).dump(-1, ' ', false, core::Json::error_handler_t::replace));
    if (capture.counts_per_radiance) {
        file.write_real("counts_per_radiance", *capture.counts_per_radiance);
    }
    if (capture.observed) {
        Shape bins = shape;
        bins[0] = 2;
        file.write("observed_bins", bins, observed_array(*capture.observed));
    }
    if (capture.variance) write_transient(file, "variance", shape, *capture.variance);
    if (!capture.orders.empty()) {
        file.write("orders", {capture.orders.size()}, std::span<const int>(capture.orders));
        write_stack(file, "H_by_order", shape, capture.by_order);
    }
    if (capture.sequence) {
        write_stack(file, "frames", shape, capture.sequence->frames);
        file.write_real("gate_step_m", capture.sequence->gate_step_m);
        file.write_real("frame_s", capture.sequence->frame_s);
        if (const auto& errors = capture.sequence->errors; !errors.empty()) {
            file.write("frame_error", {errors.size()}, std::span<const double>(errors));
        }
        if (!capture.sequence->observed.empty()) {
            Shape bins = shape;
            bins[0] = 2;
            bins.insert(bins.begin(), capture.sequence->frames.size());
            file.write("frames_observed_bins", bins, observed_array_of_frames(capture));
        }
    }
    file.finish();
    if (capture.velocity) return {"velocities are left out"};
    return {};
}

}  // namespace nlos
