// SPDX-License-Identifier: MIT
#include "apps/bench/render/comparisons.h"

#include "apps/bench/output.h"
#include "apps/bench/statistics.h"
#include "renderer/core/parallel.h"
#include "renderer/core/process.h"
#include "renderer/restir/restir_renderer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace apps {
namespace {

// Facets above this area belong to large planes.
constexpr double kLargeFacet_m2 = 1e-2;
constexpr std::uint64_t kPlaneFrames = 24;

// Frames that are rendered to see how long they take, and the two efforts they are tried with.
constexpr int kProbeFrames = 6;
constexpr std::array<int, 2> kProbeEfforts{1, 8};

// Frames before this one are left out of the means: reuse has to settle.
std::size_t first_settled_frame(const SequenceCase& sequence) {
    return static_cast<std::size_t>(0.3 * sequence.num_frames);
}

// What a run of a sequence gave and took.
struct Run {
    SequenceFrames frames;
    double seconds_per_frame = 0.0;  // the first aside, which also looks at the scene
    renderer::ShiftCounts shifts;
};

Run run_sequence(const SequenceCase& sequence,
                 const ComparedMethod& method,
                 int effort,
                 std::uint64_t seed) {
    std::vector<std::string> overrides = method.overrides;
    overrides.push_back(fmt::format("{}={}", method.effort_key, effort));
    SequenceSetup setup(sequence, overrides);
    setup.description.render.seed = seed;
    const renderer::FrameRenderer render_frame =
        renderer::make_frame_renderer(setup.scan, setup.description.render);
    double cpu_seconds = 0.0;
    const renderer::FrameRenderer timed =
        [&](const renderer::Frame& frame, const core::Scan& scan, const core::Progress& progress) {
            const double start = core::cpu_seconds();
            renderer::RenderResult result = render_frame(frame, scan, progress);
            if (frame.index > 0) cpu_seconds += core::cpu_seconds() - start;
            return result;
        };
    const renderer::RenderResult result =
        renderer::render_frames(setup.scene, setup.scan, setup.description, timed, {});
    return {result.capture.sequence->frames,
            cpu_seconds / (sequence.num_frames - 1),
            result.restir_counts.shifts};
}

// The effort at which a frame takes its time, if time grows evenly with it.
int effort_for(const SequenceCase& sequence, const ComparedMethod& method, double seconds) {
    SequenceCase probe = sequence;
    probe.num_frames = kProbeFrames;
    std::array<double, 2> taken;
    for (std::size_t i = 0; i < 2; ++i) {
        taken[i] = run_sequence(probe, method, kProbeEfforts[i], 1).seconds_per_frame;
    }
    const double per_effort = (taken[1] - taken[0]) / (kProbeEfforts[1] - kProbeEfforts[0]);
    if (!(per_effort > 0.0)) return method.most_effort;
    const double effort = kProbeEfforts[0] + (seconds - taken[0]) / per_effort;
    return static_cast<int>(std::clamp(effort, 1.0, static_cast<double>(method.most_effort)));
}

// Per pixel, whether most of its light in the last frame's gate takes its first bounce behind what
// the pixel shows off a large plane: reservoirs tell.
std::vector<bool> planes_met(const SequenceSetup& setup, const SequenceCase& sequence) {
    renderer::RenderSettings settings = setup.description.render;
    settings.method = renderer::Estimator::Restir;
    settings.restir = {};
    settings.restir.reuse = renderer::Reuse::None;
    core::TimeAxis axis = setup.description.time_axis;
    axis.opl_start_m += 1e-3 * sequence.gate_step_mm * (sequence.num_frames - 1);
    renderer::RestirRenderer paths(setup.scan, settings);
    const auto scene = std::make_shared<renderer::RestirScene>(
        setup.scene, setup.scan, core::HistogramAxes{axis, {}}, settings);
    std::vector<double> excess(setup.scan.num_pairs());  // of light by way of large planes
    for (std::uint64_t number = 0; number < kPlaneFrames; ++number) {
        const renderer::RestirFrame frame = paths.render({scene, axis, nullptr, number});
        for (std::size_t i = 0; i < frame.reservoirs.size(); ++i) {
            const renderer::PathReservoir reservoir = frame.reservoirs.load(i);
            if (reservoir.empty()) continue;
            const renderer::Facet& facet = setup.scene->facet(reservoir.sample.first().facet);
            const double sign = facet.area_m2 > kLargeFacet_m2 ? 1.0 : -1.0;
            excess[i / frame.bins.count()] += sign * reservoir.estimate();
        }
    }
    std::vector<bool> planes;
    for (const double value : excess) planes.push_back(value > 0.0);
    return planes;
}

// Sums of pixels over settled frames, seeds and bins.
struct PixelErrors {
    std::vector<ErrorSums> sums;
    std::vector<double> absolute;

    explicit PixelErrors(std::size_t num_pixels) : sums(num_pixels), absolute(num_pixels) {}

    void add(const core::Transient& x, const core::Transient& a, const core::Transient& b) {
        const std::size_t num_bins = x.num_bins();
        for (std::size_t i = 0; i < x.values().size(); ++i) {
            const double va = double{a.values()[i]};
            const double vb = double{b.values()[i]};
            const double vx = double{x.values()[i]};
            ErrorSums& of_pixel = sums[i / num_bins];
            of_pixel.squared += (vx - va) * (vx - vb);
            of_pixel.reference += va * vb;
            of_pixel.reference_sum += 0.5 * (va + vb);
            absolute[i / num_bins] += std::abs(vx - 0.5 * (va + vb));
        }
    }

    double rel_mse(const std::vector<bool>& chosen, bool which) const {
        ErrorSums all;
        for (std::size_t i = 0; i < sums.size(); ++i) {
            if (chosen[i] == which) all += sums[i];
        }
        return all.reference > 0.0 ? all.rel_mse() : 0.0;
    }

    std::vector<float> map() const {
        double mean = 0.0;
        for (const ErrorSums& of_pixel : sums) {
            mean += of_pixel.reference_sum / static_cast<double>(sums.size());
        }
        std::vector<float> errors;
        for (const double sum : absolute) errors.push_back(static_cast<float>(sum / mean));
        return errors;
    }
};

MethodComparison compare_method(const Comparison& comparison,
                                const ComparedMethod& method,
                                double seconds,
                                int num_seeds,
                                const std::vector<bool>& planes) {
    const SequenceCase& sequence = comparison.sequence;
    const auto& [a, b] = comparison.references;
    const int effort = effort_for(sequence, method, seconds);
    MethodComparison result;
    double seconds_per_frame = 0.0;
    SequenceErrors errors(a.size());
    const std::size_t first_settled = first_settled_frame(sequence);
    PixelErrors pixels(planes.size());
    renderer::ShiftCounts shifts;
    for (int seed = 0; seed < num_seeds; ++seed) {
        Run run = run_sequence(sequence, method, effort, 1000 + static_cast<std::uint64_t>(seed));
        seconds_per_frame += run.seconds_per_frame / num_seeds;
        shifts += run.shifts;
        errors.add(run.frames, a, b);
        for (std::size_t f = first_settled; f < a.size(); ++f) {
            pixels.add(run.frames[f], a[f], b[f]);
        }
        if (seed == 0) result.frames = std::move(run.frames);
    }
    const ErrorSums settled = errors.settled(first_settled);
    result.error_map = pixels.map();
    result.figures = {
        {"method", method.name},  // estimator and how it reuses paths
        {"effort", effort},       // paths drawn per pair and frame, as its time allows
        {"seconds_per_frame", seconds_per_frame},        // CPU time, the first aside
        {"rel_mse", settled.rel_mse()},                  // mean over the settled frames
        {"trimmed_rel_mse", settled.trimmed_rel_mse()},  // without the worst 0.2 % of values
        // In pixels whose light bounces off large facets first, and off small ones.
        {"planes_rel_mse", pixels.rel_mse(planes, true)},
        {"meshes_rel_mse", pixels.rel_mse(planes, false)},
        {"accepted_share", shifts.accepted_share()},  // of shifts; 0: none was tried
        {"rel_mse_of_frames", errors.rel_mse_of_frames()}};
    return result;
}

}  // namespace

Comparison compare_methods(const SequenceCase& sequence,
                           const std::vector<ComparedMethod>& methods,
                           double seconds_per_frame,
                           int num_seeds,
                           const core::Progress& progress) {
    const core::ThreadLimit one_thread(1);
    const SequenceSetup setup(sequence, {});
    if (!setup.scan.camera) {
        throw core::Error(sequence.scene, "has no camera", "must be a scene with a camera");
    }
    Comparison comparison;
    comparison.sequence = sequence;
    comparison.camera = *setup.scan.camera;
    comparison.references = {reference_frames(sequence, 1), reference_frames(sequence, 2)};
    comparison.figures = {{"name", sequence.name},
                          {"scene", sequence.scene},
                          {"seconds_per_frame", seconds_per_frame},  // CPU time of each method
                          {"first_settled_frame", first_settled_frame(sequence)}};
    const std::vector<bool> planes = planes_met(setup, sequence);
    for (const ComparedMethod& method : methods) {
        progress.update(share_of(comparison.methods.size(), methods.size()),
                        sequence.name + ", " + method.name);
        comparison.methods.push_back(
            compare_method(comparison, method, seconds_per_frame, num_seeds, planes));
        comparison.figures["methods"].push_back(comparison.methods.back().figures);
    }
    return comparison;
}

}  // namespace apps
