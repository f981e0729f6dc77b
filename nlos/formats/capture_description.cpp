// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_file.h"
#include "renderer/core/capture/left_out_orders.h"
#include "renderer/core/capture/sensor_footprint.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

namespace nlos {
namespace {

/// What the observed bins hold.
std::string describe_values(const core::Capture& capture) {
    double sum = 0.0;
    std::optional<std::array<float, 2>> range;
    for (std::size_t pair = 0; pair < capture.transient.num_pairs(); ++pair) {
        for (const float value : capture.observed_values(pair)) {
            sum += value;
            if (!range) range = {value, value};
            range = {std::min((*range)[0], value), std::max((*range)[1], value)};
        }
    }
    const auto [low, high] = range.value_or(std::array{0.0F, 0.0F});
    return fmt::format("histograms: {}, from {:.6g} to {:.6g}, sum {:.6g}",
                       enum_name(capture.unit),
                       low,
                       high,
                       sum);
}

/// Which bins of which points were observed, when not all were.
std::string describe_observed(const core::Capture& capture) {
    const std::vector<core::BinRange>& observed = *capture.observed;
    const std::size_t blind = static_cast<std::size_t>(std::ranges::count_if(
        observed, [](const core::BinRange& range) { return range.size() == 0; }));
    const core::BinRange hull = core::observed_hull(capture.observed, capture.time_axis.num_bins);
    if (hull.size() == 0) return fmt::format("observed: no bin of {} pairs", observed.size());
    const std::size_t whole = static_cast<std::size_t>(std::ranges::count(observed, hull));
    const std::size_t partial = observed.size() - whole - blind;
    const std::size_t most = whole > 0 ? whole : partial;
    std::string text = fmt::format("observed: {}bins {} to {} of {} {} pairs",
                                   whole > 0 ? "" : "parts of ",
                                   hull.begin,
                                   hull.end - 1,
                                   most == observed.size() ? "all" : fmt::format("{} of", most),
                                   observed.size());
    if (whole > 0 && partial > 0) text += fmt::format("; fewer of {}", partial);
    if (blind > 0) text += fmt::format("; {} not at all", blind);
    return text;
}

/// How the observed bins of frames move.
std::string describe_observed_frames(const core::Capture& capture) {
    const auto hull = [&](const core::ObservedBins& observed) {
        return core::observed_hull(observed, capture.time_axis.num_bins);
    };
    const core::BinRange first = hull(capture.sequence->observed.front());
    const core::BinRange last = hull(capture.sequence->observed.back());
    return fmt::format(
        "each frame has its own observed bins: {} to {} in the first, {} to {} in "
        "the last",
        first.begin,
        first.end - 1,
        last.begin,
        last.end - 1);
}

/// How many points there are, and their largest extents along x, y and z.
std::string describe_points(const char* kind, const core::WallPoints& points) {
    Eigen::AlignedBox3d box;
    for (const core::Vec3& position : points.positions) box.extend(position);
    const core::Vec3 size = box.sizes();
    return fmt::format("{}{} points over {:.4g} x {:.4g} x {:.4g} m",
                       points.grid ? fmt::format("{} x {}", (*points.grid)[0], (*points.grid)[1])
                                   : fmt::format("{}", points.size()),
                       kind,
                       size.x(),
                       size.y(),
                       size.z());
}

std::vector<std::string> describe(const core::WallScan& scan) {
    return {fmt::format(
                "scan: {}, {}", enum_name(scan.pattern), describe_points(" sensing", scan.sensing)),
            "illumination: " + describe_points("", scan.illumination)};
}

std::vector<std::string> describe(const core::ImageScan& image) {
    const core::PinholeCamera& camera = image.camera;
    return {fmt::format("camera: {} x {} pixels, {:.4g} degrees high, at {} m, looking at {} m",
                        camera.width(),
                        camera.height(),
                        camera.fov_y_deg,
                        core::vector_text(camera.position_m),
                        core::vector_text(camera.look_at_m)),
            fmt::format("light: {} at {} m; path lengths run from it to the camera",
                        camera.light_spot_m ? "spot on a surface" : "point",
                        core::vector_text(camera.light_position()))};
}

std::string describe_velocity(const core::VelocityHistogram& velocity) {
    const core::VelocityAxis& axis = velocity.axis;
    double sum = 0.0;
    for (const float value : velocity.values.values()) sum += value;
    const auto shift_hz = [&](double velocity_m_per_s) {
        return core::frequency_shift_hz(axis.carrier_hz, velocity_m_per_s);
    };
    return fmt::format(
        "path velocity{}: {} bins of {:.6g} m/s, from {:.6g} to {:.6g} m/s, sum {:.6g}; at {:.6g} "
        "Hz a shift from {:.6g} to {:.6g} Hz",
        axis.with_time ? " with time" : "",
        axis.num_bins,
        axis.bin_width_m_per_s,
        axis.start_m_per_s,
        axis.end_m_per_s(),
        sum,
        axis.carrier_hz,
        shift_hz(axis.start_m_per_s),
        shift_hz(axis.end_m_per_s()));
}

}  // namespace

std::vector<std::string> describe_capture(const core::Capture& capture) {
    const core::Scan& scan = capture.scan;
    const core::TimeAxis& axis = capture.time_axis;
    std::vector<std::string> lines = scan.visit([](const auto& kind) { return describe(kind); });
    if (const auto sensor = core::recorded_sensor(capture)) {
        const std::vector<std::string> of_sensor = core::describe_sensor(*sensor);
        lines.insert(lines.end(), of_sensor.begin(), of_sensor.end());
    }
    lines.push_back(
        fmt::format("time axis: {} bins of {:.6g} m of path length ({:.4g} ps), from {:.6g} to "
                    "{:.6g} m",
                    axis.num_bins,
                    axis.bin_width_m,
                    axis.bin_width_ps(),
                    axis.opl_start_m,
                    axis.opl_end_m()));
    if (scan.has_wall()) {
        lines.push_back(
            fmt::format("path lengths {} the segments to laser and detector",
                        scan.opl_origin() == core::OplOrigin::Device ? "include" : "exclude"));
    }
    if (capture.observed) lines.push_back(describe_observed(capture));
    if (capture.velocity) lines.push_back(describe_velocity(*capture.velocity));
    if (capture.sequence) {
        lines.push_back(
            fmt::format("frames: {}, {:.6g} s apart, the axis moves by {:.6g} m per frame; what "
                        "else is said here is of the last one",
                        capture.sequence->frames.size(),
                        capture.sequence->frame_s,
                        capture.sequence->gate_step_m));
    }
    if (capture.sequence && !capture.sequence->errors.empty()) {
        const std::vector<double>& errors = capture.sequence->errors;
        lines.push_back(fmt::format("errors of frames: {:.2g} of the first, {:.2g} of the last",
                                    errors.front(),
                                    errors.back()));
    }
    if (capture.sequence && !capture.sequence->observed.empty()) {
        lines.push_back(describe_observed_frames(capture));
    }
    lines.push_back(describe_values(capture));
    if (const auto orders = core::recorded_left_out_orders(capture)) {
        lines.push_back(fmt::format("left out: bounces of {}; an error of {:.2g}, relative L2",
                                    core::describe(*orders),
                                    orders->error));
    }
    if (capture.counts_per_radiance) {
        lines.push_back(
            fmt::format("counts per unit of radiance: {:.6g}", *capture.counts_per_radiance));
    }
    if (scan.opl_origin() == core::OplOrigin::RelayWall) {
        // Seen at right angles from a confocal point, depth is half the path length.
        const core::BinRange hull = core::observed_hull(capture.observed, axis.num_bins);
        lines.push_back(fmt::format("depth range: {:.4g} to {:.4g} m",
                                    0.5 * std::max(0.0, axis.bin_begin_m(hull.begin)),
                                    0.5 * axis.bin_begin_m(hull.end)));
    }
    lines.insert(lines.end(), capture.notes.begin(), capture.notes.end());
    return lines;
}

}  // namespace nlos
