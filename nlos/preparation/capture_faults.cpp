// SPDX-License-Identifier: MIT
#include "nlos/preparation/capture_faults.h"

#include "nlos/preparation/histogram_preparation.h"
#include "nlos/preparation/saturated_bins.h"
#include "renderer/core/capture/masked_bins.h"
#include "renderer/core/statistics.h"
#include "renderer/core/system/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace nlos {
namespace {

constexpr std::size_t kFewestPairsForFaults = 25;
constexpr std::size_t kNeighbours = 8;
constexpr double kTimesNeighbours = 10.0;  // what they hold within the time that light may take
constexpr double kTimesTheirPeaks = 3.0;   // what they hold anywhere
constexpr double kMostFaultyPairs = 0.05;  // fraction of all pairs
constexpr double kMostNegativeFraction = 0.01;  // of all bins
constexpr int kManyBins = 32;                   // a point is hot with more than 1 / 32 of its bins
constexpr double kLitNeighbours = 0.75;         // fraction of a dead point's
constexpr double kFalloffPower = 4.0;

/// What a pair's histogram holds.
struct PairLight {
    double peak = 0.0;
    double far_peak = 0.0;  ///< of values times range^4
    double sum = 0.0;
    bool is_observed = false;
    bool is_zero = true;
};

/// Looks at pairs and those nearest to them.
class FaultFinder {
 public:
    explicit FaultFinder(const core::Capture& capture)
        : capture_(capture), scan_(capture.scan.wall()), light_(scan_.num_pairs()) {
        core::parallel_for(light_.size(), [&](std::size_t pair) { light_[pair] = look_at(pair); });
        std::vector<double> peaks;
        std::vector<double> far_peaks;
        for (const PairLight& own : light_) {
            if (!own.is_observed) continue;
            peaks.push_back(own.peak);
            far_peaks.push_back(own.far_peak);
        }
        if (peaks.empty()) return;
        usual_peak_ = core::upper_median(std::move(peaks));
        usual_far_peak_ = core::upper_median(std::move(far_peaks));
    }

    /// Of the pairs that outshine most, hot bins and hot points.
    void find_hot(CaptureFaults& faults) {
        for (std::size_t pair = 0; pair < light_.size(); ++pair) {
            const PairLight& own = light_[pair];
            if (own.peak <= kTimesTheirPeaks * usual_peak_ &&
                own.far_peak <= kTimesTheirPeaks * usual_far_peak_) {
                continue;
            }
            if (!dark_) dark_ = dark_light();
            const std::vector<int> bins = hot_bins_of(pair);
            if (static_cast<int>(bins.size()) > capture_.time_axis.num_bins / kManyBins) {
                faults.hot_points.push_back(pair);
            } else {
                for (const int bin : bins) faults.hot_bins.emplace_back(pair, bin);
            }
        }
    }

    void find_dead(CaptureFaults& faults) const {
        const auto zeros =
            std::ranges::count_if(light_, [](const PairLight& own) { return is_dark(own); });
        if (static_cast<double>(zeros) > kMostFaultyPairs * static_cast<double>(light_.size())) {
            return;
        }
        for (std::size_t pair = 0; pair < light_.size(); ++pair) {
            if (is_dark(light_[pair]) && is_dead(pair)) faults.dead_points.push_back(pair);
        }
    }

 private:
    static bool is_dark(const PairLight& own) { return own.is_observed && own.is_zero; }

    /// Range of a bin, at least what the shorter segment of its path may be [m].
    double range_m(std::size_t pair, int bin) const {
        const double apart = (scan_.illumination_point(pair) - scan_.sensing_point(pair)).norm();
        const double length =
            capture_.time_axis.bin_center_m(bin) - scan_.device_segments_m(pair) - apart;
        return std::max(0.5 * length, 0.5 * capture_.time_axis.bin_width_m);
    }

    PairLight look_at(std::size_t pair) const {
        PairLight own;
        const core::BinRange seen = capture_.observed_range(pair);
        own.is_observed = seen.size() > 0;
        int bin = seen.begin;
        for (const float value : capture_.observed_values(pair)) {
            const double light = value;
            own.sum += light;
            own.peak = std::max(own.peak, light);
            if (light > 0.0) {
                own.far_peak =
                    std::max(own.far_peak, light * std::pow(range_m(pair, bin), kFalloffPower));
            }
            own.is_zero = own.is_zero && value == 0.0F;
            ++bin;
        }
        return own;
    }

    /// The observed pairs of the same illumination whose sensing points are nearest.
    std::vector<std::size_t> neighbours_of(std::size_t pair) const {
        const std::size_t own = scan_.sensing_index(pair);
        const std::size_t first = pair - own;
        std::vector<std::size_t> near;
        const auto add = [&](std::size_t s) {
            if (s != own && light_[first + s].is_observed) near.push_back(first + s);
        };
        const auto grid = scan_.sensing.grid.value_or(std::array<std::size_t, 2>{0, 0});
        if (std::min(grid[0], grid[1]) < 3) {
            for (std::size_t s = 0; s < scan_.sensing.size(); ++s) add(s);
        } else {
            const std::size_t ix = std::clamp<std::size_t>(own / grid[1], 1, grid[0] - 2);
            const std::size_t iy = std::clamp<std::size_t>(own % grid[1], 1, grid[1] - 2);
            for (std::size_t x = ix - 1; x <= ix + 1; ++x) {
                for (std::size_t y = iy - 1; y <= iy + 1; ++y) add(x * grid[1] + y);
            }
        }
        if (near.size() > kNeighbours) {
            std::ranges::nth_element(near, near.begin() + kNeighbours, {}, [&](std::size_t other) {
                return distance_m(pair, other);
            });
            near.resize(kNeighbours);
        }
        return near;
    }

    double distance_m(std::size_t a, std::size_t b) const {
        return (scan_.sensing_point(a) - scan_.sensing_point(b)).norm();
    }

    /// The most that a neighbour may hold of the light of a bin; without end where its gate hides
    /// some.
    double neighbours_light(std::size_t pair, int bin, std::size_t other) const {
        const double distance = distance_m(pair, other);
        const double segments = scan_.device_segments_m(other) - scan_.device_segments_m(pair);
        const double step = (scan_.is_confocal() ? 2.0 : 1.0) * distance;
        const double per_bin = 1.0 / capture_.time_axis.bin_width_m;
        const core::BinRange near =
            core::intersection({bin - 1 + static_cast<int>(std::floor((segments - step) * per_bin)),
                                bin + 2 + static_cast<int>(std::ceil((segments + step) * per_bin))},
                               {0, capture_.time_axis.num_bins});
        if (core::intersection(near, capture_.observed_range(other)) != near) {
            return std::numeric_limits<double>::infinity();
        }
        const auto histogram = capture_.transient.histogram(other);
        double most = 0.0;
        for (int i = near.begin; i < near.end; ++i) {
            most = std::max(most, static_cast<double>(histogram[static_cast<std::size_t>(i)]));
        }
        const double by_chance = std::min(most, dark_->most_by_chance[other]);
        const double nearer = std::pow(1.0 + distance / range_m(pair, bin), 8.0);
        return dark_->photon + by_chance + (most - by_chance) * nearer;
    }

    /// What bins hold without light of the scene.
    struct DarkLight {
        double photon = 0.0;
        std::vector<double> most_by_chance;  ///< per pair; 5 deviations, of few photons 5 of them
    };
    DarkLight dark_light() const {
        const auto signal = find_signal(capture_.transient, capture_.observed, capture_.unit);
        DarkLight dark{capture_.unit == core::TransientUnit::Counts ? 1.0 : 0.0, {}};
        if (!signal) {
            dark.most_by_chance.resize(light_.size(), 0.0);
            return dark;
        }
        dark.photon = signal->photon;
        for (const double ambient : signal->ambient_per_bin) {
            const double mean = std::max(0.0, ambient);
            dark.most_by_chance.push_back(mean + 5.0 * std::sqrt(mean * dark.photon) +
                                          5.0 * dark.photon);
        }
        return dark;
    }

    /// All bins of a hot point, or some, of a pair.
    std::vector<int> hot_bins_of(std::size_t pair) const {
        const std::vector<std::size_t> near = neighbours_of(pair);
        if (near.empty()) return {};
        double peak = 0.0;
        double far_peak = 0.0;
        for (const std::size_t other : near) {
            peak = std::max(peak, light_[other].peak);
            far_peak = std::max(far_peak, light_[other].far_peak);
        }
        if (!(peak > 0.0)) return {};  // nothing to be held against
        const core::BinRange seen = capture_.observed_range(pair);
        const auto histogram = capture_.transient.histogram(pair);
        std::vector<int> hot;
        std::vector<int> bright;  // brighter than all that the neighbours hold
        for (int bin = seen.begin; bin < seen.end; ++bin) {
            const double value = histogram[static_cast<std::size_t>(bin)];
            if (value > peak) bright.push_back(bin);
            const double far_value = value * std::pow(range_m(pair, bin), kFalloffPower);
            if (value <= kTimesTheirPeaks * peak && far_value <= kTimesTheirPeaks * far_peak) {
                continue;
            }
            double light = 0.0;
            for (const std::size_t other : near) {
                light = std::max(light, neighbours_light(pair, bin, other));
            }
            if (value > kTimesNeighbours * light) hot.push_back(bin);
        }
        return 2 * static_cast<int>(bright.size()) > seen.size() ? bright : hot;
    }

    bool is_dead(std::size_t pair) const {
        const std::vector<std::size_t> near = neighbours_of(pair);
        std::vector<double> sums;
        for (const std::size_t other : near) {
            if (light_[other].sum > 0.0) sums.push_back(light_[other].sum);
        }
        if (sums.empty() ||
            static_cast<double>(sums.size()) < kLitNeighbours * static_cast<double>(near.size())) {
            return false;
        }
        // Where light fades towards a shadow or the end of the axis, the next pair may well be
        // dark.
        constexpr double kEven = 0.3;
        const auto [least, most] = std::ranges::minmax(sums);
        if (least < kEven * most) return false;
        // As many photons as leave any of the pairs dark once in a thousand captures.
        return capture_.unit != core::TransientUnit::Counts ||
               least > std::log(1e3 * static_cast<double>(light_.size()));
    }

    const core::Capture& capture_;
    const core::WallScan& scan_;
    std::vector<PairLight> light_;
    double usual_peak_ = 0.0;
    double usual_far_peak_ = 0.0;
    std::optional<DarkLight> dark_;
};

void find_negative(const core::Capture& capture, CaptureFaults& faults) {
    if (capture.unit != core::TransientUnit::Counts) return;
    const auto values = capture.transient.values();
    const auto most =
        static_cast<std::size_t>(kMostNegativeFraction * static_cast<double>(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!(values[i] < 0.0F)) continue;
        faults.negative_bins.emplace_back(i / capture.transient.num_bins(),
                                          static_cast<int>(i % capture.transient.num_bins()));
        if (faults.negative_bins.size() > most) break;
    }
    if (faults.negative_bins.size() > most) faults.negative_bins.clear();
}

bool is_many(std::size_t count, const core::Capture& capture) {
    return static_cast<double>(count) >
           kMostFaultyPairs * static_cast<double>(capture.scan.num_pairs());
}

std::string plural(std::size_t count, const char* kind) {
    return fmt::format("{} {}{}", count, kind, count == 1 ? "" : "s");
}

/// As in `2 hot bins (bin 5 of point 3, bin 9 of point 3)`, none of nothing.
template <class Item, class Name>
void append_items(const std::vector<Item>& items,
                  const char* kind,
                  const Name& name,
                  std::string& text) {
    constexpr std::size_t kMostListed = 4;
    if (items.empty()) return;
    std::string list;
    for (std::size_t i = 0; i < std::min(kMostListed, items.size()); ++i) {
        list += (i > 0 ? ", " : "") + name(items[i]);
    }
    if (items.size() > kMostListed) list += ", ...";
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", plural(items.size(), kind), list);
}

}  // namespace

CaptureFaults find_faults(const core::Capture& capture) {
    CaptureFaults faults;
    find_negative(capture, faults);
    find_saturated(capture, faults);
    if (!capture.scan.has_wall() || capture.scan.num_pairs() < kFewestPairsForFaults) return faults;
    FaultFinder finder(capture);
    finder.find_hot(faults);
    if (is_many(faults.hot_bins.size() + faults.hot_points.size(), capture)) {
        faults.hot_bins.clear();
        faults.hot_points.clear();
    }
    finder.find_dead(faults);
    std::erase_if(faults.saturated_bins, [&](const CaptureFaults::PairBin& bin) {
        return std::ranges::binary_search(faults.hot_bins, bin);
    });
    std::erase_if(faults.saturated_points, [&](std::size_t pair) {
        return std::ranges::binary_search(faults.hot_points, pair);
    });
    return faults;
}

core::Capture leave_out(const CaptureFaults& faults, const core::Capture& capture) {
    core::MaskedBins masked;
    for (const auto* bins : {&faults.hot_bins, &faults.saturated_bins, &faults.negative_bins}) {
        for (const auto& [pair, bin] : *bins) masked[pair].push_back(bin);
    }
    for (auto& [pair, bins] : masked) std::ranges::sort(bins);
    for (const auto* points : {&faults.hot_points, &faults.saturated_points, &faults.dead_points}) {
        for (const std::size_t pair : *points) {
            std::vector<int>& bins = masked[pair];
            bins.resize(static_cast<std::size_t>(capture.time_axis.num_bins));
            std::iota(bins.begin(), bins.end(), 0);
        }
    }
    core::Capture mended = capture;
    core::leave_out_bins(masked, mended);
    return mended;
}

std::optional<std::string> describe(const CaptureFaults& faults) {
    if (faults.empty()) return std::nullopt;
    std::string text;
    const auto bin_name = [](const CaptureFaults::PairBin& item) {
        return fmt::format("bin {} of point {}", item.second, item.first);
    };
    const auto point_name = [](std::size_t pair) { return fmt::format("{}", pair); };
    append_items(faults.hot_points, "hot point", point_name, text);
    append_items(faults.saturated_points, "saturated point", point_name, text);
    append_items(faults.dead_points, "dead point", point_name, text);
    append_items(faults.hot_bins, "hot bin", bin_name, text);
    append_items(faults.saturated_bins, "saturated bin", bin_name, text);
    append_items(faults.negative_bins, "negative bin", bin_name, text);
    return fmt::format(
        "left out, as no light explains them: {}; capture.mask_points and "
        "capture.mask_bins leave out others",
        text);
}

}  // namespace nlos
