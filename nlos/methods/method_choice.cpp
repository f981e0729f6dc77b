// SPDX-License-Identifier: MIT
#include "nlos/methods/methods.h"
#include "renderer/core/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace nlos {
namespace {

constexpr std::size_t kMinPhasorPoints = 4;

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

std::string why_too_few_bins(const PreparedCapture& prepared) {
    if (prepared.time_axis.num_bins >= kMinBins) return "";
    return fmt::format("a time axis of {} bins", prepared.time_axis.num_bins);
}

/// Empty when methods for confocal grids can serve, else what stands in their way.
std::string why_no_confocal_method(const PreparedCapture& prepared, const VolumeSettings& volume) {
    if (prepared.scan.pattern != core::ScanPattern::Confocal) {
        return name_of(prepared.scan.pattern);
    }
    const WallFrame& wall = prepared.wall;
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
    return why_too_few_bins(prepared);
}

/// Empty when the phasor field can serve.
std::string why_no_phasor(const PreparedCapture& prepared) {
    const std::size_t points = prepared.scan.sensing.size();
    if (points < kMinPhasorPoints) return fmt::format("{} sensing points", points);
    return why_too_few_bins(prepared);
}

/// The best method that serves without conversion.
Method best_method(const PreparedCapture& prepared, const VolumeSettings& volume) {
    if (why_no_confocal_method(prepared, volume).empty()) return Method::Lct;
    return why_no_phasor(prepared).empty() ? Method::Phasor : Method::Bp;
}

/// What a method that explains its data does better with than a direct inversion; empty: nothing.
std::string why_statistical(const ReconstructSettings& settings, const PreparedCapture& prepared) {
    if (prepared.unit == core::TransientUnit::Counts) return "photon counts";
    if (prepared.observed) return "bins that were not observed";
    return core::is_stated(settings.response) ? "a response" : "";
}

MethodChoice choose_automatically(const ReconstructSettings& settings,
                                  const PreparedCapture& prepared) {
    const Method method = best_method(prepared, settings.volume);
    if (method == Method::Lct) {
        const std::string noise = why_statistical(settings, prepared);
        if (!noise.empty())
            return {Method::Solver, "confocal scan on an even planar grid, " + noise};
        return {method, "confocal scan on an even planar grid"};
    }
    const std::string no_lct = why_no_confocal_method(prepared, settings.volume);
    if (method == Method::Phasor) return {method, no_lct};
    const std::string no_phasor = why_no_phasor(prepared);
    return {method, no_lct == no_phasor ? no_lct : no_lct + ", " + no_phasor};
}

}  // namespace

MethodChoice choose_method(const ReconstructSettings& settings, PreparedCapture& prepared) {
    if (settings.method == Method::Auto) return choose_automatically(settings, prepared);
    const std::string name(core::enum_name(settings.method));
    const std::string other(core::enum_name(best_method(prepared, settings.volume)));
    if (is_confocal_method(settings.method)) {
        if (prepared.scan.pattern != core::ScanPattern::Confocal) {
            convert_to_confocal(prepared);
        }
        const std::string obstacle = why_no_confocal_method(prepared, settings.volume);
        if (!obstacle.empty()) {
            throw core::Error(
                "method=" + name,
                "found " + obstacle,
                fmt::format("{} needs a scan on an even planar grid, confocal or convertible, "
                            "voxel columns at its points and at least {} bins; method={} works "
                            "for this capture",
                            name,
                            kMinBins,
                            other));
        }
    }
    if (settings.method == Method::Phasor && !why_no_phasor(prepared).empty()) {
        throw core::Error("method=phasor",
                          "found " + why_no_phasor(prepared),
                          fmt::format("phasor needs at least {} sensing points and {} bins; "
                                      "method={} works for this capture",
                                      kMinPhasorPoints,
                                      kMinBins,
                                      other));
    }
    return {settings.method,
            prepared.conversion.empty() ? "as set" : "as set; " + prepared.conversion};
}

std::optional<std::string> unobserved_warning(const ReconstructSettings& settings,
                                              const core::ObservedBins& observed,
                                              int num_bins) {
    const bool works_by_transforms =
        settings.method == Method::Phasor || is_confocal_method(settings.method);
    if (!observed || !works_by_transforms) return std::nullopt;
    const auto partial = std::ranges::count_if(
        *observed, [&](const core::BinRange& range) { return range.size() < num_bins; });
    return fmt::format(
        "{} of {} histograms have bins that were not observed, which {} takes for dark; solver, bp "
        "and fbp leave them out",
        partial,
        observed->size(),
        core::enum_name(settings.method));
}

std::optional<std::string> few_pairs_warning(const core::WallScan& scan) {
    constexpr std::size_t kFewPairs = 24;
    const std::size_t pairs = scan.num_pairs();
    if (pairs > kFewPairs) return std::nullopt;
    return fmt::format(
        "{} of wall points {} distances rather than directions: expect shells around the points "
        "instead of surfaces; nlos track follows a target, nlos fit places a known shape",
        pairs == 1 ? "one pair" : fmt::format("{} pairs", pairs),
        pairs == 1 ? "tells" : "tell");
}

}  // namespace nlos
