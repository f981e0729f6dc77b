// SPDX-License-Identifier: MIT
#include "apps/bench/render/comparisons.h"

#include "apps/bench/error_metrics.h"
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

// Frames before this share of a sequence are left out of the means: reuse has to settle.
constexpr double kSettlingShare = 0.3;

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

// Sums of a pixel over settled frames, seeds and bins.
struct PixelErrors {
    std::vector<double> squared;
    std::vector<double> absolute;
    std::vector<double> reference;
    std::vector<double> reference_sum;

    explicit PixelErrors(std::size_t num_pixels)
        : squared(num_pixels),
          absolute(num_pixels),
          reference(num_pixels),
          reference_sum(num_pixels) {}

    void add(const core::Transient& x, const core::Transient& a, const core::Transient& b) {
        const std::size_t num_bins = x.num_bins();
        for (std::size_t i = 0; i < x.values().size(); ++i) {
            const double va = double{a.values()[i]};
            const double vb = double{b.values()[i]};
            const double vx = double{x.values()[i]};
            squared[i / num_bins] += (vx - va) * (vx - vb);
            absolute[i / num_bins] += std::abs(vx - 0.5 * (va + vb));
            reference[i / num_bins] += va * vb;
            reference_sum[i / num_bins] += 0.5 * (va + vb);
        }
    }

    double rel_mse(const std::vector<bool>& chosen, bool which) const {
        double error = 0.0;
        double norm = 0.0;
        for (std::size_t i = 0; i < squared.size(); ++i) {
            if (chosen[i] != which) continue;
            error += squared[i];
            norm += reference[i];
        }
        return norm > 0.0 ? error / norm : 0.0;
    }

    std::vector<float> map() const {
        double mean = 0.0;
        for (const double sum : reference_sum) mean += sum / static_cast<double>(absolute.size());
        std::vector<float> errors;
        for (const double sum : absolute) errors.push_back(static_cast<float>(sum / mean));
        return errors;
    }
};

MethodComparison compare_method(const Comparison& comparison,
                                const ComparedMethod& method,
                                int num_seeds,
                                const std::vector<bool>& planes) {
    const SequenceCase& sequence = comparison.sequence;
    const auto& [a, b] = comparison.references;
    MethodComparison result;
    result.method = method.name;
    result.effort = effort_for(sequence, method, comparison.seconds_per_frame);
    SequenceErrors errors(a.size());
    const auto first_settled = static_cast<std::size_t>(comparison.first_settled_frame);
    PixelErrors pixels(planes.size());
    renderer::ShiftCounts shifts;
    for (int seed = 0; seed < num_seeds; ++seed) {
        Run run =
            run_sequence(sequence, method, result.effort, 1000 + static_cast<std::uint64_t>(seed));
        result.seconds_per_frame += run.seconds_per_frame / num_seeds;
        shifts += run.shifts;
        errors.add(run.frames, a, b);
        for (std::size_t f = first_settled; f < a.size(); ++f) {
            pixels.add(run.frames[f], a[f], b[f]);
        }
        if (seed == 0) result.frames = std::move(run.frames);
    }
    const ErrorSums settled = errors.settled(first_settled);
    result.rel_mse_of_frames = errors.rel_mse_of_frames();
    result.rel_mse = settled.rel_mse();
    result.trimmed_rel_mse = settled.trimmed_rel_mse();
    result.planes_rel_mse = pixels.rel_mse(planes, true);
    result.meshes_rel_mse = pixels.rel_mse(planes, false);
    result.error_map = pixels.map();
    result.accepted_share = shifts.accepted_share();
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
    comparison.name = sequence.name;
    comparison.scene = sequence.scene;
    comparison.seconds_per_frame = seconds_per_frame;
    comparison.first_settled_frame = static_cast<int>(kSettlingShare * sequence.num_frames);
    comparison.sequence = sequence;
    comparison.camera = *setup.scan.camera;
    comparison.references = {reference_frames(sequence, 1), reference_frames(sequence, 2)};
    const std::vector<bool> planes = planes_met(setup, sequence);
    for (const ComparedMethod& method : methods) {
        if (progress.should_stop()) throw core::Failure("bench", "interrupted");
        comparison.methods.push_back(compare_method(comparison, method, num_seeds, planes));
        progress.update(
            static_cast<double>(comparison.methods.size()) / static_cast<double>(methods.size()),
            sequence.name + ", " + method.name);
    }
    return comparison;
}

}  // namespace apps
