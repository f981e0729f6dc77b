// SPDX-License-Identifier: MIT
#include "renderer/restir_render.h"

#include "renderer/core/sampling.h"
#include "renderer/core/stopwatch.h"
#include "renderer/core/system/parallel.h"
#include "renderer/ellipsoidal_render.h"
#include "renderer/light_range.h"
#include "renderer/restir/restir_renderer.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <limits>

namespace renderer {
namespace {

constexpr std::size_t kDomainsPerBlock = 64;

// Chains of frames of a sequence: each reuses its own past alone, so that their spread tells the
// error of their mean, past included. Every frame of a chain has random numbers of its own.
constexpr std::size_t kMinChains = 2;
constexpr std::size_t kMaxChains = 256;

int candidates_per_frame(const RestirSettings& settings) {
    return settings.walks + (has_shared_walks(settings.candidates) ? settings.shared_walks : 0) +
           (has_connections(settings.candidates) ? settings.connections : 0);
}

// Settings whose frames take no more candidates than are asked for in all: by at least two frames,
// whose difference tells the error, unless there is but one candidate. On scans of a narrow axis,
// where few walks are of the wanted length, third bounces alone are connections: they serve no
// other orders. Pixels have none but those of walks.
RenderSettings with_fitting_frames(RenderSettings settings,
                                   const Scene& scene,
                                   const core::Scan& scan,
                                   const core::HistogramAxes& axes) {
    RestirSettings& restir = settings.restir;
    if (!restir.candidates) {
        const bool connects = scan.has_wall() && settings.max_bounces == first_order(scan) &&
                              is_narrow(scene, scan, axes, settings);
        restir.candidates = connects ? Candidates::Ellipsoidal : Candidates::Shared;
    }
    if (!scan.has_wall()) restir.connections = 0;
    const int most = std::max(1, settings.samples / 2);
    const bool is_open_ended = settings.seconds || settings.target_error;
    if (is_open_ended || candidates_per_frame(restir) <= most) return settings;
    restir.walks = std::min(restir.walks, most);
    const double left = static_cast<double>(most - restir.walks) /
                        std::max(1, candidates_per_frame(restir) - restir.walks);
    restir.shared_walks = static_cast<int>(left * restir.shared_walks);
    restir.connections = static_cast<int>(left * restir.connections);
    return settings;
}

std::size_t num_chains_of(const RenderSettings& settings) {
    const int per_frame = candidates_per_frame(settings.restir);
    const auto wanted = static_cast<std::size_t>((settings.samples + per_frame - 1) / per_frame);
    return std::clamp(wanted, kMinChains, kMaxChains);
}

void require_gate_to_shrink_to(const core::HistogramAxes& axes, const RenderSettings& settings) {
    if (settings.restir.shrink_fraction == 0.0) return;
    if (axes.time.num_bins == 1 && !axes.velocity) return;
    throw core::Error("render.restir.shrink_fraction",
                      fmt::format("found {} for {} bins{}",
                                  settings.restir.shrink_fraction,
                                  axes.time.num_bins,
                                  axes.velocity ? " and a velocity axis" : ""),
                      "must be 0 unless the time axis has one bin, a gate, and there is no "
                      "velocity axis");
}

// Whether a bin may end within a pixel; bins of velocity may do so anywhere.
bool bin_may_end_in(const OplBand& lengths, const core::HistogramAxes& axes) {
    if (lengths.low_m > axes.time.opl_end_m() || lengths.high_m < axes.time.opl_start_m) {
        return false;
    }
    if (axes.velocity) return true;
    const auto first = axes.time.bin_of(lengths.low_m);
    return !first || first != axes.time.bin_of(lengths.high_m);
}

// Adds the light that the surface seen by a pixel receives directly. A single position within the
// pixel does where all of it falls into one bin; elsewhere that would be noisy, and the points of a
// randomly shifted lattice are taken.
void add_direct_light_of_pixel(const RestirFrame& frame,
                               std::size_t pixel,
                               const RenderSettings& settings,
                               PassHistogram& histogram) {
    constexpr int kPositions = 32;
    const PixelPositionSampler& sampler = *frame.scene->pixel_positions;
    const TimeGate lengths = frame.bins.lengths();
    const PixelPositionSampler::Band band =
        sampler.band(pixel, {lengths.begin_m(), lengths.end_m()});
    const int count = bin_may_end_in(sampler.around(pixel), frame.bins.axes()) ? kPositions : 1;
    const PathDomain& domain = frame.domains[pixel];
    const RandomWalk& walk = frame.scene->walk;
    for (int i = 0; i < count; ++i) {
        const core::Vec2 position = band.sample(core::lattice_point(i, count, domain.pixel_u));
        auto seen = frame.scene->sensor_pairs.first_vertex(pixel, position);
        if (!seen) continue;
        seen->throughput = 1.0 / (count * band.pdf(position));
        const OpticalPath path = walk.optical_path_to_light(*seen, domain.ends);
        if (seen->order > settings.max_bounces || !histogram.gate().admits(path.opl_m)) continue;
        const double value = walk.connection_value(*seen, domain.ends);
        if (!(value > 0.0) || walk.light_is_hidden(*seen, domain.ends)) continue;
        histogram.add(0, path, value);
    }
}

void add_paths_without_vertices(const RestirFrame& frame,
                                std::size_t pair,
                                const RenderSettings& settings,
                                PassHistogram& histogram) {
    if (frame.scene->sensor_pairs.is_image()) {
        add_direct_light_of_pixel(frame, pair, settings, histogram);
    } else {
        add_short_paths(*frame.scene->scene, frame.domains[pair].ends, settings, histogram);
    }
}

// The time bin of the path of a reservoir.
std::optional<int> time_bin_of(const RestirFrame& frame,
                               std::size_t pair,
                               std::size_t bin,
                               const ReusablePath& path) {
    if (const auto known = frame.bins.time_bin(bin)) return known;
    const RestirScene& scene = *frame.scene;
    const PathDomain domain = scene.sensor_pairs.is_image()
                                  ? pixel_domain(scene.sensor_pairs, pair, path.pixel_u)
                                  : frame.domains[pair];
    return frame.bins.axes().time.bin_of(
        scene.candidates.integrand().evaluate(domain, path).optical_path.opl_m);
}

// Adds what the reservoirs of a pair estimate.
void add_reservoirs(const RestirFrame& frame, std::size_t pair, PassHistogram& histogram) {
    for (std::size_t bin = 0; bin < frame.bins.count(); ++bin) {
        const PathReservoir reservoir = frame.reservoirs.load(pair * frame.bins.count() + bin);
        const double value = reservoir.estimate();
        if (value == 0.0) continue;
        const auto time_bin = time_bin_of(frame, pair, bin, reservoir.sample);
        // Beyond every axis, where none is known.
        double velocity = std::numeric_limits<double>::infinity();
        if (const auto velocity_bin = frame.bins.velocity_bin(bin)) {
            velocity = frame.bins.axes().velocity->bin_center_m_per_s(*velocity_bin);
        }
        if (time_bin) histogram.add_to_bin(0, *time_bin, velocity, value);
    }
}

// Adds what a frame's reservoirs estimate, and paths too short to be sampled, to the sums.
void add_frame(const RestirFrame& frame, const RenderSettings& settings, HistogramSums& sums) {
    std::atomic<bool> is_finite{true};
    core::parallel_blocks(
        frame.domains.size(), kDomainsPerBlock, [&](std::size_t begin, std::size_t end) {
            PassHistogram histogram(frame.bins.axes(), settings.gate, 1);
            for (std::size_t pair = begin; pair < end; ++pair) {
                add_paths_without_vertices(frame, pair, settings, histogram);
                add_reservoirs(frame, pair, histogram);
                if (histogram.num_non_finite() > 0) is_finite = false;
                sums.add_pass(pair, histogram);
            }
        });
    if (!is_finite) {
        throw core::Failure("restir",
                            fmt::format("an estimate is not finite (seed {})", settings.seed));
    }
}

RenderResult result_of(const HistogramSums& sums,
                       int num_frames,
                       const core::Scan& scan,
                       const core::HistogramAxes& axes,
                       const RestirScene& scene,
                       const RenderSettings& settings,
                       const RestirCounts& counts) {
    RenderResult result;
    result.capture = empty_capture(scan, axes, settings);
    sums.write_to(result.capture, 0, num_frames);
    result.excluded = scene.candidates.excluded().objects;
    result.sources.push_back({first_order(scan),
                              settings.max_bounces,
                              Estimator::Restir,
                              surfaces_kept(settings, result.excluded)});
    result.samples_per_pair = static_cast<std::uint64_t>(num_frames) *
                              static_cast<std::uint64_t>(candidates_per_frame(settings.restir));
    result.num_rays = counts.num_rays;
    result.restir_counts = counts;
    return result;
}

}  // namespace

RenderResult render_restir(const RenderTask& task) {
    const core::Scan& scan = task.scan;
    const core::HistogramAxes& axes = task.axes;
    const core::Stopwatch watch;
    require_gate_to_shrink_to(axes, task.settings);
    const RenderSettings settings = with_fitting_frames(task.settings, task.scene, scan, axes);
    RestirRenderer renderer(scan, settings);
    require_memory("restir", "reservoirs", renderer.bytes_needed(axes));
    const auto restir_scene = std::make_shared<RestirScene>(
        std::shared_ptr<const Scene>(std::shared_ptr<void>(), &task.scene), scan, axes, settings);
    const int per_frame = candidates_per_frame(settings.restir);
    StoppingRule rule(settings, (settings.samples + per_frame - 1) / per_frame, {});
    HistogramSums sums(scan.num_pairs(), axes, 1, settings.variance);
    int done = 0;
    const auto render_frame = [&] {
        const auto number = static_cast<std::uint64_t>(done);
        add_frame(renderer.render({restir_scene, axes, nullptr, nullptr, number}), settings, sums);
        ++done;
        const double fraction = rule.fraction_done(done, watch.seconds(), sums.time);
        task.progress.update(fraction, fmt::format("{} frames", done));
        return fraction >= 1.0;
    };
    bool interrupted = false;
    while (!interrupted && !render_frame()) interrupted = task.progress.should_stop();
    RenderResult result =
        result_of(sums, done, scan, axes, *restir_scene, settings, renderer.counts());
    warn_of_dropped_signal({task.scene, scan, axes, settings, task.progress}, result);
    if (done > 1) {
        result.estimated_error = relative_error(sums.time.squared_norms(done, nullptr), {});
    }
    result.interrupted = interrupted;
    result.seconds = watch.seconds();
    return result;
}

FrameRenderer make_restir_frame_renderer(const core::Scan& scan, const RenderSettings& settings) {
    struct Chain {
        RestirRenderer renderer;
        RestirFrame last;
    };
    struct State {
        RenderSettings settings;
        std::size_t num_chains;  // where time does not tell
        std::vector<Chain> chains;
        std::shared_ptr<RestirScene> scene;
    };
    const auto state = std::make_shared<State>(State{settings, 0, {}, {}});
    return [state, &scan](const Frame& frame, const core::Scan& frame_scan, const core::Progress&) {
        auto& [used, num_chains, chains, scene] = *state;
        const core::Stopwatch watch;
        require_gate_to_shrink_to(frame.axes, used);
        if (frame.index == 0) {
            used = with_fitting_frames(used, *frame.scene, scan, frame.axes);
            num_chains = num_chains_of(used);
        }
        if (scene == nullptr || scene->scene != frame.scene) {
            scene = std::make_shared<RestirScene>(frame.scene, frame_scan, frame.axes, used);
        }
        RestirCounts before;
        for (const Chain& chain : chains) before += chain.renderer.counts();
        // The first frame has as many chains as time lets it; the others must not have more, since
        // a chain without a past is worth less.
        const std::size_t most = frame.index > 0 ? chains.size()
                                 : used.seconds  ? kMaxChains
                                                 : num_chains;
        HistogramSums sums(frame_scan.num_pairs(), frame.axes, 1, used.variance);
        std::size_t done = 0;
        while (done < most &&
               (done < kMinChains || !used.seconds || watch.seconds() < *used.seconds)) {
            if (done == chains.size()) {
                chains.push_back({RestirRenderer(scan, used), {}});
                require_memory("restir",
                               "reservoirs",
                               static_cast<double>(std::max(chains.size(), num_chains)) *
                                   chains.back().renderer.bytes_needed(frame.axes));
            }
            auto& [renderer, last] = chains[done];
            const auto number = static_cast<std::uint64_t>(frame.index) * kMaxChains + done;
            last = renderer.render({scene,
                                    frame.axes,
                                    last.scene != nullptr ? &last : nullptr,
                                    done > 0 ? &chains[0].last : nullptr,
                                    number});
            add_frame(last, used, sums);
            ++done;
        }
        chains[0].renderer.learn_from(chains[1].renderer);  // which had a twin
        RestirCounts counts;
        for (const Chain& chain : chains) counts += chain.renderer.counts();
        RenderResult result =
            result_of(sums, static_cast<int>(done), frame_scan, frame.axes, *scene, used, counts);
        result.num_rays -= before.num_rays;
        result.estimated_error =
            relative_error(sums.time.squared_norms(static_cast<int>(done), nullptr), {});
        result.seconds = watch.seconds();
        return result;
    };
}

}  // namespace renderer
