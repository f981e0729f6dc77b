// SPDX-License-Identifier: MIT
#include "renderer/restir/restir_renderer.h"

#include "renderer/core/nearest_neighbours.h"
#include "renderer/core/parallel.h"

#include <algorithm>
#include <cmath>
#include <mutex>

namespace renderer {
namespace {

constexpr std::size_t kNearPoints = 8;
constexpr std::ptrdiff_t kPixelRadius = 2;

// The nearest other points of each point, (points, count).
std::vector<std::size_t> near_points(const std::vector<core::Vec3>& points, std::size_t count) {
    if (count == 0) return {};
    const core::NearestNeighbours found = core::nearest_neighbours(points, points, count + 1);
    std::vector<std::size_t> near;
    near.reserve(points.size() * count);
    for (std::size_t i = 0; i < points.size(); ++i) {
        // A point is usually its own nearest, but not where points coincide.
        const auto* const begin = found.indices.data() + i * (count + 1);
        const auto* const self = std::find(begin, begin + count, i);
        near.insert(near.end(), begin, self);
        near.insert(near.end(), self + (self == begin + count ? 0 : 1), begin + count + 1);
        near.resize((i + 1) * count);
    }
    return near;
}

constexpr std::size_t kPairsPerTask = 16;

// Random number streams of one frame: one for the candidates, one per round of reuse, and one for
// the positions within pixels.
constexpr std::uint64_t kStreamsPerFrame = 64;
constexpr int kCandidateStage = 0;
constexpr std::uint64_t kPixelStream = kStreamsPerFrame - 1;

// Width of the gate over that of the wider gate from which paths are shifted into it.
constexpr double kShrink = 0.2;

// Pixels whose surfaces are tilted further against each other share few useful paths.
constexpr double kMinNormalCosine = 0.5;

// Confidence counts frames, whatever their number of candidates.
constexpr double kConfidenceOfFrame = 1.0;

PathReservoir limited(PathReservoir reservoir, double most) {
    reservoir.confidence = std::min(reservoir.confidence, most);
    return reservoir;
}

PathCandidates::Effort effort_of(const RestirSettings& settings, double share) {
    PathCandidates::Effort effort;
    effort.walks = std::max(1, static_cast<int>(std::lround(share * settings.walks)));
    if (has_shared_walks(settings.candidates)) {
        effort.shared_walks = static_cast<int>(std::lround(share * settings.shared_walks));
    }
    return effort;
}

}  // namespace

RestirNeighbours::RestirNeighbours(const core::Scan& scan) : scan_(scan) {
    const auto* wall = scan.as<core::WallScan>();
    if (wall == nullptr) return;
    near_sensing_count_ = std::min(kNearPoints, wall->sensing.size() - 1);
    near_sensing_ = near_points(wall->sensing.positions, near_sensing_count_);
    if (!wall->is_exhaustive()) return;
    near_illumination_count_ = std::min(kNearPoints, wall->illumination.size() - 1);
    near_illumination_ = near_points(wall->illumination.positions, near_illumination_count_);
}

void RestirNeighbours::list(const core::ImageScan& image,
                            std::size_t pixel,
                            std::vector<std::size_t>& near) const {
    const auto width = static_cast<std::ptrdiff_t>(image.camera.width());
    const auto height = static_cast<std::ptrdiff_t>(image.camera.height());
    const std::ptrdiff_t x = static_cast<std::ptrdiff_t>(pixel) / height;
    const std::ptrdiff_t y = static_cast<std::ptrdiff_t>(pixel) % height;
    for (std::ptrdiff_t i = x - kPixelRadius; i <= x + kPixelRadius; ++i) {
        for (std::ptrdiff_t j = y - kPixelRadius; j <= y + kPixelRadius; ++j) {
            if (i < 0 || j < 0 || i >= width || j >= height || (i == x && j == y)) continue;
            near.push_back(static_cast<std::size_t>(i * height + j));
        }
    }
}

void RestirNeighbours::list(const core::WallScan& scan,
                            std::size_t pair,
                            std::vector<std::size_t>& near) const {
    const std::size_t sensing = scan.sensing.size();
    const std::size_t sensor = pair % sensing;
    for (std::size_t i = 0; i < near_sensing_count_; ++i) {
        near.push_back(pair - sensor + near_sensing_[sensor * near_sensing_count_ + i]);
    }
    for (std::size_t i = 0; i < near_illumination_count_; ++i) {
        const std::size_t light = pair / sensing;
        near.push_back(near_illumination_[light * near_illumination_count_ + i] * sensing + sensor);
    }
}

void RestirNeighbours::pick(std::size_t pair,
                            int count,
                            core::Rng& rng,
                            std::vector<std::size_t>& picked) const {
    picked.clear();
    scan_.visit([&](const auto& kind) { list(kind, pair, picked); });
    const std::size_t wanted = std::min(picked.size(), static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < wanted; ++i) {
        const auto rest = static_cast<double>(picked.size() - i);
        std::swap(picked[i], picked[i + static_cast<std::size_t>(rng.uniform() * rest)]);
    }
    picked.resize(wanted);
}

// The state of a thread that works on some pairs of a frame.
struct RestirRenderer::Worker {
    const RestirSettings& settings;
    const RestirFrame& frame;
    std::vector<ReservoirBuilder<ReusablePath>> builders;  // per bin
    core::Rng rng{0, 0, 0};
    std::size_t pair = 0;
    RestirCounts counts{};
    std::vector<std::size_t> neighbours{};

    // Draws paths of the pair within a gate and offers them to the builder of their bin.
    template <class BuilderOf>
    void draw(const TimeGate& gate, double share, const BuilderOf& builder_of) {
        const PathDomain& domain = frame.domains[pair];
        const PathCandidates::Request request{
            domain, gate.begin_m(), gate.end_m(), effort_of(settings, share)};
        counts.num_rays += frame.scene->candidates.generate(
            request, rng, [&](const ReusablePath& path, const PathValue& value, double density) {
                ReservoirBuilder<ReusablePath>* const builder = builder_of(value.extent);
                if (builder == nullptr) return;
                const double target = value.radiance * gate.weight(value.extent.opl_m);
                ReusablePath placed = path;
                placed.pixel_u = domain.pixel_u;
                builder->add(placed, target, target / density, rng.uniform());
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
        const double share = settings.shrink_fraction;
        const ReservoirDomain here(frame, pair, 0);
        ReservoirDomain wide = here;
        TimeGate& gate = wide.gate.time;
        gate.width_m /= kShrink;
        gate.start_m -= 0.5 * (gate.width_m - here.gate.time.width_m);
        ReservoirBuilder<ReusablePath> builder;
        draw(gate, share, [&](const PathExtent&) { return &builder; });
        return merge(narrow, here, builder.finish(share * kConfidenceOfFrame), wide);
    }

    PathReservoir reuse_temporally(const RestirFrame& previous,
                                   std::size_t bin,
                                   const PathReservoir& fresh) {
        const std::size_t index = pair * frame.bins.count() + bin;
        return merge(fresh,
                     {frame, pair, bin},
                     limited(previous.reservoirs.load(index), settings.confidence_cap),
                     {previous, pair, bin});
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
        return limited(merged.finish(rng.uniform()), settings.confidence_cap);
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
    return 3.0 * reservoirs * PackedReservoirs::bytes_per_reservoir(max_vertices_);
}

void RestirRenderer::for_each_pair(const FrameInput& input,
                                   const RestirFrame& frame,
                                   int stage,
                                   const std::function<void(Worker&)>& body) {
    std::mutex mutex;
    core::parallel_blocks(
        scan_.num_pairs(), kPairsPerTask, [&](std::size_t begin, std::size_t end) {
            Worker worker{settings_.restir, frame, {}};
            worker.builders.resize(frame.bins.count());
            for (std::size_t pair = begin; pair < end; ++pair) {
                worker.pair = pair;
                worker.rng =
                    core::Rng(settings_.seed,
                              pair,
                              input.number * kStreamsPerFrame + static_cast<std::uint64_t>(stage));
                body(worker);
            }
            const std::lock_guard lock(mutex);
            counts_ += worker.counts;
        });
}

RestirFrame RestirRenderer::render(const FrameInput& input) {
    RestirFrame frame;
    frame.scene = input.scene;
    frame.bins = ReservoirBins(input.axes, settings_.gate);
    frame.domains.resize(scan_.num_pairs());
    frame.reservoirs = PackedReservoirs(scan_.num_pairs() * frame.bins.count(), max_vertices_);
    find_domains(input, frame);
    counts_.num_rays += input.scene->candidates.prepare(settings_.seed, input.number);
    generate_candidates(input, frame);
    if (settings_.restir.reuse == Reuse::None) return frame;
    for (int round = 0; round < settings_.restir.rounds; ++round) {
        reuse_spatially(input, round, frame);
    }
    return frame;
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
    const bool reuses = settings_.restir.reuse != Reuse::None && input.previous != nullptr;
    for_each_pair(input, frame, kCandidateStage, [&](Worker& worker) {
        auto& builders = worker.builders;
        std::fill(builders.begin(), builders.end(), ReservoirBuilder<ReusablePath>());
        const double share = 1.0 - settings_.restir.shrink_fraction;
        worker.draw(frame.bins.lengths(), share, [&](const PathExtent& extent) {
            const auto bin = frame.bins.bin_of(extent);
            return bin ? &builders[*bin] : nullptr;
        });
        for (std::size_t bin = 0; bin < num_bins; ++bin) {
            PathReservoir fresh = builders[bin].finish(share * kConfidenceOfFrame);
            if (share < 1.0) fresh = worker.sample_wide_gate(fresh);
            const bool is_reused = reuses && !frame.bins.is_left_out(bin);
            frame.reservoirs.store(
                worker.pair * num_bins + bin,
                is_reused ? worker.reuse_temporally(*input.previous, bin, fresh) : fresh);
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
        if (frame.scene->pixel_places) {
            const std::vector<core::Vec3>& normals = frame.scene->pixel_places->normals();
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

}  // namespace renderer
