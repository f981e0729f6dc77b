// SPDX-License-Identifier: MIT
#include "apps/bench/lower_bounds.h"
#include "apps/bench/reconstruct/reconstruct.h"
#include "apps/bench/reconstruct/reconstruct_trials.h"
#include "apps/bench/scene.h"
#include "apps/bench/statistics.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

namespace apps {
namespace {

// Below these, fixed costs say nothing about scaling.
constexpr double kShortest_s = 0.02;
constexpr double kSmallest_bytes = 1e7;

// Scaling of what lies above `smallest`; 0 for fewer than two points.
double exponent_of(const std::vector<ScalingPoint>& points,
                   double ScalingPoint::*value,
                   double smallest) {
    std::vector<double> sizes;
    std::vector<double> values;
    for (const ScalingPoint& point : points) {
        if (point.*value <= smallest) continue;
        sizes.push_back(point.values);
        values.push_back(point.*value);
    }
    return fit_power_law(sizes, values).exponent;
}

struct ScalingSize {
    int points = 0;
    int bins = 0;
};

constexpr double kAxis_m = 4.096;

core::Capture letter_capture(const std::string& scenes_folder, const ScalingSize& size) {
    const BenchScene scene(
        scenes_folder + "/letter/scene.json",
        {fmt::format("scan.sensing_points=[{0},{0}]", size.points),
         fmt::format("time_axis={{\"opl_start_m\":0,\"bin_width_m\":{},\"num_bins\":{}}}",
                     kAxis_m / size.bins,
                     size.bins)});
    return scene.render();
}

ScalingPoint measure_point(const core::Capture& capture,
                           const Overrides& overrides,
                           const std::string& size,
                           double values) {
    const ReconstructRun one = run_reconstruction(capture, overrides);
    return {size,
            values,
            one.cpu_seconds,
            reconstruction_limit_seconds(capture, one.result),
            one.bytes};
}

// Sizes of the capture, and with them of the volume.
std::vector<ReconstructScaling> grow_captures(const ReconstructBenchSettings& settings,
                                              const core::Progress& progress) {
    constexpr std::array kSizes{ScalingSize{32, 256},
                                ScalingSize{64, 512},
                                ScalingSize{128, 512},
                                ScalingSize{128, 1024},
                                ScalingSize{256, 1024}};
    std::vector<ReconstructScaling> curves(5);
    const std::array names{"lct", "dlct", "fk", "phasor, 64 slices", "bp, 64 slices"};
    const std::array methods{"lct", "dlct", "fk", "phasor", "bp"};
    for (std::size_t size = 0; size < kSizes.size(); ++size) {
        const auto [points, bins] = kSizes[size];
        if (points > settings.largest) break;
        const core::Capture capture = letter_capture(settings.scenes_folder, kSizes[size]);
        for (std::size_t i = 0; i < curves.size(); ++i) {
            progress.update(fraction_of(size, kSizes.size()), names[i]);
            Overrides overrides{std::string("method=") + methods[i], "merge_bins=1"};
            if (i >= 3) {
                overrides.push_back(kSlices);
                overrides.push_back(fmt::format("volume.voxels=[{0},{0},64]", points));
            }
            curves[i].method = names[i];
            curves[i].of = "values of the capture";
            curves[i].points.push_back(
                measure_point(capture,
                              overrides,
                              fmt::format("{0}x{0}x{1}", points, bins),
                              static_cast<double>(capture.transient.values().size())));
        }
    }
    return curves;
}

// Slices of the volume; the methods not named make as many as the capture asks for.
std::vector<ReconstructScaling> grow_volumes(const ReconstructBenchSettings& settings,
                                             const core::Progress& progress) {
    constexpr int kPoints = 64;
    const core::Capture capture = letter_capture(settings.scenes_folder, {kPoints, 512});
    std::vector<ReconstructScaling> curves;
    for (const std::string method : {"phasor", "bp"}) {
        ReconstructScaling& curve = curves.emplace_back();
        curve.method = method;
        curve.of = "voxels";
        for (const int slices : {16, 32, 64, 128, 256}) {
            progress.update(fraction_of(curves.size() - 1, 2), method);
            curve.points.push_back(
                measure_point(capture,
                              {"method=" + method,
                               "merge_bins=1",
                               kSlices,
                               fmt::format("volume.voxels=[{0},{0},{1}]", kPoints, slices)},
                              fmt::format("{0}x{0}x{1}", kPoints, slices),
                              double{kPoints} * kPoints * slices));
        }
    }
    return curves;
}

}  // namespace

std::vector<ReconstructScaling> measure_scaling(const ReconstructBenchSettings& settings,
                                                const core::Progress& progress) {
    std::vector<ReconstructScaling> curves = grow_captures(settings, progress.part(0.0, 0.95));
    for (ReconstructScaling& curve : grow_volumes(settings, progress.part(0.95, 1.0))) {
        curves.push_back(std::move(curve));
    }
    for (ReconstructScaling& curve : curves) {
        curve.time_exponent = exponent_of(curve.points, &ScalingPoint::cpu_seconds, kShortest_s);
        curve.memory_exponent = exponent_of(curve.points, &ScalingPoint::bytes, kSmallest_bytes);
    }
    return curves;
}

}  // namespace apps
