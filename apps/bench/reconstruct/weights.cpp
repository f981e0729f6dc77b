// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/reconstruct/reconstruct.h"
#include "apps/bench/reconstruct/reconstruct_trials.h"
#include "renderer/core/random.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/scene/ground_truth.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace apps {
namespace {

/// The same capture with this fraction of its points, drawn one by one.
core::Capture thinned(core::Capture capture, double observed, int seed) {
    core::Rng rng(1, static_cast<std::uint64_t>(seed), 0);
    std::vector<core::BinRange> ranges(capture.transient.num_pairs());
    for (core::BinRange& range : ranges) {
        if (rng.uniform() < observed) range.end = capture.time_axis.num_bins;
    }
    core::restrict_observed(capture, ranges);
    return capture;
}

/// Errors of the depths of one run [m], NaN where a true column was given none.
std::vector<double> errors_of(const core::Capture& capture,
                              const renderer::Scene& scene,
                              const std::string& weight) {
    const nlos::Reconstruction result =
        run_reconstruction(capture, {"method=solver", "solver.tv=" + weight}).result;
    const nlos::VolumeAxes& axes = result.volume.axes;
    const core::DepthMap truth =
        renderer::trace_depth_map(scene, axes.world_from_wall, axes.x_m, axes.y_m);
    std::vector<double> errors;
    for (std::size_t i = 0; i < truth.depth_m.size(); ++i) {
        if (!truth.is_foreground(i)) continue;
        errors.push_back(std::abs(result.depth.depth_m[i] - truth.depth_m[i]));
    }
    return errors;
}

/// Sums over true columns of what one weight found, beside what the default found.
struct WeightTally {
    std::size_t columns = 0;
    std::size_t found = 0;
    std::size_t both = 0;
    double error_m = 0.0;          // of those both found
    double default_error_m = 0.0;  // of the same columns

    void add(const std::vector<double>& errors, const std::vector<double>& default_errors) {
        columns += errors.size();
        for (std::size_t i = 0; i < errors.size(); ++i) {
            if (std::isnan(errors[i])) continue;
            ++found;
            if (std::isnan(default_errors[i])) continue;
            ++both;
            error_m += errors[i];
            default_error_m += default_errors[i];
        }
    }
    double found_fraction() const {
        return columns > 0 ? static_cast<double>(found) / static_cast<double>(columns) : 0.0;
    }
};

/// One signal level and fraction of points.
struct Search {
    double peak_counts = 0.0;
    double observed = 1.0;
    WeightTally own;                   // of the default
    std::vector<WeightTally> tallies;  // per weight
};

void add_surface(const RandomCapture& random,
                 int number,
                 const std::vector<double>& weights,
                 Search& search) {
    const core::Capture capture =
        thinned(search.peak_counts > 0.0 ? random_counts(random.capture, search.peak_counts, number)
                                         : random.capture,
                search.observed,
                number);
    const std::vector<double> errors = errors_of(capture, random.scene, "null");
    search.own.add(errors, errors);
    for (std::size_t w = 0; w < weights.size(); ++w) {
        search.tallies[w].add(errors_of(capture, random.scene, fmt::format("{}", weights[w])),
                              errors);
    }
}

/// The weight that the solver takes by itself against the best of a search.
core::Json row_of(const Search& search, const WeightsBenchSettings& settings) {
    double error_over_best = 0.0;
    double best_weight = 0.0;
    double best_found = 0.0;
    for (std::size_t w = 0; w < search.tallies.size(); ++w) {
        const WeightTally& tally = search.tallies[w];
        if (tally.both == 0 || tally.default_error_m < error_over_best * tally.error_m) continue;
        error_over_best = tally.default_error_m / tally.error_m;
        best_weight = settings.weights[w];
        best_found = tally.found_fraction();
    }
    return {{"peak_counts", search.peak_counts},  // expected in the brightest bin; 0: radiance
            {"observed", search.observed},        // fraction of the wall points
            {"captures", settings.surfaces},
            {"found",
             search.own.found_fraction()},  // fraction of true columns given a depth by default
            {"depth_mae_m",
             search.own.found > 0 ? fraction_of(search.own.error_m, search.own.found) : 0.0},
            {"best_weight", best_weight},  // of those tried, the one of least error
            {"best_found", best_found},    // as `found`, with it
            // The default's mean error over the best weight's, over the columns that both found.
            {"error_over_best", error_over_best}};
}

void declare_weights_bench(Command& command) {
    auto& settings = add_benchmark(command, measure_weights);
    add_setting(command, "--surfaces", settings.surfaces, "Random surfaces", {1, 10000});
    add_setting(command, "--first", settings.first, "Number of the first of them", {0, 1000000});
    add_setting(
        command, "--peaks", settings.peaks, "Counts in the brightest bin; 0: without noise");
    add_setting(command, "--observed", settings.observed, "Fractions of the wall points");
}

}  // namespace

BenchResult measure_weights(const WeightsBenchSettings& settings, const core::Progress& progress) {
    std::vector<Search> searches;
    for (const double observed : settings.observed) {
        for (const double peak : settings.peaks) {
            searches.push_back(
                {peak, observed, {}, std::vector<WeightTally>(settings.weights.size())});
        }
    }
    for (int number = 0; number < settings.surfaces; ++number) {
        const RandomCapture random = make_random_capture(settings.first + number);
        for (Search& search : searches) {
            progress.update(fraction_of(number, settings.surfaces), "surfaces");
            add_surface(random, number, settings.weights, search);
        }
    }
    core::Json rows = core::Json::array();
    for (const Search& search : searches) rows.push_back(row_of(search, settings));
    return {{{"searches", rows}}};
}

extern const CommandRow kWeightsBench{
    "weights",
    "The solver's own weight of total variation against the best of a search",
    "nlos bench weights -o out/bench --surfaces 1 --peaks 100 --observed 1",
    declare_weights_bench};

}  // namespace apps
