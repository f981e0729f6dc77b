// SPDX-License-Identifier: MIT
#include "renderer/restir_render.h"

#include "renderer/core/parallel.h"
#include "renderer/core/process.h"
#include "renderer/restir_renderer.h"
#include "renderer/short_paths.h"
#include "renderer/transient_accumulator.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>

namespace renderer {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kPairsPerBlock = 64;

// Estimates of one frame of a sequence, at most: each has random numbers of its own.
constexpr std::uint64_t kMostRepeats = 1 << 16;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

int candidates_per_frame(const RestirSettings& settings) {
    return settings.walks + (settings.candidates == Candidates::Shared ? settings.shared_walks : 0);
}

// Settings whose frames take no more candidates than are asked for in all.
RenderSettings with_fitting_frames(RenderSettings settings) {
    RestirSettings& restir = settings.restir;
    if (settings.seconds || candidates_per_frame(restir) <= settings.samples) return settings;
    restir.walks = std::min(restir.walks, settings.samples);
    restir.shared_walks = settings.samples - restir.walks;
    return settings;
}

void require_gate_to_shrink_to(const core::TimeAxis& axis, const RenderSettings& settings) {
    if (settings.restir.shrink_fraction == 0.0 || axis.num_bins == 1) return;
    throw core::Error(
        "render.restir.shrink_fraction",
        fmt::format("found {} for {} bins", settings.restir.shrink_fraction, axis.num_bins),
        "must be 0 unless the time axis has one bin, a gate");
}

void require_memory(double needed) {
    const auto available = static_cast<double>(core::available_memory_bytes());
    if (needed <= available) return;
    throw core::Failure(
        "restir",
        fmt::format(
            "reservoirs need {:.1f} GB, {:.1f} GB are free", needed * 1e-9, available * 1e-9));
}

// Whether the end of a bin may cross a pixel, judged by the middles of the pixels around it.
bool bin_may_end_in(const RestirFrame& frame, std::size_t pixel, const core::Scan& scan) {
    const std::vector<double>& opl_m = frame.scene->pixel_direct_opl_m;
    const std::size_t height = scan.camera->height();
    double low = opl_m[pixel];
    double high = opl_m[pixel];
    for (const std::size_t other : {pixel - 1, pixel + 1, pixel - height, pixel + height}) {
        if (other >= opl_m.size()) continue;  // also below 0
        low = std::min(low, opl_m[other]);
        high = std::max(high, opl_m[other]);
    }
    if (low > frame.axis.opl_end_m() || high < frame.axis.opl_start_m) return false;
    const auto first = frame.axis.bin_of(low);
    return !first || first != frame.axis.bin_of(high);
}

// What goes straight from the surface that a pixel sees to the light. A gate's edge that crosses a
// pixel would be noise if one place of it stood for all.
void add_direct_light_of_pixel(const RestirFrame& frame,
                               std::size_t pixel,
                               const core::Scan& scan,
                               const RenderSettings& settings,
                               PassHistogram& histogram) {
    const int places_per_side = bin_may_end_in(frame, pixel, scan) ? 4 : 1;
    const double weight = 1.0 / (places_per_side * places_per_side);
    const PathDomain& domain = frame.domains[pixel];
    const Measurement& measurement = frame.scene->measurement;
    for (int i = 0; i < places_per_side; ++i) {
        for (int j = 0; j < places_per_side; ++j) {
            // One jitter for all: the places are a grid shifted at random.
            const core::Vec2 place = (core::Vec2(i, j) + domain.pixel_u) / places_per_side;
            auto seen = measurement.first_vertex(pixel, place);
            if (!seen) continue;
            seen->throughput = weight;
            add_direct_light(*seen, domain.ends, frame.scene->walk, settings, histogram);
        }
    }
}

void add_paths_without_vertices(const RestirFrame& frame,
                                std::size_t pair,
                                const core::Scan& scan,
                                const RenderSettings& settings,
                                PassHistogram& histogram) {
    if (frame.scene->measurement.is_image()) {
        add_direct_light_of_pixel(frame, pair, scan, settings, histogram);
    } else {
        add_short_paths(*frame.scene->scene, frame.domains[pair].ends, settings, histogram);
    }
}

// Adds what a frame's reservoirs estimate, and paths too short to be sampled, to the sums.
void add_frame(const RestirFrame& frame,
               const core::Scan& scan,
               const RenderSettings& settings,
               TransientAccumulator& sums) {
    const auto num_bins = static_cast<std::size_t>(frame.axis.num_bins);
    std::atomic<bool> is_finite{true};
    core::parallel_blocks(
        frame.domains.size(), kPairsPerBlock, [&](std::size_t begin, std::size_t end) {
            PassHistogram gated(frame.axis, settings.gate, 1);
            PassHistogram histogram(frame.axis, GateShape::Box, 1);
            for (std::size_t pair = begin; pair < end; ++pair) {
                add_paths_without_vertices(frame, pair, scan, settings, gated);
                gated.drain([](std::size_t, double) {},
                            [&](std::size_t bin, double value) {
                                histogram.add(
                                    0, frame.axis.bin_center_m(static_cast<double>(bin)), value);
                            });
                for (std::size_t bin = 0; bin < num_bins; ++bin) {
                    const double value = frame.reservoirs.load(pair * num_bins + bin).estimate();
                    if (value != 0.0) {
                        histogram.add(0, frame.axis.bin_center_m(static_cast<double>(bin)), value);
                    }
                }
                if (histogram.num_non_finite() > 0) is_finite = false;
                sums.add_pass(pair, histogram);
            }
        });
    if (!is_finite) {
        throw core::Failure("restir",
                            fmt::format("an estimate is not finite (seed {})", settings.seed));
    }
}

RenderResult result_of(const TransientAccumulator& sums,
                       int num_frames,
                       const core::Scan& scan,
                       const core::TimeAxis& axis,
                       const RenderSettings& settings) {
    RenderResult result;
    result.capture.scan = scan;
    result.capture.time_axis = axis;
    result.capture.transient = sums.mean_of_all(num_frames);
    if (settings.variance && num_frames > 1) result.capture.variance = sums.variance(num_frames);
    const int first_order = !scan.camera ? 3 : scan.camera->light_spot_m ? 2 : 1;
    result.sources.push_back({first_order, settings.max_bounces, Estimator::Restir, "all"});
    result.samples_per_pair = static_cast<std::uint64_t>(num_frames) *
                              static_cast<std::uint64_t>(candidates_per_frame(settings.restir));
    return result;
}

TransientAccumulator empty_sums(const core::Scan& scan,
                                const core::TimeAxis& axis,
                                const RenderSettings& settings) {
    return {scan.num_pairs(), axis.num_bins, 1, settings.variance};
}

}  // namespace

RenderResult render_restir(std::shared_ptr<const Scene> scene,
                           const core::Scan& scan,
                           const core::TimeAxis& axis,
                           const RenderSettings& asked,
                           const core::Progress& progress) {
    const auto start = Clock::now();
    require_gate_to_shrink_to(axis, asked);
    const RenderSettings settings = with_fitting_frames(asked);
    RestirRenderer renderer(scan, settings);
    require_memory(renderer.bytes_needed(axis));
    const auto restir_scene = std::make_shared<RestirScene>(std::move(scene), scan, settings);
    const int per_frame = candidates_per_frame(settings.restir);
    const int num_frames = settings.seconds ? std::numeric_limits<int>::max()
                                            : (settings.samples + per_frame - 1) / per_frame;
    TransientAccumulator sums = empty_sums(scan, axis, settings);
    int done = 0;
    bool interrupted = false;
    while (done < num_frames) {
        const auto number = static_cast<std::uint64_t>(done);
        add_frame(renderer.render({restir_scene, axis, nullptr, number}), scan, settings, sums);
        ++done;
        const double elapsed = seconds_since(start);
        const double share =
            settings.seconds ? elapsed / *settings.seconds : static_cast<double>(done) / num_frames;
        progress.update(std::min(1.0, share), fmt::format("{} frames", done));
        if (settings.seconds && elapsed >= *settings.seconds) break;
        if (done < num_frames && progress.should_stop()) {
            interrupted = true;
            break;
        }
    }
    RenderResult result = result_of(sums, done, scan, axis, settings);
    result.interrupted = interrupted;
    result.num_rays = renderer.counts().num_rays;
    result.restir_counts = renderer.counts();
    result.seconds = seconds_since(start);
    return result;
}

FrameRenderer make_restir_frame_renderer(const core::Scan& scan, const RenderSettings& settings) {
    struct State {
        State(const core::Scan& scan_of_frames, const RenderSettings& settings_of_frames)
            : settings(settings_of_frames), renderer(scan_of_frames, settings_of_frames) {}
        RenderSettings settings;
        RestirRenderer renderer;
        RestirFrame last;
    };
    const auto state = std::make_shared<State>(scan, settings);
    return [state](const Frame& frame, const core::Scan& frame_scan, const core::Progress&) {
        const auto start = Clock::now();
        require_gate_to_shrink_to(frame.axis, state->settings);
        if (frame.index == 0) require_memory(state->renderer.bytes_needed(frame.axis));
        const bool is_first = state->last.scene == nullptr;
        const auto scene =
            !is_first && state->last.scene->scene == frame.scene
                ? state->last.scene
                : std::make_shared<RestirScene>(frame.scene, frame_scan, state->settings);
        const std::uint64_t rays_before = state->renderer.counts().num_rays;
        TransientAccumulator sums = empty_sums(frame_scan, frame.axis, state->settings);
        // Time that is left goes into more estimates from the same past; the last one is kept.
        RestirFrame rendered;
        int repeats = 0;
        do {
            const std::uint64_t number = static_cast<std::uint64_t>(frame.index) * kMostRepeats +
                                         static_cast<std::uint64_t>(repeats);
            rendered = state->renderer.render(
                {scene, frame.axis, is_first ? nullptr : &state->last, number});
            add_frame(rendered, frame_scan, state->settings, sums);
            ++repeats;
        } while (state->settings.seconds && seconds_since(start) < *state->settings.seconds &&
                 repeats < static_cast<int>(kMostRepeats));
        state->last = std::move(rendered);
        RenderResult result = result_of(sums, repeats, frame_scan, frame.axis, state->settings);
        result.num_rays = state->renderer.counts().num_rays - rays_before;
        result.restir_counts = state->renderer.counts();
        result.seconds = seconds_since(start);
        return result;
    };
}

}  // namespace renderer
