// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/track/simulated_walk.h"
#include "apps/commands.h"
#include "calib/track/compare_tracks.h"
#include "calib/track/target_state.h"
#include "calib/track/tracker.h"
#include "renderer/core/parallel.h"
#include "renderer/core/stopwatch.h"

#include <fmt/core.h>

#include <cmath>
#include <vector>

namespace apps {
namespace {

/// What `nlos bench track` is to measure.
struct TrackBenchSettings {
    int walks = 50;               ///< trajectories of each row
    int empty_walks = 20;         ///< of a scene without a target
    double systematic_m = 0.002;  ///< see calib::NoiseSettings
};

calib::TrackSettings settings_for(const SimulatedWalk& walk, double systematic_m) {
    calib::TrackSettings settings;
    settings.noise.systematic_m = systematic_m;
    settings.pose = walk.sensor.setup->pose;
    return settings;
}

std::vector<calib::TrackedFrame> named(const std::vector<calib::FrameEstimate>& estimates,
                                       const calib::TrackSettings& settings) {
    std::vector<calib::TrackedFrame> frames;
    for (const calib::FrameEstimate& estimate : estimates) {
        calib::TrackedFrame frame;
        frame.time_s = estimate.time_s;
        frame.is_learning = estimate.is_learning;
        for (const calib::TargetEstimate& target : estimate.targets) {
            if (!target.is_named) continue;
            frame.targets.push_back(
                {target.state.position_m(), calib::stated_covariance_m2(target, settings)});
        }
        frames.push_back(std::move(frame));
    }
    return frames;
}

/// Sums of squares of the bound of positions, filtered and smoothed, over the frames of walks.
struct Bound {
    double filtered_m2 = 0.0;
    double smoothed_m2 = 0.0;
    std::size_t frames = 0;
};

/// What a sensor counts on average without a target.
std::vector<double> background_of(const SimulatedWalk& walk) {
    std::vector<double> background(walk.frames.front().counts.size(), 0.0);
    int empty = 0;
    for (std::size_t f = 0; f < walk.frames.size(); ++f) {
        if (!walk.truth[f].targets.empty()) continue;
        for (std::size_t i = 0; i < background.size(); ++i) {
            background[i] += walk.frames[f].counts[i];
        }
        ++empty;
    }
    for (double& value : background) value = std::max(value / empty, 1e-3);
    return background;
}

/// Posterior Cramer-Rao bound along the true way: covariances as the filter would have them with
/// the Fisher information there, and smoothed.
void add_bound(const SimulatedWalk& walk, const calib::TrackSettings& settings, Bound& sum) {
    const std::vector<double> background = background_of(walk);
    // What the direct return drowns says nothing.
    std::vector<double> weights;
    for (const double count : background) weights.push_back(count < 1e3 ? 1.0 : 0.0);
    std::vector<calib::SeenMatrix> information;
    for (std::size_t f = 0; f < walk.frames.size(); ++f) {
        if (walk.truth[f].targets.empty()) continue;
        const core::SensorFootprints footprints =
            calib::footprints_at(walk.sensor, *walk.frames[f].pose);
        const calib::TargetResponse response =
            calib::response_at(walk.sensor, footprints, settings.target);
        calib::SeenVector seen;
        seen << walk.truth[f].targets.front().position_m, std::log(walk.retro_strength);
        information.push_back(calib::fisher_information(
            response, {walk.frames[f].counts, background, weights}, seen));
    }
    calib::SeenMatrix wide = calib::SeenMatrix::Identity();
    wide(3, 3) = 9.0;
    const calib::TrackBound bound =
        calib::track_bound(information, wide, calib::Motion(settings.motion), walk.sensor.frame_s);
    for (const double square : bound.filtered_m2) sum.filtered_m2 += square;
    for (const double square : bound.smoothed_m2) sum.smoothed_m2 += square;
    sum.frames += information.size();
}

/// What a set of walks gave: as they came, and smoothed.
struct Tally {
    calib::TrackScorer live;
    calib::TrackScorer smoothed;
    Bound bound;
    double seconds = 0.0;
    double slowest_s = 0.0;
    int frames = 0;

    void add(const SimulatedWalk& walk, double systematic_m) {
        const calib::TrackSettings settings = settings_for(walk, systematic_m);
        calib::Tracker tracker(settings, walk.sensor);
        std::vector<calib::FrameEstimate> estimates;
        for (const calib::TrackFrame& frame : walk.frames) {
            const core::ThreadStopwatch watch;
            estimates.push_back(tracker.step(frame));
            const double spent = watch.seconds();
            seconds += spent;
            slowest_s = std::max(slowest_s, spent);
            ++frames;
        }
        live.add(named(estimates, settings), walk.truth, "walk");
        calib::smooth(estimates, settings);
        smoothed.add(named(estimates, settings), walk.truth, "walk");
        if (!walk.truth[walk.truth.size() / 2].targets.empty()) add_bound(walk, settings, bound);
    }

    core::Json row(const std::string& what, int walks, bool is_smoothed) const {
        const calib::TrackScores scores = (is_smoothed ? smoothed : live).scores();
        const double rmse_m = scores.rmse_m.value_or(0.0);
        // The root mean square of the bound, and the error over it; without a target there is none.
        const double square_m2 = is_smoothed ? bound.smoothed_m2 : bound.filtered_m2;
        const double bound_m =
            bound.frames > 0 ? std::sqrt(square_m2 / static_cast<double>(bound.frames)) : 0.0;
        return {{"what", what},
                {"walks", walks},
                {"rmse_m", rmse_m},
                {"coverage", scores.coverage.value_or(0.0)},
                {"missed", scores.missed.value_or(0.0)},
                {"false_alarms", scores.false_alarms.value_or(0.0)},
                {"latency_s", scores.latency_s.value_or(0.0)},
                {"bound_m", bound_m},
                {"over_bound", bound_m > 0.0 ? rmse_m / bound_m : 0.0},
                {"frames_per_s", seconds > 0.0 ? frames / seconds : 0.0},
                {"slowest_ms", 1e3 * slowest_s}};
    }
};

Tally tally(int walks, WalkSettings settings, double systematic_m, const core::Progress& progress) {
    Tally tally;
    core::parallel_in_order<SimulatedWalk>(
        static_cast<std::size_t>(walks),
        [&](std::size_t i) {
            WalkSettings one = settings;
            one.seed = settings.seed + i;
            return simulate_walk(one);
        },
        [&](std::size_t i, const SimulatedWalk& walk) {
            tally.add(walk, systematic_m);
            progress.update(share_of(i + 1, walks), "");
            return true;
        });
    return tally;
}

std::vector<Target> track_targets(const core::Json& rows) {
    const auto share = [](double value) { return fmt::format("{:.1f} %", 100.0 * value); };
    std::vector<Target> targets;
    for (const core::Json& row : rows) {
        const std::string what = row["what"];
        const auto figure = [&](const char* name) { return row[name].get<double>(); };
        if (figure("bound_m") == 0.0) {
            targets.push_back({"no target named: " + what,
                               "in 99 % of frames",
                               share(1.0 - figure("false_alarms")),
                               figure("false_alarms") <= 0.01});
            continue;
        }
        targets.push_back({"RMSE: " + what,
                           "6 cm",
                           fmt::format("{:.1f} cm", 100.0 * figure("rmse_m")),
                           figure("rmse_m") <= 0.06});
        targets.push_back({"95 % ellipsoids cover: " + what,
                           "92 to 98 %",
                           share(figure("coverage")),
                           figure("coverage") >= 0.92 && figure("coverage") <= 0.98});
        if (what.ends_with("smoothed")) {
            targets.push_back({"error over the Cramer-Rao bound: " + what,
                               "1.5",
                               fmt::format("{:.2f}", figure("over_bound")),
                               figure("over_bound") <= 1.5});
        } else {
            targets.push_back({"frames per second, one core: " + what,
                               "100",
                               fmt::format("{:.0f}", figure("frames_per_s")),
                               figure("frames_per_s") >= 100.0});
        }
    }
    return targets;
}

/// Tracks simulated walks and holds them against their truth, their stated covariance and the
/// recursive Cramer-Rao bound [Tichavsky1998], and measures speed on one core.
BenchResult measure_track(const TrackBenchSettings& settings, const core::Progress& progress) {
    core::Json rows = core::Json::array();
    WalkSettings walk;
    constexpr double kThird = 1.0 / 3.0;
    for (const bool moves : {true, false}) {
        walk.sensor_moves = moves;
        walk.seed = moves ? 1000 : 2000;
        const double begin = moves ? 0.0 : kThird;
        const core::Progress part = progress.part(begin, begin + kThird);
        const Tally done = tally(settings.walks, walk, settings.systematic_m, part);
        const std::string what = moves ? "sensor moves" : "sensor stands";
        rows.push_back(done.row(what, settings.walks, false));
        rows.push_back(done.row(what + ", smoothed", settings.walks, true));
    }
    walk.has_target = false;
    walk.seed = 3000;
    const core::Progress part = progress.part(2.0 * kThird, 1.0);
    rows.push_back(tally(settings.empty_walks, walk, settings.systematic_m, part)
                       .row("empty scene", settings.empty_walks, false));
    BenchResult result;
    result.figures["targets"] = core::write_value(track_targets(rows));
    result.figures["walks"] = rows;
    return result;
}

void declare_track(CLI::App& command, TrackBenchSettings& settings) {
    add_setting(command, "--walks", settings.walks, "Trajectories of each row", {1, 10000});
    add_setting(
        command, "--empty-walks", settings.empty_walks, "Scenes without a target", {1, 10000});
    add_setting(command,
                "--systematic-m",
                settings.systematic_m,
                "Error of the model stated beside those of counting [m]");
}

}  // namespace

void add_bench_track_command(CLI::App& bench) {
    add_benchmark<TrackBenchSettings>(bench,
                                      {"track",
                                       "Tracking with a cheap sensor against its targets",
                                       "nlos bench track -o out/bench --walks 2 --empty-walks 1"},
                                      declare_track,
                                      measure_track);
}

}  // namespace apps
