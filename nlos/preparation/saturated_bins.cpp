// SPDX-License-Identifier: MIT
#include "nlos/preparation/saturated_bins.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace nlos {
namespace {

/// Bins of all pairs by whether they hold the largest value.
class SaturationFinder {
 public:
    explicit SaturationFinder(const core::Capture& capture) : capture_(capture) {
        for_each([&](std::size_t, int, float value) { ceiling_ = std::max(ceiling_, value); });
        const float below = ceiling_ - below_ceiling();
        std::size_t run = 0;
        std::size_t last_pair = 0;
        for_each([&](std::size_t pair, int, float value) {
            ++num_bins_;
            if (value != ceiling_ || pair != last_pair) run = 0;
            last_pair = pair;
            if (value == ceiling_) {
                ++num_at_ceiling_;
                if (++run > 2) ++num_in_runs_;
            } else if (value >= below) {
                ++num_below_;
            }
        });
    }

    bool is_saturated() const {
        constexpr std::size_t kFewest = 5;
        constexpr double kTimesANumber = 5.0;
        constexpr float kFewCounts = 15.0F;  // so few meet by chance
        if (!(ceiling_ > 0.0F) || num_at_ceiling_ < kFewest) return false;
        if (2 * num_at_ceiling_ > num_bins_) return false;  // a capture without light of its own
        const bool has_runs = 4 * num_in_runs_ > num_at_ceiling_;
        if (capture_.unit != core::TransientUnit::Counts) return has_runs;
        const double per_number =
            static_cast<double>(num_below_) / static_cast<double>(below_ceiling());
        return ceiling_ >= kFewCounts && (has_runs || is_full_bits(ceiling_)) &&
               static_cast<double>(num_at_ceiling_) > kTimesANumber * (1.0 + per_number);
    }

    void find(CaptureFaults& faults) const {
        std::map<std::size_t, std::vector<int>> saturated;
        for_each([&](std::size_t pair, int bin, float value) {
            if (value == ceiling_) saturated[pair].push_back(bin);
        });
        for (const auto& [pair, bins] : saturated) {
            if (2 * static_cast<int>(bins.size()) > capture_.observed_range(pair).size()) {
                faults.saturated_points.push_back(pair);
            } else {
                for (const int bin : bins) faults.saturated_bins.emplace_back(pair, bin);
            }
        }
    }

 private:
    /// Whether it is the most that 4, 8, 12, ... bits hold.
    static bool is_full_bits(float value) {
        const double steps = std::log2(static_cast<double>(value) + 1.0) / 4.0;
        return steps == std::round(steps);
    }

    /// How far below the ceiling noise still makes values common.
    float below_ceiling() const { return std::ceil(std::sqrt(std::max(ceiling_, 1.0F))); }

    template <class Use>
    void for_each(const Use& use) const {
        for (std::size_t pair = 0; pair < capture_.transient.num_pairs(); ++pair) {
            int bin = capture_.observed_range(pair).begin;
            for (const float value : capture_.observed_values(pair)) use(pair, bin++, value);
        }
    }

    const core::Capture& capture_;
    float ceiling_ = 0.0F;
    std::size_t num_bins_ = 0;
    std::size_t num_at_ceiling_ = 0;
    std::size_t num_in_runs_ = 0;  ///< of these, behind two others
    std::size_t num_below_ = 0;
};

}  // namespace

void find_saturated(const core::Capture& capture, CaptureFaults& faults) {
    if (const SaturationFinder finder(capture); finder.is_saturated()) finder.find(faults);
}

}  // namespace nlos
