// SPDX-License-Identifier: MIT
#include "nlos/solver/confocal_problem.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

constexpr int kWindowParts = 64;             // of the axis: light begins and ends within one
constexpr double kSmallestLight = 1e-4;      // of the brightest part
constexpr double kSignificance = 5.0;        // standard deviations of counts
constexpr double kSmallestIntensity = 0.02;  // of the brightest bin: what a bin's noise is at least
constexpr double kFarthestNeighbour = 4.0;   // points to the next that was observed

// A larger unit makes the solver's penalties smaller against the likelihood. The more a response
// smears, the less the data say of single voxels, and the longer large penalties hold these back.
// Scatterers beside the footprint cost their square by them, and must not come too cheap.
// Under a wide spot, too weak penalties gather light in few voxels.
constexpr double kConfinedUnitPower = 3.5;
constexpr double kSpotUnitPower = 2.0;
constexpr double kUnitPower = 1.0;
constexpr double kWideSpot = 2.4;  // full width at half maximum, in distances of wall points

/// Histograms of columns from the wall to the wall, cut to some bins.
class WallHistograms {
 public:
    WallHistograms(const MethodInput& input)
        : input_(input), shortest_segment_m_(core::device_segment_range_m(input.scan)[0]) {}

    core::TimeAxis axis() const {
        core::TimeAxis axis = input_.time_axis;
        axis.opl_start_m -= shortest_segment_m_;
        return axis;
    }

    /// Calls visit(bin, value) for every observed bin of a point; device segments that are no whole
    /// number of bins longer than the shortest split a value between two.
    template <class Visit>
    void visit(std::size_t pair, const Visit& visit) const {
        const core::BinRange seen = range(pair);
        const auto [whole, late] = shift(pair);
        const auto histogram = input_.transient.histogram(pair);
        for (int bin = seen.begin; bin < seen.end; ++bin) {
            const auto from = static_cast<std::size_t>(bin + whole);
            const float next = late > 0.0F ? late * histogram[from + 1] : 0.0F;
            visit(bin, (1.0F - late) * histogram[from] + next);
        }
    }

    /// The observed bins of a point on axis().
    core::BinRange range(std::size_t pair) const {
        const int num_bins = input_.time_axis.num_bins;
        core::BinRange seen =
            input_.observed ? (*input_.observed)[pair] : core::BinRange{0, num_bins};
        const auto [whole, late] = shift(pair);
        seen.begin -= whole;
        seen.end -= whole + (late > 0.0F ? 1 : 0);
        return seen.size() > 0 ? core::intersection(seen, {0, num_bins}) : core::BinRange{};
    }

 private:
    struct Shift {
        int whole;
        float late;
    };
    Shift shift(std::size_t pair) const {
        const double bins = (input_.scan.device_segments_m(pair) - shortest_segment_m_) /
                            input_.time_axis.bin_width_m;
        const double whole = std::floor(bins + 1e-3);
        const double late = bins - whole;
        return {static_cast<int>(whole), late > 1e-3 ? static_cast<float>(late) : 0.0F};
    }

    const MethodInput& input_;
    double shortest_segment_m_;
};

/// Light of all points per bin of their common axis.
struct TotalLight {
    std::vector<double> excess;        ///< over the background
    std::vector<double> sum, squares;  ///< of values, background included

    explicit TotalLight(std::size_t num_bins)
        : excess(num_bins), sum(num_bins), squares(num_bins) {}
};

TotalLight total_light(const MethodInput& input, const WallHistograms& histograms) {
    TotalLight total(static_cast<std::size_t>(input.time_axis.num_bins));
    for (std::size_t pair = 0; pair < input.scan.num_pairs(); ++pair) {
        const double background = input.measurement.background(pair);
        histograms.visit(pair, [&](int bin, float value) {
            const auto i = static_cast<std::size_t>(bin);
            total.excess[i] += static_cast<double>(value) - background;
            total.sum[i] += static_cast<double>(value);
            total.squares[i] += std::pow(static_cast<double>(value), 2);
        });
    }
    return total;
}

/// The bins of light, a part of the axis before and behind them included.
core::BinRange find_window(const MethodInput& input, const TotalLight& total, bool is_poisson) {
    const int num_bins = input.time_axis.num_bins;
    const int length = std::max(1, num_bins / kWindowParts);
    const int num_parts = (num_bins + length - 1) / length;
    std::vector<double> light(static_cast<std::size_t>(num_parts));
    std::vector<double> variance(light.size());  // of counts
    for (std::size_t i = 0; i < total.sum.size(); ++i) {
        const std::size_t part = i / static_cast<std::size_t>(length);
        light[part] += total.excess[i];
        variance[part] += std::max(0.0, total.sum[i]);
    }
    const double strongest = *std::ranges::max_element(light);
    core::BinRange window{num_bins, 0};
    for (int part = 0; part < num_parts; ++part) {
        const double own = light[static_cast<std::size_t>(part)];
        const double sigma = is_poisson ? std::sqrt(variance[static_cast<std::size_t>(part)]) : 0.0;
        if (own <= std::max(kSmallestLight * strongest, kSignificance * sigma)) continue;
        window.begin = std::min(window.begin, (part - 1) * length);
        window.end = (part + 2) * length;
    }
    if (window.end == 0) return {0, num_bins};
    window = core::intersection(window, {0, num_bins});
    // A few bins at least, that depths have neighbours.
    const int missing = std::max(0, std::min(num_bins, kMinBins) - window.size());
    window.begin = std::max(0, window.begin - missing);
    window.end = std::min(num_bins, std::max(window.end, window.begin + kMinBins));
    return window;
}

/// Standard deviation of the response, as range.
double response_deviation_m(const MethodInput& input) {
    double sum = 0.0;
    double squares = 0.0;
    double delay = 0.0;
    for (const double weight : input.measurement.response.weights) {
        sum += weight * delay;
        squares += weight * delay * delay;
        delay += 1.0;
    }
    return 0.5 * input.time_axis.bin_width_m * std::sqrt(std::max(0.0, squares - sum * sum));
}

/// margin_m   of ranges behind the axis, whose light a response brings into it
Cone make_window_cone(const MethodInput& input, const core::TimeAxis& axis, double margin_m) {
    const double begin = std::max(0.0, 0.5 * axis.opl_start_m);
    const double end = 0.5 * axis.opl_end_m() + margin_m;
    const double num_bins =
        std::ceil(kVBinsPerRangeBin * (end - begin) / (0.5 * axis.bin_width_m) - 1e-6);
    if (!(num_bins >= 4.0)) {
        throw core::Error("method",
                          "the solver was given light of fewer than 4 bins of positive range",
                          "method=bp works for any axis");
    }
    Cone cone;
    const WallGrid& grid = *input.wall.grid;
    cone.v_edges = even_edges(begin * begin, end * end, static_cast<std::size_t>(num_bins));
    cone.nx = grid.size[0];
    cone.ny = grid.size[1];
    cone.px = 2 * good_fft_size(cone.nx);
    cone.py = 2 * good_fft_size(cone.ny);
    cone.length = cone_period(cone, grid);
    return cone;
}

/// 1 / variance of counts as bright as those that hold most of the light.
std::vector<double> poisson_precision(const TotalLight& total, const core::BinRange& window) {
    std::vector<double> intensity;
    for (int bin = window.begin; bin < window.end; ++bin) {
        const auto i = static_cast<std::size_t>(bin);
        intensity.push_back(total.sum[i] > 0.0 ? total.squares[i] / total.sum[i] : 0.0);
    }
    const double floor = std::max(1e-12, kSmallestIntensity * *std::ranges::max_element(intensity));
    for (double& value : intensity) value = 1.0 / std::max(floor, value);
    return intensity;
}

/// Each bin's excess by its own noise, which background adds to.
double photons_per_point(const TotalLight& total,
                         const core::BinRange& window,
                         std::size_t num_points) {
    double photons = 0.0;
    for (int bin = window.begin; bin < window.end; ++bin) {
        const auto i = static_cast<std::size_t>(bin);
        if (total.sum[i] > 0.0) photons += std::pow(total.excess[i], 2) / total.sum[i] - 1.0;
    }
    return photons / static_cast<double>(num_points);
}

/// Standard deviation of light times range^power, from what interpolation between the nearest
/// observed points along y leaves: what no smooth scene explains. Light of a scene leaves the more,
/// the farther apart they are: a fraction in inverse proportion is what neighbours would have left.
/// Noise does not, and is taken for less than it is where few points were observed.
double interpolation_noise(const ConfocalProblem& data, double power) {
    const std::size_t ny = data.cone.ny;
    const auto num_bins = static_cast<std::size_t>(data.axis.num_bins);
    double sum = 0.0;  // of squares in units of those of independent noise
    double count = 0.0;
    double largest = 0.0;
    std::vector<std::size_t> seen;  // points of a row that observed a bin
    for (std::size_t ix = 0; ix < data.cone.nx; ++ix) {
        for (std::size_t bin = 0; bin < num_bins; ++bin) {
            const double range =
                0.5 * std::max(0.0, data.axis.bin_center_m(static_cast<double>(bin)));
            const double factor = std::pow(range, power);
            const float* row = data.values.data() + (ix * num_bins + bin) * ny;
            const auto light = [&](std::size_t iy) {
                return factor * static_cast<double>(row[iy]);
            };
            seen.clear();
            for (std::size_t iy = 0; iy < ny; ++iy) {
                if (!data.observed[ix * ny + iy].holds(static_cast<int>(bin))) continue;
                seen.push_back(iy);
                largest = std::max(largest, light(iy));
            }
            for (std::size_t i = 1; i + 1 < seen.size(); ++i) {
                const auto before = static_cast<double>(seen[i] - seen[i - 1]);
                const auto behind = static_cast<double>(seen[i + 1] - seen[i]);
                if (std::max(before, behind) > kFarthestNeighbour) continue;
                const double fraction = before / (before + behind);  // of the point behind
                const double expected =
                    (1.0 - fraction) * light(seen[i - 1]) + fraction * light(seen[i + 1]);
                const double distance = 0.5 * (before + behind);
                sum += std::pow((light(seen[i]) - expected) / distance, 2) /
                       (1.0 + fraction * fraction + (1.0 - fraction) * (1.0 - fraction));
                count += 1.0;
            }
        }
    }
    const double least = 1e-6 * largest;
    return std::max(count > 0.0 ? std::sqrt(sum / count) : 0.0, least > 0.0 ? least : 1.0);
}

std::vector<double> gaussian_precision(const ConfocalProblem& data, double power) {
    const double noise = interpolation_noise(data, power);
    std::vector<double> precision;
    for (int bin = 0; bin < data.axis.num_bins; ++bin) {
        const double range = 0.5 * std::max(0.0, data.axis.bin_center_m(bin));
        precision.push_back(std::pow(std::pow(range, power) / noise, 2));
    }
    const double least = 1e-12 * *std::ranges::max_element(precision);
    for (double& value : precision) value = std::max(least, value);
    return precision;
}

/// Where light of all points is, 1 / sqrt of what the precision makes of a unit of it.
double light_unit(const ConfocalProblem& data) {
    std::vector<float> total(static_cast<std::size_t>(data.axis.num_bins), 0.0F);
    for (std::size_t i = 0; i < data.values.size(); ++i) {
        total[i / data.cone.ny % total.size()] += std::max(0.0F, data.values[i]);
    }
    std::vector<float> weights(data.cone.num_v());
    data.time.apply_adjoint(total.data(), weights.data(), 1);
    const std::vector<double> diagonal = data.time.normal_diagonal(data.precision);
    double sum = 0.0;
    double mean = 0.0;
    for (std::size_t v = 0; v < diagonal.size(); ++v) {
        sum += static_cast<double>(weights[v]);
        mean += static_cast<double>(weights[v]) * diagonal[v];
    }
    return sum > 0.0 && mean > 0.0 ? std::sqrt(sum / mean) : 1.0;
}

}  // namespace

double num_observed_bins(const ConfocalProblem& data) {
    double count = 0.0;
    for (const core::BinRange& range : data.observed) count += range.size();
    return std::max(1.0, count);
}

double depth_blur(const MethodInput& input) {
    const auto& pitch = input.wall.grid->pitch_m;
    return response_deviation_m(input) / std::min(pitch[0], pitch[1]);
}

ConfocalProblem make_confocal_problem(const MethodInput& input,
                                      const ReconstructSettings& settings,
                                      bool is_confined) {
    const WallHistograms histograms(input);
    const double power = falloff_power(settings.falloff);
    Likelihood likelihood = settings.solver.likelihood;
    if (likelihood == Likelihood::Auto) {
        likelihood = input.measurement.is_counts ? Likelihood::Poisson : Likelihood::Gaussian;
    }
    const TotalLight total = total_light(input, histograms);
    const bool is_poisson = likelihood == Likelihood::Poisson;
    const core::BinRange window = find_window(input, total, is_poisson);
    core::TimeAxis axis = histograms.axis();
    axis.opl_start_m += window.begin * axis.bin_width_m;
    axis.num_bins = window.size();

    Cone cone = make_window_cone(input, axis, is_confined ? response_deviation_m(input) : 0.0);
    TimeOperator time(axis, cone.v_edges, power, input.measurement.response);
    ConfocalProblem data{std::move(cone), axis, {}, {}, {}, likelihood, {}, std::move(time)};
    const std::size_t ny = data.cone.ny;
    const auto num_bins = static_cast<std::size_t>(axis.num_bins);
    data.values.assign(data.cone.num_columns() * num_bins, 0.0F);
    for (std::size_t column = 0; column < data.cone.num_columns(); ++column) {
        const std::size_t pair = input.wall.grid->point(column / ny, column % ny);
        data.background_per_bin.push_back(static_cast<float>(input.measurement.background(pair)));
        const core::BinRange seen = core::intersection(histograms.range(pair), window);
        data.observed.push_back({seen.begin - window.begin, seen.end - window.begin});
        histograms.visit(pair, [&](int bin, float value) {
            if (!seen.holds(bin)) return;
            const auto t = static_cast<std::size_t>(bin - window.begin);
            data.values[(column / ny * num_bins + t) * ny + column % ny] = value;
        });
    }
    data.precision =
        is_poisson ? poisson_precision(total, window) : gaussian_precision(data, power);
    data.photons_per_point = photons_per_point(total, window, data.cone.num_columns());
    data.is_confined = is_confined;
    data.finds_background = is_confined && !settings.noise_floor;
    data.blur = std::max(1.0, depth_blur(input));
    const auto& pitch = input.wall.grid->pitch_m;
    data.is_under_spot = is_confined && settings.solver.spot_m.value_or(0.0) >
                                            kWideSpot * std::min(pitch[0], pitch[1]);
    data.unit = light_unit(data) * std::pow(data.blur,
                                            data.is_under_spot ? kSpotUnitPower
                                            : is_confined      ? kConfinedUnitPower
                                                               : kUnitPower);
    data.time.scale(data.unit);
    return data;
}

}  // namespace nlos
