// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/reconstruct/reconstruct.h"
#include "apps/bench/reconstruct/reconstruct_trials.h"
#include "nlos/plots/plot.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/statistics.h"
#include "renderer/scene/ground_truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace apps {
namespace {

constexpr std::size_t kTenths = 10;

/// What surrounds a column of the truth.
enum class Surroundings { Surface, Both, Background };

Surroundings surroundings(const core::DepthMap& truth, std::size_t ix, std::size_t iy) {
    bool any_surface = false;
    bool any_background = false;
    for (std::size_t jx = ix - std::min<std::size_t>(ix, 1);
         jx < std::min(truth.x_m.size(), ix + 2);
         ++jx) {
        for (std::size_t jy = iy - std::min<std::size_t>(iy, 1);
             jy < std::min(truth.y_m.size(), iy + 2);
             ++jy) {
            const bool is_surface = truth.is_foreground(truth.index(jx, jy));
            any_surface = any_surface || is_surface;
            any_background = any_background || !is_surface;
        }
    }
    if (any_surface && any_background) return Surroundings::Both;
    return any_surface ? Surroundings::Surface : Surroundings::Background;
}

/// A fraction of many, counted.
struct Fraction {
    std::size_t hits = 0;
    std::size_t count = 0;

    void add(bool is_hit) {
        hits += is_hit ? 1 : 0;
        ++count;
    }
    double value() const {
        return count > 0 ? static_cast<double>(hits) / static_cast<double>(count) : 0.0;
    }
};

/// Columns of one method at one signal level.
struct DepthTally {
    Fraction within_68, within_95, inside_68, inside_95, found, wrong, wrong_apart;
    std::vector<double> sigmas_m, errors_m;

    void add_found(double error_m, double sigma_m, Surroundings around) {
        const bool in_68 = error_m <= sigma_m;
        const bool in_95 = error_m <= 1.96 * sigma_m;
        within_68.add(in_68);
        within_95.add(in_95);
        if (around == Surroundings::Surface) {
            inside_68.add(in_68);
            inside_95.add(in_95);
        }
        sigmas_m.push_back(sigma_m);
        errors_m.push_back(error_m);
    }
};

double median(const std::vector<double>& values) {
    return values.empty() ? 0.0 : core::upper_median(values);
}

/// Columns of one method by tenths of their probability.
struct ProbabilityTally {
    std::array<Fraction, kTenths> surface;
    std::array<double, kTenths> sum{};

    void add(double probability, bool is_surface) {
        const std::size_t tenth =
            std::min(kTenths - 1, static_cast<std::size_t>(probability * kTenths));
        surface[tenth].add(is_surface);
        sum[tenth] += probability;
    }
};

void tally(const nlos::Reconstruction& result,
           const core::DepthMap& truth,
           DepthTally& depths,
           ProbabilityTally& probabilities) {
    for (std::size_t ix = 0; ix < truth.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < truth.y_m.size(); ++iy) {
            const std::size_t i = truth.index(ix, iy);
            const Surroundings around = surroundings(truth, ix, iy);
            const bool has_depth = result.depth.is_foreground(i);
            probabilities.add(result.surface_probability[i], truth.is_foreground(i));
            if (!truth.is_foreground(i)) {
                depths.wrong.add(has_depth);
                if (around == Surroundings::Background) depths.wrong_apart.add(has_depth);
                continue;
            }
            depths.found.add(has_depth);
            if (!has_depth) continue;
            depths.add_found(std::abs(result.depth.depth_m[i] - truth.depth_m[i]),
                             result.depth_sigma_m[i],
                             around);
        }
    }
}

/// Whether reported deviations of depth hold, at one signal level.
core::Json row_of(const std::string& method,
                  double peak_counts,
                  int captures,
                  const DepthTally& tally) {
    return {{"method", method},
            {"peak_counts", peak_counts},  // expected in the brightest bin
            {"captures", captures},
            {"columns", tally.errors_m.size()},      // of true surfaces that were given a depth
            {"within_68", tally.within_68.value()},  // fraction of them within one deviation
            {"within_95", tally.within_95.value()},  // within 1.96
            {"inside_68", tally.inside_68.value()},  // of columns that only surface surrounds
            {"inside_95", tally.inside_95.value()},
            {"median_sigma_m", median(tally.sigmas_m)},
            {"median_error_m", median(tally.errors_m)},
            {"found", tally.found.value()},  // fraction of true columns given a depth
            {"wrong", tally.wrong.value()},  // fraction of background columns given one
            {"wrong_apart", tally.wrong_apart.value()}};  // of those that no true column touches
}

/// How many of the columns with a reported probability within a tenth are surface, over all signal
/// levels.
void add_rows(const std::string& method, const ProbabilityTally& tally, core::Json& rows) {
    for (std::size_t tenth = 0; tenth < kTenths; ++tenth) {
        const Fraction& surface = tally.surface[tenth];
        if (surface.count == 0) continue;
        rows.push_back({{"method", method},
                        {"from", static_cast<double>(tenth) / kTenths},
                        {"columns", surface.count},
                        {"stated", fraction_of(tally.sum[tenth], surface.count)},  // on average
                        {"surface", surface.value()}});
    }
}

/// What is reported against what is true, with the line where both are equal.
nlos::Plot probability_plot(const core::Json& rows) {
    nlos::Plot plot{"Columns that are surface", "reported probability", "true fraction", {}};
    plot.x_scale = nlos::AxisScale::Linear;
    plot.y_scale = nlos::AxisScale::Linear;
    for (const core::Json& row : rows) {
        line_named(row["method"], plot).add(row["stated"], row["surface"]);
    }
    plot.lines.push_back({"as given", {0.0, 1.0}, {0.0, 1.0}, nlos::LineStyle::Limit});
    return plot;
}

/// Fraction of the depths within an interval over the signal, with the fraction that it reports.
nlos::Plot interval_plot(const core::Json& rows, const char* within, double reported) {
    nlos::Plot plot{fmt::format("Depths within their intervals of {:g} %", 100.0 * reported),
                    "counts in the brightest bin",
                    "fraction of the depths",
                    {}};
    plot.y_scale = nlos::AxisScale::Linear;
    nlos::PlotLine limit{"as given", {}, {}, nlos::LineStyle::Limit};
    for (const core::Json& row : rows) {
        line_named(row["method"], plot).add(row["peak_counts"], row[within]);
        if (row["method"] == rows.front()["method"]) limit.add(row["peak_counts"], reported);
    }
    plot.lines.push_back(limit);
    return plot;
}

void declare_coverage_bench(Command& command) {
    auto& settings = add_benchmark(command, measure_coverage);
    add_setting(command, "--surfaces", settings.surfaces, "Random surfaces", {1, 10000});
    add_setting(command, "--first", settings.first, "Number of the first of them", {0, 1000000});
    add_setting(command, "--methods", settings.methods, "Methods, each with its own settings");
    add_setting(command, "--peaks", settings.peaks, "Counts in the brightest bin");
}

}  // namespace

BenchResult measure_coverage(const CoverageBenchSettings& settings,
                             const core::Progress& progress) {
    const std::size_t num_peaks = settings.peaks.size();
    std::vector<DepthTally> depths(settings.methods.size() * num_peaks);
    std::vector<ProbabilityTally> probabilities(settings.methods.size());
    for (int number = 0; number < settings.surfaces; ++number) {
        progress.update(fraction_of(number, settings.surfaces), "surfaces");
        const RandomCapture random = make_random_capture(settings.first + number);
        for (std::size_t peak = 0; peak < num_peaks; ++peak) {
            const core::Capture counts =
                random_counts(random.capture, settings.peaks[peak], number);
            for (std::size_t m = 0; m < settings.methods.size(); ++m) {
                const nlos::Reconstruction result =
                    run_reconstruction(counts, {"method=" + settings.methods[m]}).result;
                const nlos::VolumeAxes& axes = result.volume.axes;
                const core::DepthMap truth = renderer::trace_depth_map(
                    random.scene, axes.world_from_wall, axes.x_m, axes.y_m);
                tally(result, truth, depths[m * num_peaks + peak], probabilities[m]);
            }
        }
    }
    core::Json depth_rows = core::Json::array();
    core::Json probability_rows = core::Json::array();
    for (std::size_t m = 0; m < settings.methods.size(); ++m) {
        for (std::size_t peak = 0; peak < num_peaks; ++peak) {
            depth_rows.push_back(row_of(settings.methods[m],
                                        settings.peaks[peak],
                                        settings.surfaces,
                                        depths[m * num_peaks + peak]));
        }
        add_rows(settings.methods[m], probabilities[m], probability_rows);
    }
    return {{{"depths", depth_rows}, {"probabilities", probability_rows}},
            {{"_probability", probability_plot(probability_rows)},
             {"_68", interval_plot(depth_rows, "within_68", 0.68)},
             {"_95", interval_plot(depth_rows, "within_95", 0.95)}},
            {}};
}

extern const CommandRow kCoverageBench{
    "coverage",
    "Whether reported deviations of depth and probabilities of surfaces hold",
    "nlos bench coverage -o out/bench --surfaces 1 --methods lct --peaks 100",
    declare_coverage_bench};

}  // namespace apps
