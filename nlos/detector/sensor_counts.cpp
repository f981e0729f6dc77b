// SPDX-License-Identifier: MIT
#include "nlos/detector/sensor_counts.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nlos {
namespace {

void mix(const core::SensorModel& model, core::Transient& zones) {
    const core::Transient before = zones;
    const auto fraction = static_cast<float>(model.detector.zone_crosstalk);
    const int columns = model.zones[0];
    const int rows = model.zones[1];
    const auto move = [&](int from, int to) {
        const auto source = before.histogram(static_cast<std::size_t>(from));
        const auto loss = zones.histogram(static_cast<std::size_t>(from));
        const auto gain = zones.histogram(static_cast<std::size_t>(to));
        for (std::size_t bin = 0; bin < source.size(); ++bin) {
            loss[bin] -= fraction * source[bin];
            gain[bin] += fraction * source[bin];
        }
    };
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const int zone = row * columns + column;
            if (column > 0) move(zone, zone - 1);
            if (column + 1 < columns) move(zone, zone + 1);
            if (row > 0) move(zone, zone - columns);
            if (row + 1 < rows) move(zone, zone + columns);
        }
    }
    // Rounding leaves a trace of less than nothing where all light left.
    for (float& value : zones.values()) value = std::max(value, 0.0F);
}

/// Radiance of a white wall straight ahead, 1 m away, per watt of the laser.
double wall_radiance(const core::SensorModel& model) {
    core::SensorSetup setup;
    setup.model = model;
    setup.model.zones = {1, 1};
    setup.model.emitter_m = {0.0, 0.0};
    setup.subsamples = 1;
    setup.pose.position_m = core::Vec3::UnitZ();
    setup.wall.size_m = {100.0, 100.0};
    const double of_field = core::make_footprints(setup).zones[0].seen_irradiance[0] / core::kPi;
    const bool floods = model.illumination == core::SensorIllumination::Flood;
    return floods ? of_field : of_field * model.num_zones();
}

void add_glass(const core::SensorSetup& setup, const core::TimeAxis& axis, core::Transient& zones) {
    const double light = setup.model.detector.cover_glass_crosstalk * wall_radiance(setup.model);
    const auto bin = axis.bin_of(0.0);
    if (!bin || light == 0.0) return;
    for (std::size_t zone = 0; zone < zones.num_pairs(); ++zone) {
        zones.histogram(zone)[static_cast<std::size_t>(*bin)] += static_cast<float>(light);
    }
}

/// Calls change(frame, histograms, axis) for the capture's transient and its frames.
template <class Change>
void for_each_frame(core::Capture& capture, Change&& change) {
    const std::size_t last = capture.sequence ? capture.sequence->frames.size() - 1 : 0;
    change(last, capture.transient, capture.time_axis);
    if (!capture.sequence) return;
    for (std::size_t frame = 0; frame < capture.sequence->frames.size(); ++frame) {
        core::TimeAxis axis = capture.time_axis;
        axis.opl_start_m -= static_cast<double>(last - frame) * capture.sequence->gate_step_m;
        change(frame, capture.sequence->frames[frame], axis);
    }
}

void require_zones(const core::SensorSetup& setup, const core::Capture& capture) {
    const auto zones = static_cast<std::size_t>(setup.model.num_zones());
    core::require(capture.scan.num_pairs() == zones,
                  "sensor",
                  fmt::format("{} pairs for {} zones", capture.scan.num_pairs(), zones),
                  "a capture of one pair per zone");
}

}  // namespace

DetectorSettings detector_of(const core::SensorSetup& setup) {
    const core::SensorDetector& sensor = setup.model.detector;
    DetectorSettings settings;
    settings.exposure_s = sensor.frame_s;
    settings.response.jitter_fwhm_ps = sensor.response_fwhm_ps();
    settings.dark_counts_hz = sensor.dark_counts_hz;
    settings.pile_up = sensor.pile_up;
    settings.dead_time_ns = sensor.dead_time_ns;
    settings.repetition_hz = sensor.repetition_hz;
    settings.radiometry.laser_w = sensor.laser_w;
    settings.radiometry.wavelength_nm = sensor.wavelength_nm;
    settings.radiometry.etendue_m2_sr =
        1e-6 * sensor.aperture_mm2 * core::zone_etendue_sr(setup.model);
    settings.radiometry.efficiency = sensor.efficiency;
    return settings;
}

void add_crosstalk(const core::SensorSetup& setup, core::Capture& capture) {
    require_zones(setup, capture);
    const core::SensorDetector& sensor = setup.model.detector;
    core::require(
        sensor.cover_glass_crosstalk == 0.0 || capture.unit == core::TransientUnit::Radiance,
        "sensor",
        "a cover glass to add to counts",
        "a capture of radiance");
    for_each_frame(capture, [&](std::size_t, core::Transient& zones, const core::TimeAxis& axis) {
        mix(setup.model, zones);
        add_glass(setup, axis, zones);
    });
}

void cut_direct_return(const core::SensorSetup& setup, core::Capture& capture) {
    require_zones(setup, capture);
    const int after = setup.model.detector.cut_after_direct_bins;
    if (after == 0) return;
    std::vector<core::BinRange> ranges;
    for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
        ranges.push_back(capture.observed_range(pair));
    }
    for_each_frame(capture, [&](std::size_t frame, core::Transient&, const core::TimeAxis& axis) {
        const core::SensorFootprints footprints =
            core::make_footprints(setup, setup.poses.empty() ? 0 : frame);
        for (std::size_t zone = 0; zone < footprints.zones.size(); ++zone) {
            const core::PatchPoints& seen = footprints.zones[zone].seen;
            for (std::size_t i = 0; i < seen.size(); ++i) {
                const double opl =
                    (seen.positions[i] - footprints.laser_m).norm() + seen.device_m[i];
                const double bin = std::floor((opl - axis.opl_start_m) / axis.bin_width_m);
                const int cut = std::clamp(static_cast<int>(bin) + 1 + after, 0, axis.num_bins);
                ranges[zone].begin = std::max(ranges[zone].begin, cut);
                ranges[zone].end = std::max(ranges[zone].end, ranges[zone].begin);
            }
        }
    });
    core::restrict_observed(capture, ranges);
}

core::Capture detect_by_sensor(const core::SensorSetup& setup,
                               core::Capture capture,
                               const DetectorSettings& settings) {
    add_crosstalk(setup, capture);
    core::Capture counts = detect(capture, settings);
    cut_direct_return(setup, counts);
    counts.scene_info["detector"]["sensor"] = setup.model.name;
    return counts;
}

}  // namespace nlos
