// SPDX-License-Identifier: MIT
#include "nlos/methods/method_choice.h"

#include "renderer/core/error.h"

#include <fmt/format.h>

namespace nlos {
namespace {

constexpr std::size_t kFewestPhasorPoints = 4;

bool is_confocal_method(Method method) {
    return method == Method::Lct || method == Method::Fk || method == Method::Dlct;
}

std::string name_of(core::ScanPattern pattern) {
    switch (pattern) {
        case core::ScanPattern::Single:
            return "a single-laser scan";
        case core::ScanPattern::Exhaustive:
            return "an exhaustive scan";
        case core::ScanPattern::Confocal:
            break;
    }
    return "a confocal scan";
}

std::string why_too_few_bins(const Measurement& measurement) {
    if (measurement.time_axis.num_bins >= kFewestBins) return "";
    return fmt::format("a time axis of {} bins", measurement.time_axis.num_bins);
}

/// Empty when methods for confocal grids can serve, else what stands in their way.
std::string why_no_confocal_method(const Measurement& measurement, const VolumeSettings& volume) {
    if (measurement.scan.pattern != core::ScanPattern::Confocal) {
        return name_of(measurement.scan.pattern);
    }
    const WallFrame& wall = measurement.wall;
    if (!wall.grid) return wall.why_no_grid;
    const auto [nx, ny] = wall.grid->size;
    if (volume.voxels && (static_cast<std::size_t>((*volume.voxels)[0]) != nx ||
                          static_cast<std::size_t>((*volume.voxels)[1]) != ny)) {
        return fmt::format("volume.voxels of {} x {} for a scan of {} x {}",
                           (*volume.voxels)[0],
                           (*volume.voxels)[1],
                           nx,
                           ny);
    }
    return why_too_few_bins(measurement);
}

/// Empty when the phasor field can serve.
std::string why_no_phasor(const Measurement& measurement) {
    const std::size_t points = measurement.scan.sensing.size();
    if (points < kFewestPhasorPoints) return fmt::format("{} sensing points", points);
    return why_too_few_bins(measurement);
}

/// The best method that serves without conversion.
Method best_method(const Measurement& measurement, const VolumeSettings& volume) {
    if (why_no_confocal_method(measurement, volume).empty()) return Method::Lct;
    return why_no_phasor(measurement).empty() ? Method::Phasor : Method::Bp;
}

MethodChoice choose_automatically(const ReconstructSettings& settings,
                                  const Measurement& measurement) {
    const Method method = best_method(measurement, settings.volume);
    if (method == Method::Lct) return {method, "confocal scan on an even planar grid"};
    const std::string no_lct = why_no_confocal_method(measurement, settings.volume);
    if (method == Method::Phasor) return {method, no_lct};
    const std::string no_phasor = why_no_phasor(measurement);
    return {method, no_lct == no_phasor ? no_lct : no_lct + ", " + no_phasor};
}

}  // namespace

MethodChoice choose_method(const ReconstructSettings& settings, Measurement& measurement) {
    if (settings.method == Method::Auto) return choose_automatically(settings, measurement);
    const std::string name(core::enum_name(settings.method));
    const std::string other(core::enum_name(best_method(measurement, settings.volume)));
    if (is_confocal_method(settings.method)) {
        if (measurement.scan.pattern != core::ScanPattern::Confocal) {
            convert_to_confocal(measurement);
        }
        const std::string obstacle = why_no_confocal_method(measurement, settings.volume);
        if (!obstacle.empty()) {
            throw core::Error(
                "method=" + name,
                "found " + obstacle,
                fmt::format("{} needs a scan on an even planar grid, confocal or convertible, "
                            "voxel columns at its points and at least {} bins; method={} works "
                            "for this capture",
                            name,
                            kFewestBins,
                            other));
        }
    }
    if (settings.method == Method::Phasor && !why_no_phasor(measurement).empty()) {
        throw core::Error("method=phasor",
                          "found " + why_no_phasor(measurement),
                          fmt::format("phasor needs at least {} sensing points and {} bins; "
                                      "method={} works for this capture",
                                      kFewestPhasorPoints,
                                      kFewestBins,
                                      other));
    }
    return {settings.method,
            measurement.conversion.empty() ? "as set" : "as set; " + measurement.conversion};
}

}  // namespace nlos
