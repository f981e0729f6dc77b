// SPDX-License-Identifier: MIT
#include "nlos/solver/pair_solver.h"

#include "nlos/preparation/histogram_preparation.h"
#include "nlos/solver/active_voxels.h"
#include "nlos/solver/albedo_density.h"
#include "nlos/solver/pair_operator.h"
#include "renderer/core/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

constexpr double kRadianceCounts = 400.0;    // in the brightest bin
constexpr std::size_t kPairsPerSubset = 64;  // at least
constexpr std::size_t kMaxSubsets = 16;      // at first
constexpr int kPassesPerDoubling = 3;        // of the subsets' size
constexpr std::size_t kFirstPairs = 256;     // that choose voxels
constexpr double kFirstFraction = 0.1;       // of the voxels to start with, the brightest
constexpr double kSmallestPairLight = 1e-3;  // of the brightest bin
constexpr float kNothing = 2e-3F;            // of the brightest voxel
constexpr double kToleranceOfPairs = 0.01;   // of the relative change, unless set
constexpr int kMaxPasses = 200;              // unless set
constexpr double kSparsityOfPairs = 0.1;     // of the weight of total variation, unless set
constexpr double kWeightOfPairs = 1.0;       // of total variation, unless set

class PairSolver {
 public:
    PairSolver(const MethodInput& input, const ReconstructSettings& settings)
        : input_(input),
          settings_(settings.solver),
          light_(input, settings.falloff, settings.solver.spot_m.value_or(0.0)),
          gains_(input.scan.num_pairs()),
          size_{input.axes.x_m.size(), input.axes.y_m.size(), input.axes.z_m.size()} {
        const bool is_counts =
            settings.solver.likelihood != Likelihood::Gaussian && input.measurement.is_counts;
        const auto values = input.transient.values();
        const float largest = *std::ranges::max_element(values);
        scale_ =
            is_counts || !(largest > 0.0F) ? 1.0F : static_cast<float>(kRadianceCounts) / largest;
        for (std::size_t pair = 0; pair < input.scan.num_pairs(); ++pair) {
            if (light_.observed()[pair].size() > 0) seen_pairs_.push_back(pair);
        }
        double sum = 0.0;
        double squares = 0.0;
        for (const float value : values) {
            sum += static_cast<double>(value);
            squares += static_cast<double>(value) * static_cast<double>(value);
        }
        if (sum > 0.0) intensity_ = std::max(1.0F, scale_ * static_cast<float>(squares / sum));
    }

    Volume run() {
        choose_first_voxels();
        const std::size_t most =
            std::clamp<std::size_t>(seen_pairs_.size() / kPairsPerSubset, 1, kMaxSubsets);
        const double tolerance = settings_.tolerance.value_or(kToleranceOfPairs);
        int pass = 0;
        for (; pass < settings_.max_iterations.value_or(kMaxPasses) && voxels_.size() > 0; ++pass) {
            check_stop(input_.progress);
            const std::size_t num_subsets =
                std::max<std::size_t>(1, most >> std::min<int>(pass / kPassesPerDoubling, 16));
            if (settings_.gains && pass > 0 && pass % kPassesPerDoubling == 0) update_gains();
            const std::vector<float> before = voxels_.albedo;
            for (std::size_t subset = 0; subset < num_subsets; ++subset) {
                maximise_expectation(subset, num_subsets);
            }
            smooth();
            const double change = relative_change(before);
            input_.progress.update(
                0.95 * std::clamp(std::log(change) / std::log(tolerance), 0.0, 1.0), "solver");
            if (num_subsets == 1 && change <= tolerance) break;
            leave_out_empty();
        }
        if (input_.progress.announce) {
            input_.progress.announce(
                fmt::format("solver: {} passes, {} voxels left", pass, voxels_.size()));
        }
        Volume volume{input_.axes, std::vector<float>(input_.axes.num_voxels(), 0.0F), {}};
        const auto unit = static_cast<float>(albedo_density_of_light(input_)) / scale_;
        for (std::size_t i = 0; i < voxels_.size(); ++i) {
            volume.values[voxels_.indices[i]] = unit * voxels_.albedo[i];
        }
        return volume;
    }

 private:
    std::vector<std::size_t> pairs_of(std::size_t subset, std::size_t num_subsets) const {
        std::vector<std::size_t> pairs;
        for (std::size_t i = subset; i < seen_pairs_.size(); i += num_subsets) {
            pairs.push_back(seen_pairs_[i]);
        }
        return pairs;
    }

    /// Counts, or what is taken for them, of some pairs.
    std::vector<float> counts_of(const std::vector<std::size_t>& pairs) const {
        std::vector<float> counts(pairs.size() * light_.num_bins());
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const auto histogram = input_.transient.histogram(pairs[i]);
            for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
                counts[i * light_.num_bins() + bin] = std::max(0.0F, scale_ * histogram[bin]);
            }
        }
        return counts;
    }

    /// Starts with the voxels that the first step of expectation maximisation makes brightest.
    void choose_first_voxels() {
        const std::size_t stride = std::max<std::size_t>(1, seen_pairs_.size() / kFirstPairs);
        const std::vector<std::size_t> pairs = pairs_of(0, stride);
        const std::vector<std::size_t> all = reachable_voxels();
        if (all.empty()) return;
        place(all);
        std::vector<float> counts = counts_of(pairs);
        for (std::size_t i = 0; i < counts.size(); ++i) {
            const double background = input_.measurement.background(pairs[i / light_.num_bins()]);
            counts[i] = std::max(0.0F, counts[i] - scale_ * static_cast<float>(background));
        }
        std::vector<float> bright(all.size());
        std::vector<float> seen(all.size());
        light_.adjoint(counts, pairs, bright);
        light_.adjoint(std::vector<float>(counts.size(), 1.0F), pairs, seen);
        for (std::size_t i = 0; i < all.size(); ++i) {
            bright[i] = seen[i] > 0.0F ? bright[i] / seen[i] : 0.0F;
        }
        const auto keep =
            static_cast<std::size_t>(kFirstFraction * static_cast<double>(all.size()));
        const float least = core::value_at_rank(bright, bright.size() - keep - 1);
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (bright[i] <= least || !(bright[i] > 0.0F)) continue;
            voxels_.indices.push_back(all[i]);
            voxels_.albedo.push_back(bright[i]);
        }
        for (auto& dual : voxels_.duals) dual.assign(voxels_.size(), 0.0F);
        place(voxels_.indices);
        voxels_.link_neighbours(size_);
        sensitivity_.clear();
    }

    /// Voxels no farther from the wall than light can have come from.
    std::vector<std::size_t> reachable_voxels() const {
        const std::vector<double> light =
            light_per_bin(input_.transient, input_.observed, input_.measurement.background_per_bin);
        const double least = kSmallestPairLight * *std::ranges::max_element(light);
        double end = static_cast<double>(light.size());
        while (end > 1.0 && light[static_cast<std::size_t>(end) - 1] <= least) end -= 1.0;
        const double farthest = 0.5 * (input_.time_axis.bin_begin_m(end) -
                                       core::device_segment_range_m(input_.scan)[0]);
        std::vector<std::size_t> voxels;
        for (std::size_t i = 0; i < input_.axes.num_voxels(); ++i) {
            if (input_.axes.z_m[i % size_[2]] <= farthest) voxels.push_back(i);
        }
        return voxels;
    }

    void place(const std::vector<std::size_t>& indices) {
        std::vector<Eigen::Vector3f> positions;
        positions.reserve(indices.size());
        for (const std::size_t i : indices) {
            positions.push_back(Eigen::Vector3d(input_.axes.x_m[i / (size_[1] * size_[2])],
                                                input_.axes.y_m[i / size_[2] % size_[1]],
                                                input_.axes.z_m[i % size_[2]])
                                    .cast<float>());
        }
        light_.set_voxels(std::move(positions));
    }

    /// What a subset sees of each voxel: A' 1 over its observed bins.
    const std::vector<float>& sensitivity(std::size_t subset,
                                          std::size_t num_subsets,
                                          const std::vector<std::size_t>& pairs) {
        if (sensitivity_.size() != num_subsets) sensitivity_.assign(num_subsets, {});
        std::vector<float>& own = sensitivity_[subset];
        if (own.empty()) {
            own.resize(voxels_.size());
            light_.adjoint(std::vector<float>(pairs.size() * light_.num_bins(), 1.0F), pairs, own);
        }
        return own;
    }

    /// f <- f A'(counts / (A f + background)) / (A' 1 + sparsity) over one subset of the pairs.
    void maximise_expectation(std::size_t subset, std::size_t num_subsets) {
        const std::vector<std::size_t> pairs = pairs_of(subset, num_subsets);
        const std::vector<float>& seen = sensitivity(subset, num_subsets, pairs);
        const std::vector<float> counts = counts_of(pairs);
        std::vector<float> expected(counts.size());
        light_.forward(voxels_.albedo, pairs, expected);
        for (std::size_t i = 0; i < counts.size(); ++i) {
            const auto background =
                static_cast<float>(input_.measurement.background(pairs[i / light_.num_bins()]));
            const float m = expected[i] + scale_ * background;
            expected[i] = m > 1e-6F ? counts[i] / m : 0.0F;
        }
        std::vector<float> gain(voxels_.size());
        light_.adjoint(expected, pairs, gain);
        const auto fraction = 1.0F / static_cast<float>(num_subsets);
        for (std::size_t i = 0; i < gain.size(); ++i) {
            const float cost = seen[i] + fraction * sparsity_weight(i);
            voxels_.albedo[i] *= cost > 0.0F ? gain[i] / cost : 0.0F;
        }
    }

    /// The gains that explain counts best by the voxels as they are.
    void update_gains() {
        std::vector<double> measured(gains_.factors().size(), 0.0);
        std::vector<double> expected(measured.size(), 0.0);
        for (std::size_t subset = 0; subset < kMaxSubsets; ++subset) {
            const std::vector<std::size_t> pairs = pairs_of(subset, kMaxSubsets);
            const std::vector<float> counts = counts_of(pairs);
            std::vector<float> light(counts.size());
            light_.forward(voxels_.albedo, pairs, light);
            for (std::size_t i = 0; i < counts.size(); ++i) {
                const std::size_t pair = pairs[i / light_.num_bins()];
                const auto bin = static_cast<int>(i % light_.num_bins());
                if (!light_.observed()[pair].holds(bin)) continue;
                measured[pair] += static_cast<double>(counts[i]) -
                                  static_cast<double>(scale_) * input_.measurement.background(pair);
                expected[pair] += static_cast<double>(light[i] / gains_[pair]);
            }
        }
        gains_.update(measured, expected);
        light_.set_gains(gains_);
        sensitivity_.clear();
    }

    /// The standard deviation that noise gives the likelihood's slope at a voxel, the root of the
    /// sum of A^2 / counts: as if all pairs saw it alike, in bins of the mean intensity.
    float slope_noise(std::size_t i) const {
        return total_seen_.empty()
                   ? 0.0F
                   : total_seen_[i] /
                         std::sqrt(intensity_ * static_cast<float>(seen_pairs_.size()));
    }
    float sparsity_weight(std::size_t i) const {
        const double tv = settings_.tv.value_or(kWeightOfPairs);
        return static_cast<float>(settings_.sparsity.value_or(kSparsityOfPairs * tv)) *
               slope_noise(i);
    }

    void smooth() {
        total_seen_.assign(voxels_.size(), 0.0F);
        for (const std::vector<float>& own : sensitivity_) {
            for (std::size_t i = 0; i < own.size(); ++i) total_seen_[i] += own[i];
        }
        const auto tv = static_cast<float>(settings_.tv.value_or(kWeightOfPairs));
        if (!(tv > 0.0F)) return;
        std::vector<float> weights(voxels_.size());
        for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = tv * slope_noise(i);
        smooth_albedo(voxels_, total_seen_, weights);
    }

    double relative_change(const std::vector<float>& before) const {
        double change = 0.0;
        double norm = 0.0;
        for (std::size_t i = 0; i < before.size(); ++i) {
            change += std::pow(static_cast<double>(voxels_.albedo[i] - before[i]), 2);
            norm += std::pow(static_cast<double>(voxels_.albedo[i]), 2);
        }
        return norm > 0.0 ? std::sqrt(change / norm) : 0.0;
    }

    void leave_out_empty() {
        const float least =
            kNothing * (voxels_.size() > 0 ? *std::ranges::max_element(voxels_.albedo) : 0.0F);
        ActiveVoxels kept = voxels_.brighter_than(least);
        if (10 * kept.size() > 9 * voxels_.size()) return;
        voxels_ = std::move(kept);
        place(voxels_.indices);
        voxels_.link_neighbours(size_);
        sensitivity_.clear();
        total_seen_.clear();
    }

    const MethodInput& input_;
    const SolverSettings& settings_;
    PairOperator light_;
    PairGains gains_;
    std::array<std::size_t, 3> size_;
    float scale_ = 1.0F;      ///< from the histograms' unit to counts
    float intensity_ = 1.0F;  ///< the mean of counts, weighted by themselves
    std::vector<std::size_t> seen_pairs_;
    ActiveVoxels voxels_;
    std::vector<std::vector<float>> sensitivity_;  ///< per subset
    std::vector<float> total_seen_;                ///< of the last pass's subsets
};

}  // namespace

Volume solve_pairs(const MethodInput& input, const ReconstructSettings& settings) {
    return PairSolver(input, settings).run();
}

double solve_pairs_bytes(const MethodInput& input) {
    const auto voxels = static_cast<double>(input.axes.num_voxels());
    const double histograms = 4.0 * static_cast<double>(input.transient.values().size());
    return (4.0 * 8.0 + kFirstFraction * (4.0 * kMaxSubsets + 100.0)) * voxels + 4.0 * histograms;
}

}  // namespace nlos
