// SPDX-License-Identifier: MIT
#include "renderer/restir/restir_renderer.h"

#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <cmath>
#include <mutex>

namespace renderer {
namespace {

constexpr std::size_t kPairsPerTask = 16;

// Random number streams of one frame: one for the candidates, one per round of spatial reuse, one
// for the reuse of the past, and one for the positions within pixels.
constexpr std::uint64_t kStreamsPerFrame = 64;
constexpr int kCandidateStage = 0;
constexpr std::uint64_t kPixelStream = kStreamsPerFrame - 1;
constexpr int kTemporalStage = kStreamsPerFrame - 2;

// CPU time of a frame with a round of spatial reuse over that of one without. It is fixed, and not
// measured, so that frames are the same on every machine.
constexpr double kCostOfRound = 2.0;

// How much of the sums over earlier frames is kept when a frame's are added.
constexpr double kKeptStatistics = 0.7;

// Width of the gate over that of the wider gate from which paths are shifted into it.
constexpr double kShrink = 0.2;

// Pixels whose surfaces are tilted further against each other share few useful paths.
constexpr double kMinNormalCosine = 0.5;

// Confidence counts frames, whatever their number of candidates.
constexpr double kConfidenceOfFrame = 1.0;

PathCandidates::Effort effort_of(const RestirSettings& settings, double fraction) {
    PathCandidates::Effort effort;
    effort.walks = std::max(1, static_cast<int>(std::lround(fraction * settings.walks)));
    if (has_shared_walks(settings.candidates)) {
        effort.shared_walks = static_cast<int>(std::lround(fraction * settings.shared_walks));
    }
    if (has_connections(settings.candidates)) {
        effort.connections =
            std::max(1, static_cast<int>(std::lround(fraction * settings.connections)));
    }
    return effort;
}

}  // namespace

// The state of a thread that works on some pairs of a frame.
struct RestirRenderer::Worker {
    const RestirSettings& settings;
    const RestirFrame& frame;
    std::vector<ReservoirBuilder<ReusablePath>> builders;  // per bin
    core::Rng rng{0, 0, 0};
    std::size_t pair = 0;
    RestirCounts counts{};
    std::vector<std::size_t> neighbours{};
    std::array<ReuseStatistics, 2> statistics{};  // of even and odd pairs
    std::array<double, 2> shift_noise{};          // in earlier frames, for even and odd pairs
    double squared_weights = 0.0;                 // of the pair's candidates

    // Draws paths of the pair within a gate and offers them to the builder of their bin.
    template <class BuilderOf>
    void draw(const TimeGate& gate, double fraction, const BuilderOf& builder_of) {
        const PathDomain& domain = frame.domains[pair];
        const PathCandidates::Request request{
            domain, gate.begin_m(), gate.end_m(), effort_of(settings, fraction)};
        counts.num_rays += frame.scene->candidates.generate(
            request, rng, [&](const ReusablePath& path, const PathValue& value, double density) {
                ReservoirBuilder<ReusablePath>* const builder = builder_of(value.optical_path);
                if (builder == nullptr) return;
                const double target = value.radiance * gate.weight(value.optical_path.opl_m);
                ReusablePath placed = path;
                placed.pixel_u = domain.pixel_u;
                const double weight = target / density;
                squared_weights += weight * weight;
                builder->add(placed, target, weight, rng.uniform());
            });
    }

    // Merges the reservoir of another domain into that of `here`.
    PathReservoir merge(const PathReservoir& canonical,
                        const ReservoirDomain& here,
                        const PathReservoir& other,
                        const ReservoirDomain& there) {
        const ShiftedSample in = shift_sample(other, there, here, *frame.scene, counts);
        const ShiftedSample out = shift_sample(canonical, here, there, *frame.scene, counts);
        ++counts.num_merges;
        return resample_balance_heuristic(canonical, other, in, out, rng.uniform(), rng.uniform());
    }

    // Candidates against a wider gate, shifted into the narrow one (source [Kim2026]).
    PathReservoir sample_wide_gate(const PathReservoir& narrow) {
        const double fraction = settings.shrink_fraction;
        const ReservoirDomain here(frame, pair, 0);
        ReservoirDomain wide = here;
        TimeGate& gate = wide.gate.time;
        gate.width_m /= kShrink;
        gate.start_m -= 0.5 * (gate.width_m - here.gate.time.width_m);
        ReservoirBuilder<ReusablePath> builder;
        draw(gate, fraction, [&](const OpticalPath&) { return &builder; });
        return merge(narrow, here, builder.finish(fraction * kConfidenceOfFrame), wide);
    }

    PathReservoir with_past(const RestirFrame& previous,
                            std::size_t bin,
                            const PathReservoir& fresh) {
        const ReservoirDomain here(frame, pair, bin);
        const ReservoirDomain there(previous, pair, bin);
        PathReservoir past = previous.reservoirs.load(pair * frame.bins.count() + bin);
        const ShiftedSample in = shift_sample(past, there, here, *frame.scene, counts);
        const ShiftedSample out = shift_sample(fresh, here, there, *frame.scene, counts);
        ++counts.num_merges;
        ReuseStatistics& sums = statistics[pair % 2];
        if (!here.is_same_as(there)) {
            past.confidence = std::min<double>(past.confidence, settings.confidence_cap);
            sums.add_shift(fresh, past, in);
            past.confidence /= 1.0 + past.confidence * shift_noise[pair % 2];
        }
        sums.past_frames += past.confidence;
        ++sums.num_pasts;
        return resample_balance_heuristic(fresh, past, in, out, rng.uniform(), rng.uniform());
    }

    PathReservoir with_neighbours(std::size_t bin) {
        const std::size_t num_bins = frame.bins.count();
        const PathReservoir canonical = frame.reservoirs.load(pair * num_bins + bin);
        if (frame.bins.is_left_out(bin)) return canonical;
        std::optional<std::size_t> before;
        std::optional<std::size_t> after;
        if (settings.reuse_bins) {
            before = frame.bins.beside(bin, -1);
            after = frame.bins.beside(bin, 1);
        }
        const int num_neighbours =
            static_cast<int>(neighbours.size()) + (before ? 1 : 0) + (after ? 1 : 0);
        const ReservoirDomain here(frame, pair, bin);
        PairwiseMisMerge<ReusablePath> merged(canonical, num_neighbours);
        const auto add = [&](std::size_t other_pair, std::size_t other_bin) {
            const ReservoirDomain there(frame, other_pair, other_bin);
            const PathReservoir other = frame.reservoirs.load(other_pair * num_bins + other_bin);
            const ShiftedSample in = shift_sample(other, there, here, *frame.scene, counts);
            const ShiftedSample out = shift_sample(canonical, here, there, *frame.scene, counts);
            merged.add_neighbour(other, in, out, rng.uniform());
            ++counts.num_merges;
        };
        for (const std::size_t other : neighbours) add(other, bin);
        if (before) add(pair, *before);
        if (after) add(pair, *after);
        return merged.finish(rng.uniform());
    }
};

RestirRenderer::RestirRenderer(const core::Scan& scan, const RenderSettings& settings)
    : scan_(scan),
      settings_(settings),
      max_vertices_(std::max(0, settings.max_bounces - (scan.has_wall() ? 2 : 1))),
      neighbours_(scan) {}

double RestirRenderer::bytes_needed(const core::HistogramAxes& axes) const {
    const double reservoirs = static_cast<double>(scan_.num_pairs()) *
                              static_cast<double>(ReservoirBins(axes, settings_.gate).count());
    // The frame's, those of a round of reuse, and the previous frame's.
    return reservoirs * (3.0 * PackedReservoirs::bytes_per_reservoir(max_vertices_) + 4.0);
}

void RestirRenderer::for_each_pair(const FrameInput& input,
                                   const RestirFrame& frame,
                                   int stage,
                                   const std::function<void(Worker&)>& body) {
    std::mutex mutex;
    // Of each block, to be added in order: sums must not depend on the number of threads.
    std::vector<std::array<ReuseStatistics, 2>> statistics((scan_.num_pairs() + kPairsPerTask - 1) /
                                                           kPairsPerTask);
    core::parallel_blocks(
        scan_.num_pairs(), kPairsPerTask, [&](std::size_t begin, std::size_t end) {
            Worker worker{settings_.restir, frame, {}};
            worker.shift_noise = {statistics_[1].shift_noise(), statistics_[0].shift_noise()};
            worker.builders.resize(frame.bins.count());
            for (std::size_t pair = begin; pair < end; ++pair) {
                worker.pair = pair;
                worker.rng =
                    core::Rng(settings_.seed,
                              pair,
                              input.number * kStreamsPerFrame + static_cast<std::uint64_t>(stage));
                body(worker);
            }
            statistics[begin / kPairsPerTask] = worker.statistics;
            const std::lock_guard lock(mutex);
            counts_ += worker.counts;
        });
    for (const auto& block : statistics) {
        for (const std::size_t half : {0, 1}) statistics_of_frame_[half].add(block[half]);
    }
}

RestirFrame RestirRenderer::render(const FrameInput& input) {
    RestirFrame frame;
    frame.scene = input.scene;
    frame.bins = ReservoirBins(input.axes, settings_.gate);
    frame.domains.resize(scan_.num_pairs());
    frame.reservoirs = PackedReservoirs(scan_.num_pairs() * frame.bins.count(), max_vertices_);
    frame.candidates.resize(frame.reservoirs.size());
    find_domains(input, frame);
    counts_.num_rays += input.scene->candidates.prepare(settings_.seed, input.number);
    generate_candidates(input, frame);
    if (settings_.restir.reuse == Reuse::None) return frame;
    const int rounds = rounds_of_spatial_reuse(input);
    for (int round = 0; round < rounds; ++round) reuse_spatially(input, round, frame);
    reuse_temporally(input, frame);
    end_statistics_of_frame(rounds > 0);
    return frame;
}

int RestirRenderer::rounds_of_spatial_reuse(const FrameInput& input) const {
    if (settings_.restir.rounds) return *settings_.restir.rounds;
    // Wall points see the hidden scene each from elsewhere: on scans a round never gains what it
    // costs, and is not even tried.
    if (!gain_of_spatial_reuse_) return input.scene->sensor_pairs.is_image() ? 1 : 0;
    double past = 0.0;
    if (input.previous != nullptr) {
        for (const ReuseStatistics& half : statistics_) past += 0.5 * half.mean_past_frames();
    }
    return past + *gain_of_spatial_reuse_ > kCostOfRound * (past + 1.0) ? 1 : 0;
}

void RestirRenderer::end_statistics_of_frame(bool had_spatial_reuse) {
    if (had_spatial_reuse) {
        ReuseStatistics both = statistics_of_frame_[0];
        both.add(statistics_of_frame_[1]);
        gain_of_spatial_reuse_ = both.gain_of_spatial_reuse();
    }
    for (const std::size_t half : {0, 1}) {
        statistics_[half].add(statistics_of_frame_[half], kKeptStatistics);
        statistics_of_frame_[half] = {};
    }
}

void RestirRenderer::learn_from(const RestirRenderer& other) {
    statistics_ = other.statistics_;
    gain_of_spatial_reuse_ = other.gain_of_spatial_reuse_;
}

void RestirRenderer::find_domains(const FrameInput& input, RestirFrame& frame) const {
    const SensorPairs& sensor_pairs = input.scene->sensor_pairs;
    core::parallel_for(frame.domains.size(), [&](std::size_t pair) {
        PathDomain& domain = frame.domains[pair];
        domain.ends = sensor_pairs.ends(pair);
        if (!sensor_pairs.is_image()) return;
        core::Rng rng(settings_.seed, pair, input.number * kStreamsPerFrame + kPixelStream);
        const double u1 = rng.uniform();
        domain = pixel_domain(sensor_pairs, pair, {u1, rng.uniform()});
    });
}

void RestirRenderer::generate_candidates(const FrameInput& input, RestirFrame& frame) {
    const std::size_t num_bins = frame.bins.count();
    for_each_pair(input, frame, kCandidateStage, [&](Worker& worker) {
        auto& builders = worker.builders;
        std::fill(builders.begin(), builders.end(), ReservoirBuilder<ReusablePath>());
        const double fraction = 1.0 - settings_.restir.shrink_fraction;
        worker.squared_weights = 0.0;
        worker.draw(frame.bins.lengths(), fraction, [&](const OpticalPath& optical_path) {
            const auto bin = frame.bins.bin_of(optical_path);
            return bin ? &builders[*bin] : nullptr;
        });
        for (std::size_t bin = 0; bin < num_bins; ++bin) {
            PathReservoir fresh = builders[bin].finish(fraction * kConfidenceOfFrame);
            if (fraction < 1.0) fresh = worker.sample_wide_gate(fresh);
            const double estimate = fresh.estimate();
            ReuseStatistics& sums = worker.statistics[worker.pair % 2];
            sums.candidates += estimate * estimate;
            const std::size_t index = worker.pair * num_bins + bin;
            frame.candidates[index] = static_cast<float>(estimate);
            if (input.twin != nullptr) {
                const double difference = estimate - double{input.twin->candidates[index]};
                sums.candidate_variance += 0.5 * difference * difference;
            }
            frame.reservoirs.store(index, fresh);
        }
        if (input.twin == nullptr) {
            worker.statistics[worker.pair % 2].candidate_variance += worker.squared_weights;
        }
    });
}

void RestirRenderer::reuse_spatially(const FrameInput& input, int round, RestirFrame& frame) {
    const std::size_t num_bins = frame.bins.count();
    PackedReservoirs merged(frame.reservoirs.size(), max_vertices_);
    for_each_pair(input, frame, kCandidateStage + 1 + round, [&](Worker& worker) {
        const std::size_t pair = worker.pair;
        neighbours_.pick(pair, settings_.restir.neighbours, worker.rng, worker.neighbours);
        // Neighbours must be chosen without regard to anything random in their reservoirs, such as
        // where in the pixels their paths start.
        if (frame.scene->pixel_positions) {
            const std::vector<core::Vec3>& normals = frame.scene->pixel_positions->normals();
            std::erase_if(worker.neighbours, [&](std::size_t other) {
                return std::abs(normals[other].dot(normals[pair])) < kMinNormalCosine;
            });
        }
        for (std::size_t bin = 0; bin < num_bins; ++bin) {
            merged.store(pair * num_bins + bin, worker.with_neighbours(bin));
        }
    });
    frame.reservoirs = std::move(merged);
}

void RestirRenderer::reuse_temporally(const FrameInput& input, RestirFrame& frame) {
    const std::size_t num_bins = frame.bins.count();
    for_each_pair(input, frame, kTemporalStage, [&](Worker& worker) {
        for (std::size_t bin = 0; bin < num_bins; ++bin) {
            const std::size_t index = worker.pair * num_bins + bin;
            const PathReservoir fresh = frame.reservoirs.load(index);
            const double estimate = fresh.estimate();
            worker.statistics[worker.pair % 2].fresh += estimate * estimate;
            if (input.previous == nullptr || frame.bins.is_left_out(bin)) continue;
            frame.reservoirs.store(index, worker.with_past(*input.previous, bin, fresh));
        }
    });
}

}  // namespace renderer
