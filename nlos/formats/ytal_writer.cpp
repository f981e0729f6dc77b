// SPDX-License-Identifier: MIT
#include "nlos/containers/writers/hdf5_writer.h"
#include "nlos/formats/capture_arrays.h"
#include "nlos/formats/capture_format.h"
#include "nlos/formats/coordinates.h"
#include "nlos/formats/ytal_layout.h"
#include "renderer/core/capture/left_out_orders.h"
#include "renderer/core/precision.h"
#include "renderer/core/settings/json_file.h"

#include <algorithm>
#include <span>

namespace nlos {
namespace {

using core::Capture;
using core::WallPoints;

HFormat h_format(const ArrayLayout& layout) {
    if (layout.exhaustive) return layout.grids ? HFormat::TLxLySxSy : HFormat::TLiSi;
    return layout.grids ? HFormat::TSxSy : HFormat::TSi;
}

void write_no_points(Hdf5Writer& file, const std::string& device) {
    file.write_null(device + "_grid_xyz");
    file.write_null(device + "_grid_normals");
    file.write_enum(
        device + "_grid_format", grid_format_members(), static_cast<int>(GridFormat::Unknown));
}

// In single precision, as y-tal writes it, unless points are too far from the world's origin.
void write_positions(Hdf5Writer& file,
                     const std::string& name,
                     const Shape& shape,
                     const std::vector<core::Vec3>& positions) {
    if (std::ranges::any_of(positions, core::needs_double)) {
        const double* const first = positions.front().data();
        file.write(name, shape, std::span<const double>(first, 3 * positions.size()));
    } else {
        file.write(name, shape, to_floats(positions));
    }
    state_coordinates(file, name, kWorldPositions);
}

void write_points(Hdf5Writer& file,
                  const std::string& device,
                  const WallPoints& points,
                  const ArrayLayout& layout) {
    Shape shape = point_extents(points, layout);
    shape.push_back(3);
    write_positions(file, device + "_grid_xyz", shape, points.positions);
    const std::string normals = device + "_grid_normals";
    file.write(normals, shape, to_floats(points.normals));
    state_coordinates(file, normals, kWorldDirections);
    file.write_enum(device + "_grid_format",
                    grid_format_members(),
                    static_cast<int>(layout.grids ? GridFormat::XY3 : GridFormat::N3));
}

/// Power by path velocity: (V, pairs...), or (V, T, pairs...) with time.
void write_velocity(Hdf5Writer& file,
                    const Shape& h_shape,
                    const core::VelocityHistogram& velocity) {
    Shape shape = h_shape;
    if (velocity.axis.with_time) {
        shape.insert(shape.begin(), static_cast<std::size_t>(velocity.axis.num_bins));
    } else {
        shape[0] = static_cast<std::size_t>(velocity.axis.num_bins);
    }
    const std::size_t bins_per_row = velocity.axis.with_time ? h_shape[0] : 1;
    const auto write = [&](const std::string& name, const core::Transient& values) {
        file.write_rows(
            name, shape, [&](std::size_t first, std::size_t count, std::vector<float>& rows) {
                copy_rows(values, first * bins_per_row, count * bins_per_row, rows.data());
            });
    };
    write("nlos/velocity", velocity.values);
    const auto attribute = [&](const char* name, double value) {
        file.write_attribute("nlos/velocity", name, {1}, {{value}});
    };
    attribute(kVelocityStart, velocity.axis.start_m_per_s);
    attribute(kVelocityBinWidth, velocity.axis.bin_width_m_per_s);
    attribute(kVelocityCarrier, velocity.axis.carrier_hz);
    if (velocity.variance) write("nlos/velocity_variance", *velocity.variance);
}

void write_observed_bins(Hdf5Writer& file,
                         const Shape& h_shape,
                         const std::vector<core::BinRange>& observed) {
    Shape shape = h_shape;
    shape[0] = 2;
    file.write("nlos/observed_bins", shape, observed_array(observed));
}

void state_left_out_orders(Hdf5Writer& file, const Capture& capture) {
    const auto orders = core::recorded_left_out_orders(capture);
    if (!orders) return;
    const double first = orders->first;
    const double last = orders->last;
    file.write_attribute("H", kLeftOutOrders, {2}, {{first, last}});
    file.write_attribute("H", kLeftOutError, {1}, {{orders->error}});
    file.write_attribute("H", kLeftOutShare, {1}, {{orders->share}});
}

/// What y-tal has no name for, if there is any and y-tal need not read the file.
/// returns   whether there is any beside the unit
bool write_own_group(Hdf5Writer& file,
                     const Shape& h_shape,
                     const Capture& capture,
                     const CaptureWriteSettings& settings) {
    const bool radiance = capture.unit == core::TransientUnit::Radiance;
    const bool has_own = capture.variance || !capture.orders.empty() || capture.velocity ||
                         capture.sequence || capture.observed;
    if ((!has_own && radiance) || settings.for_ytal) return has_own;
    file.create_group("nlos");
    file.write_attribute("nlos", "unit", std::string(enum_name(capture.unit)));
    if (capture.counts_per_radiance) {
        file.write_attribute("nlos", "counts_per_radiance", {}, {&*capture.counts_per_radiance, 1});
    }
    if (capture.observed) write_observed_bins(file, h_shape, *capture.observed);
    if (capture.variance) write_transient(file, "nlos/variance", h_shape, *capture.variance);
    if (!capture.orders.empty()) {
        write_stack(file, "nlos/H_by_order", h_shape, capture.by_order);
        file.write("nlos/orders", {capture.orders.size()}, capture.orders);
    }
    if (capture.velocity) write_velocity(file, h_shape, *capture.velocity);
    if (capture.sequence) {
        write_stack(file, "nlos/frames", h_shape, capture.sequence->frames);
        file.write_attribute("nlos/frames", kGateStep, {1}, {{capture.sequence->gate_step_m}});
        file.write_attribute("nlos/frames", kFrameTime, {1}, {{capture.sequence->frame_s}});
        if (const auto& errors = capture.sequence->errors; !errors.empty()) {
            file.write("nlos/frame_error", {errors.size()}, errors);
        }
        if (!capture.sequence->observed.empty()) {
            Shape shape = h_shape;
            shape[0] = 2;
            shape.insert(shape.begin(), capture.sequence->frames.size());
            file.write("nlos/frames_observed_bins", shape, observed_array_of_frames(capture));
        }
    }
    return has_own;
}

}  // namespace

std::vector<std::string> write_ytal(const std::string& path,
                                    const Capture& capture,
                                    const CaptureWriteSettings& settings) {
    const core::Scan& scan = capture.scan;
    const ArrayLayout layout = array_layout(scan);
    const Shape h_shape = histogram_shape(capture);
    core::Json scene_info = scene_info_of(capture);
    if (settings.for_ytal) scene_info[kUnitKey] = enum_name(capture.unit);

    Hdf5Writer file(path);
    write_transient(file, "H", h_shape, capture.transient);
    state_left_out_orders(file, capture);
    file.write_enum("H_format", h_format_members(), static_cast<int>(h_format(layout)));
    write_positions(file, "sensor_xyz", {3}, {scan.devices().detector});
    write_positions(file, "laser_xyz", {3}, {scan.devices().laser});
    if (scan.has_wall()) {
        write_points(file, "sensor", scan.wall().sensing, layout);
        write_points(file, "laser", scan.wall().illumination, layout);
    } else {
        write_no_points(file, "sensor");
        write_no_points(file, "laser");
    }
    file.write_enum("volume_format", volume_format_members(), kVolumeFormatXYZ3);
    file.write_real("delta_t", capture.time_axis.bin_width_m);
    file.write_real("t_start", capture.time_axis.opl_start_m);
    file.write_bool("t_accounts_first_and_last_bounces",
                    scan.opl_origin() == core::OplOrigin::Device);
    file.write_text("scene_info", scene_info_text(scene_info));
    const bool has_own = write_own_group(file, h_shape, capture, settings);
    file.finish();
    if (settings.for_ytal && has_own) {
        return {
            "the group /nlos (variance, orders of bounces, velocities, frames, observed bins) "
            "is left out"};
    }
    return {};
}

}  // namespace nlos
