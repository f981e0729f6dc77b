// SPDX-License-Identifier: MIT
#include "apps/bench/reconstruct/weights.h"

#include "apps/bench/command.h"
#include "apps/bench/reconstruct/random_capture.h"
#include "apps/commands.h"
#include "nlos/reconstruct.h"
#include "renderer/core/random.h"
#include "renderer/scene/ground_truth.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace apps {
namespace {

/// The same capture with this share of its points, drawn one by one.
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
                              const std::vector<std::string>& overrides) {
    nlos::ReconstructSettings settings;
    core::apply_override(settings, "method=solver");
    for (const std::string& text : overrides) core::apply_override(settings, text);
    const nlos::Reconstruction result = nlos::reconstruct(capture, settings, {});
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
    std::size_t found = 0;
    std::size_t both = 0;
    double error_m = 0.0;          // of those both found
    double default_error_m = 0.0;  // of the same columns

    void add(const std::vector<double>& errors, const std::vector<double>& default_errors) {
        for (std::size_t i = 0; i < errors.size(); ++i) {
            if (std::isnan(errors[i])) continue;
            ++found;
            if (std::isnan(default_errors[i])) continue;
            ++both;
            error_m += errors[i];
            default_error_m += default_errors[i];
        }
    }
};

WeightSearch search(const WeightsBenchSettings& settings, double peak_counts, double observed) {
    core::ScanPattern pattern{};
    core::read_value(settings.pattern, "--pattern", pattern);
    std::vector<WeightTally> tallies(settings.weights.size());
    WeightTally own;
    std::size_t num_columns = 0;
    for (int number = 0; number < settings.surfaces; ++number) {
        const RandomCapture random = make_random_capture(settings.first + number, pattern);
        const core::Capture capture = thinned(
            peak_counts > 0.0 ? random_counts(random.capture, peak_counts, number) : random.capture,
            observed,
            number);
        const std::vector<double> errors = errors_of(capture, random.scene, {});
        num_columns += errors.size();
        own.add(errors, errors);
        for (std::size_t w = 0; w < tallies.size(); ++w) {
            const std::string weight = fmt::format("solver.tv={}", settings.weights[w]);
            tallies[w].add(errors_of(capture, random.scene, {weight}), errors);
        }
    }
    const auto share = [](double part, std::size_t whole) {
        return whole > 0 ? part / static_cast<double>(whole) : 0.0;
    };
    WeightSearch result;
    result.peak_counts = peak_counts;
    result.observed = observed;
    result.captures = settings.surfaces;
    result.found = share(static_cast<double>(own.found), num_columns);
    result.depth_mae_m = share(own.error_m, own.both);
    for (std::size_t w = 0; w < tallies.size(); ++w) {
        const WeightTally& tally = tallies[w];
        if (tally.both == 0 || tally.default_error_m < result.error_over_best * tally.error_m) {
            continue;
        }
        result.error_over_best = tally.default_error_m / tally.error_m;
        result.best_weight = settings.weights[w];
        result.best_found = share(static_cast<double>(tally.found), num_columns);
    }
    return result;
}

void declare_weights(CLI::App& command, WeightsBenchSettings& settings) {
    add_setting(command, "--surfaces", settings.surfaces, "Random surfaces", {1, 10000});
    add_setting(command, "--first", settings.first, "Number of the first of them", {0, 1000000});
    add_setting(command, "--pattern", settings.pattern, "Scan: single, confocal or exhaustive");
    add_setting(
        command, "--peaks", settings.peaks, "Counts in the brightest bin; 0: without noise");
    add_setting(command, "--observed", settings.observed, "Shares of the wall points");
    add_setting(command, "--weights", settings.weights, "Values of solver.tv to search");
}

}  // namespace

WeightsBench search_weights(const WeightsBenchSettings& settings, const core::Progress& progress) {
    WeightsBench bench;
    const std::size_t num_searches = settings.peaks.size() * settings.observed.size();
    for (const double observed : settings.observed) {
        for (const double peak : settings.peaks) {
            if (progress.should_stop()) throw core::Failure("bench", "interrupted");
            progress.update(
                static_cast<double>(bench.searches.size()) / static_cast<double>(num_searches),
                "searches");
            bench.searches.push_back(search(settings, peak, observed));
        }
    }
    return bench;
}

void add_bench_weights_command(CLI::App& bench) {
    add_benchmark<WeightsBenchSettings>(
        bench,
        {"weights",
         "The solver's own weight of total variation against the best of a search",
         "nlos bench weights -o out/bench --surfaces 1 --peaks 100 --observed 1"},
        declare_weights,
        [](const WeightsBenchSettings& settings, const core::Progress& progress) {
            return BenchResult{core::write_value(search_weights(settings, progress))};
        });
}

}  // namespace apps
