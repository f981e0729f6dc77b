// SPDX-License-Identifier: MIT
#include "apps/bench/sequences.h"

#include "apps/bench/error.h"
#include "renderer/core/parallel.h"
#include "renderer/core/process.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace apps {
namespace {

// Frames before this share of a sequence are left out of the means: reuse has to settle.
constexpr double kSettlingShare = 1.0 / 6.0;

SequenceBench run_method(const SequenceCase& sequence,
                         const SequenceMethod& method,
                         int num_seeds,
                         const std::array<SequenceFrames, 2>& references) {
    SequenceSetup setup(sequence, method.overrides);
    SequenceBench bench;
    bench.sequence = sequence.name;
    bench.method = method.name;
    SequenceErrors errors(static_cast<std::size_t>(sequence.num_frames));
    renderer::ShiftCounts shifts;
    for (int seed = 0; seed < num_seeds; ++seed) {
        setup.description.render.seed = 1000 + static_cast<std::uint64_t>(seed);
        const double start = core::cpu_seconds();
        const renderer::RenderResult result = renderer::render_frames(
            setup.scene,
            setup.scan,
            setup.description,
            renderer::make_frame_renderer(setup.scan, setup.description.render),
            {});
        bench.seconds_per_frame += (core::cpu_seconds() - start) / num_seeds / sequence.num_frames;
        shifts += result.restir_counts.shifts;
        errors.add(result.capture.sequence->frames, references[0], references[1]);
    }
    const auto first_settled =
        static_cast<std::size_t>(std::ceil(kSettlingShare * sequence.num_frames));
    const ErrorSums settled = errors.settled(first_settled);
    bench.rel_mse_of_frames = errors.rel_mse_of_frames();
    bench.rel_mse = settled.rel_mse();
    bench.trimmed_rel_mse = settled.trimmed_rel_mse();
    bench.sum_ratio = settled.sum / settled.reference_sum;
    bench.accepted_share = shifts.accepted_share();
    return bench;
}

}  // namespace

SequenceSetup::SequenceSetup(const SequenceCase& sequence,
                             const std::vector<std::string>& overrides) {
    std::vector<std::string> all = sequence.overrides;
    all.insert(all.end(), overrides.begin(), overrides.end());
    description = renderer::read_scene_description(sequence.scene, all);
    description.time_axis = {
        sequence.gate_start_m, 1e-3 * sequence.gate_width_mm, sequence.num_bins};
    description.frames = {sequence.num_frames, 1e-3 * sequence.gate_step_mm, 0.0};
    description.render.variance = false;
    description.render.by_order = false;
    scan = renderer::make_scan(description);
    scene = std::make_shared<const renderer::Scene>(renderer::load_scene(description, scan));
}

SequenceFrames reference_frames(const SequenceCase& sequence, std::uint64_t seed) {
    SequenceSetup setup(sequence, {});
    renderer::RenderSettings settings = setup.description.render;
    settings.seed = seed;
    settings.samples = sequence.reference_samples;
    const bool integrable = !setup.scan.camera && settings.max_bounces == 3;
    settings.method = integrable ? renderer::Estimator::ThirdBounce : renderer::Estimator::Restir;
    if (integrable) settings.target_error = 5e-3;
    settings.restir.reuse = renderer::Reuse::None;
    settings.restir.shared_walks = 2000;
    settings.restir.walks = 16;
    if (sequence.num_bins > 1) {
        const core::TimeAxis& axis = setup.description.time_axis;
        return {static_cast<std::size_t>(sequence.num_frames),
                renderer::render(*setup.scene, setup.scan, axis, settings, {}).capture.transient};
    }
    const double step_mm =
        sequence.gate_step_mm > 0.0 ? sequence.gate_step_mm : sequence.gate_width_mm;
    const int bins_per_gate = static_cast<int>(std::lround(sequence.gate_width_mm / step_mm));
    const int bins_per_step = sequence.gate_step_mm > 0.0 ? 1 : 0;
    const core::TimeAxis axis{sequence.gate_start_m,
                              1e-3 * step_mm,
                              bins_per_gate + bins_per_step * (sequence.num_frames - 1)};
    const core::Transient histogram =
        renderer::render(*setup.scene, setup.scan, axis, settings, {}).capture.transient;
    SequenceFrames frames;
    for (int f = 0; f < sequence.num_frames; ++f) {
        core::Transient& frame = frames.emplace_back(histogram.num_pairs(), 1);
        for (std::size_t pair = 0; pair < histogram.num_pairs(); ++pair) {
            for (int bin = 0; bin < bins_per_gate; ++bin) {
                frame.histogram(pair)[0] +=
                    histogram.histogram(pair)[static_cast<std::size_t>(f * bins_per_step + bin)];
            }
        }
    }
    return frames;
}

std::vector<SequenceBench> bench_sequence(const SequenceCase& sequence,
                                          const std::vector<SequenceMethod>& methods,
                                          int num_seeds,
                                          const core::Progress& progress) {
    const core::ThreadLimit one_thread(1);
    const std::array<SequenceFrames, 2> references{reference_frames(sequence, 1),
                                                   reference_frames(sequence, 2)};
    std::vector<SequenceBench> benches;
    for (const SequenceMethod& method : methods) {
        if (progress.should_stop()) throw core::Failure("bench", "interrupted");
        SequenceBench& bench =
            benches.emplace_back(run_method(sequence, method, num_seeds, references));
        const SequenceBench& first = benches.front();
        bench.gain =
            first.rel_mse * first.seconds_per_frame / (bench.rel_mse * bench.seconds_per_frame);
        bench.trimmed_gain = first.trimmed_rel_mse * first.seconds_per_frame /
                             (bench.trimmed_rel_mse * bench.seconds_per_frame);
        progress.update(static_cast<double>(benches.size()) / static_cast<double>(methods.size()),
                        sequence.name + ", " + method.name);
    }
    return benches;
}

std::vector<SequenceCase> standard_sequences(const std::string& scan_scene,
                                             const std::string& image_scene,
                                             int num_frames) {
    std::vector<SequenceCase> sequences;
    const std::vector<std::array<double, 2>> gates{
        {20, 20}, {20, 5}, {10, 10}, {10, 2.5}, {5, 2.5}, {2, 2}, {20, 0}};
    for (const auto& [width, step] : gates) {
        const std::string gate = fmt::format("{}/{} mm", width, step);
        sequences.push_back({"scan, order 3, " + gate,
                             scan_scene,
                             {"render.max_bounces=3"},
                             1.4,
                             width,
                             step,
                             num_frames});
        sequences.push_back({"camera, 5 vertices, " + gate,
                             image_scene,
                             {"render.max_bounces=5"},
                             2.6,
                             width,
                             step,
                             num_frames});
    }
    return sequences;
}

std::vector<SequenceMethod> standard_methods(bool is_image, bool is_static) {
    // Good candidates leave little for reuse to add: a moving gate then wants a short memory.
    const auto cap = [&](int moving) {
        return fmt::format("render.restir.confidence_cap={}", is_static ? 50 : moving);
    };
    const auto near = [&](int moving) {
        return fmt::format("render.restir.neighbours={}", is_static ? 0 : moving);
    };
    const int memory = is_image ? 8 : 5;
    const std::string walks = is_image ? "render.restir.walks=2" : "render.restir.walks=8";
    const std::string shared = fmt::format("render.restir.shared_walks={}", is_image ? 512 : 1024);
    const std::string restir = "render.method=restir";
    const std::string ellipsoidal = "render.restir.candidates=ellipsoidal";
    return {
        {"path", {"render.method=path", is_image ? "render.samples=16" : "render.samples=512"}},
        {"ellipsoidal",
         {"render.method=ellipsoidal", is_image ? "render.samples=4" : "render.samples=32"}},
        {"naive, ellipsoidal",
         {restir, ellipsoidal, walks, cap(memory), near(3), "render.restir.reuse=naive"}},
        {"restir, walks", {restir, "render.restir.candidates=path", walks, cap(memory), near(3)}},
        {"restir, ellipsoidal", {restir, ellipsoidal, walks, cap(memory), near(3)}},
        {"shared alone", {restir, shared, "render.restir.reuse=none"}},
        {"restir, shared", {restir, shared, cap(is_image ? 5 : 2), near(is_image ? 3 : 0)}}};
}

}  // namespace apps
