// SPDX-License-Identifier: MIT
#include "nlos/methods/methods.h"
#include "nlos/preparation/place_resolution.h"
#include "renderer/core/error.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

namespace nlos {
namespace {

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

std::string why_no_confocal_grid(const PreparedCapture& prepared, const VolumeSettings& volume) {
    if (!prepared.scan.is_confocal()) {
        return name_of(prepared.scan.pattern);
    }
    const WallFrame& wall = prepared.wall;
    if (!wall.grid) return wall.why_no_grid;
    const auto [nx, ny] = wall.grid->size;
    if (!volume.voxels || (static_cast<std::size_t>((*volume.voxels)[0]) == nx &&
                           static_cast<std::size_t>((*volume.voxels)[1]) == ny)) {
        return "";
    }
    return fmt::format("volume.voxels of {} x {} for a scan of {} x {}",
                       (*volume.voxels)[0],
                       (*volume.voxels)[1],
                       nx,
                       ny);
}

/// What stands in a method's way; empty: nothing.
std::string obstacle_to(const MethodTraits& method,
                        const PreparedCapture& prepared,
                        const VolumeSettings& volume) {
    if (!method.needs) return "";
    std::string obstacle = method.needs->obstacle(prepared, volume);
    if (!obstacle.empty() || prepared.time_axis.num_bins >= kMinBins) return obstacle;
    return fmt::format("a time axis of {} bins", prepared.time_axis.num_bins);
}

/// The first of kPreferredMethods that serves without conversion, and what stands in the way of
/// those before it.
MethodChoice preferred_method(const PreparedCapture& prepared, const VolumeSettings& volume) {
    MethodChoice choice{};
    std::string last;
    for (const MethodTraits* method : kPreferredMethods) {
        choice.method = method->method;
        const std::string obstacle = obstacle_to(*method, prepared, volume);
        if (obstacle.empty()) break;
        if (obstacle != last) choice.reason += (last.empty() ? "" : ", ") + obstacle;
        last = obstacle;
    }
    return choice;
}

/// What a method that explains its data does better with than a direct inversion; empty: nothing.
std::string why_statistical(const ReconstructSettings& settings, const PreparedCapture& prepared) {
    if (prepared.unit == core::TransientUnit::Counts) return "photon counts";
    if (prepared.observed) return "bins that were not observed";
    return core::is_given(settings.response) ? "a response" : "";
}

MethodChoice choose_automatically(const ReconstructSettings& settings,
                                  const PreparedCapture& prepared) {
    if (auto why = why_no_directions(prepared)) {
        return {kPreferredMethods.back()->method, std::move(*why)};
    }
    MethodChoice choice = preferred_method(prepared, settings.volume);
    if (!choice.reason.empty()) return choice;
    choice.reason = traits_of(choice.method).needs->met;
    const std::string unexplained = why_statistical(settings, prepared);
    if (unexplained.empty()) return choice;
    return {kStatisticalMethod.method, choice.reason + ", " + unexplained};
}

/// The methods of which something holds, as in "method=bp, fbp, solver".
std::string methods_that(bool MethodTraits::*holds) {
    std::vector<std::string_view> names;
    for (const MethodTraits* method : kMethods) {
        if (method->*holds) names.push_back(core::enum_name(method->method));
    }
    return fmt::format("method={}", fmt::join(names, ", "));
}

/// Checks that the method set can serve, once the capture is what it needs.
MethodChoice check_method(const ReconstructSettings& settings, PreparedCapture& prepared) {
    const MethodTraits& method = traits_of(settings.method);
    const Method other = preferred_method(prepared, settings.volume).method;
    if (method.needs && method.needs->takes_other_patterns && !prepared.scan.is_confocal()) {
        convert_to_confocal(prepared);
    }
    const std::string obstacle = obstacle_to(method, prepared, settings.volume);
    if (!obstacle.empty()) {
        throw core::Error(fmt::format("method={}", core::enum_name(settings.method)),
                          "found " + obstacle,
                          fmt::format("{} needs {} and at least {} bins; method={} works for this "
                                      "capture",
                                      core::enum_name(settings.method),
                                      method.needs->text,
                                      kMinBins,
                                      core::enum_name(other)));
    }
    return {settings.method,
            prepared.conversion.empty() ? "as set" : "as set; " + prepared.conversion};
}

}  // namespace

const MethodNeeds kConfocalGrid{
    .text = "a scan on an even planar grid, confocal or convertible, voxel columns at its points",
    .met = "confocal scan on an even planar grid",
    .takes_other_patterns = true,
    .obstacle = why_no_confocal_grid};

MethodChoice choose_method(const ReconstructSettings& settings, PreparedCapture& prepared) {
    MethodChoice choice = settings.method == Method::Auto ? choose_automatically(settings, prepared)
                                                          : check_method(settings, prepared);
    core::require(settings.falloff != Falloff::Facing || traits_of(choice.method).knows_facing,
                  "falloff",
                  fmt::format("facing with method {}", core::enum_name(choice.method)),
                  fmt::format("diffuse or retro; {} knows facing",
                              methods_that(&MethodTraits::knows_facing)));
    return choice;
}

Method direct_method(const PreparedCapture& prepared, const VolumeSettings& volume) {
    return preferred_method(prepared, volume).method;
}

std::optional<std::string> unobserved_warning(const ReconstructSettings& settings,
                                              const core::ObservedBins& observed,
                                              int num_bins) {
    if (!observed || traits_of(settings.method).explains_gaps) return std::nullopt;
    const auto partial = std::ranges::count_if(
        *observed, [&](const core::BinRange& range) { return range.size() < num_bins; });
    return fmt::format(
        "{} of {} histograms have bins that were not observed, which {} takes for dark; {} leave "
        "them out",
        partial,
        observed->size(),
        core::enum_name(settings.method),
        methods_that(&MethodTraits::explains_gaps));
}

std::optional<std::string> directions_warning(const PreparedCapture& prepared) {
    constexpr std::size_t kFewPairs = 24;
    constexpr std::string_view kOtherWays =
        "nlos track follows a target, nlos fit places a known shape";
    const std::size_t pairs = prepared.scan.num_pairs();
    if (const auto why = why_no_directions(prepared)) {
        return fmt::format(
            "{} {} distances rather than directions: {}, and no surface is given there; "
            "capture.wall_size_m corrects the points' extents; {}",
            pairs == 1 ? "one pair of wall points" : fmt::format("{} pairs of wall points", pairs),
            pairs == 1 ? "tells" : "tell",
            *why,
            kOtherWays);
    }
    if (pairs > kFewPairs) return std::nullopt;
    return fmt::format(
        "{} pairs of wall points tell distances rather than directions: expect shells around the "
        "points instead of surfaces; {}",
        pairs,
        kOtherWays);
}

}  // namespace nlos
