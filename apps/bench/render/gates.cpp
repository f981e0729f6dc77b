// SPDX-License-Identifier: MIT
#include "apps/bench/render/gates.h"

#include "apps/bench/scene.h"
#include "apps/bench/statistics.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/parallel.h"
#include "renderer/core/system/process.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace apps {
namespace {

using renderer::Estimator;

constexpr double kGates_mm[] = {0.0, 1000.0, 300.0, 100.0, 30.0, 10.0, 3.0, 1.0};
constexpr double kRunSeconds = 0.3;       ///< of one measured run, about
constexpr double kReferenceFactor = 8.0;  ///< a reference takes this many runs
constexpr int kPilotSamples = 64;
constexpr std::uint64_t kReferenceSeed = 1'000'000;

// A method at work on one axis.
struct Case {
    const BenchScene& scene;
    core::TimeAxis axis;
    renderer::RenderSettings settings;
};

struct TimedCapture {
    core::Capture capture;
    double cpu_seconds = 0.0;
};

TimedCapture run(const Case& c, int samples, std::uint64_t seed) {
    renderer::RenderSettings settings = c.settings;
    settings.samples = samples;
    settings.seed = seed;
    const double start = core::cpu_seconds();
    TimedCapture timed{c.scene.render(c.axis, settings), 0.0};
    timed.cpu_seconds = core::cpu_seconds() - start;
    return timed;
}

// Samples that take about `seconds`.
int samples_for(const Case& c, double seconds) {
    const double pilot = std::max(1e-3, run(c, kPilotSamples, kReferenceSeed - 1).cpu_seconds);
    return static_cast<int>(std::clamp(kPilotSamples * seconds / pilot, 16.0, 1e7));
}

// Relative MSE times CPU seconds, which is what is left after one second.
struct Cost {
    Estimate all;
    Estimate trimmed;
};

Cost cost(const Case& c, const core::Capture& a, const core::Capture& b, int repeats) {
    const int samples = samples_for(c, kRunSeconds);
    std::vector<double> all;
    std::vector<double> trimmed;
    for (int i = 0; i < repeats; ++i) {
        const TimedCapture timed = run(c, samples, static_cast<std::uint64_t>(i));
        const ErrorSums errors = errors_of(timed.capture.transient, a.transient, b.transient);
        all.push_back(errors.rel_mse() * timed.cpu_seconds);
        trimmed.push_back(errors.trimmed_rel_mse() * timed.cpu_seconds);
    }
    return {estimate_of(all), estimate_of(trimmed)};
}

// How far renders of one case with different seeds lie apart.
class Spread {
 public:
    void add(const TimedCapture& run) {
        const core::Transient& values = run.capture.transient;
        sums_.resize(values.values().size());
        squares_.resize(sums_.size());
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            const double value = values.values()[i];
            sums_[i] += value;
            squares_[i] += value * value;
        }
        cpu_seconds_ += run.cpu_seconds;
        ++count_;
    }

    // Variance of all values together over the square of their means, after one CPU second.
    double relative_variance() const {
        double variance = 0.0;
        double signal = 0.0;
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            const double mean = sums_[i] / count_;
            const double of_one = (squares_[i] - count_ * mean * mean) / (count_ - 1.0);
            variance += of_one;
            signal += mean * mean - of_one / count_;
        }
        return variance / signal * cpu_seconds_ / count_;
    }

 private:
    std::vector<double> sums_, squares_;
    double cpu_seconds_ = 0.0;
    double count_ = 0.0;
};

// Length before which half of the signal arrives; with Exclusion::Drop, of that by way of surfaces
// that are not excluded.
double middle_of_signal_m(const BenchScene& scene, renderer::Exclusion exclude) {
    renderer::RenderSettings settings = scene.settings();
    settings.method = Estimator::Ellipsoidal;
    settings.exclude = exclude;
    settings.samples = kPilotSamples;
    return scene.axis().bin_center_m(bin_of_fraction(scene.render(settings), 0.5));
}

core::TimeAxis gate_axis(const BenchScene& scene, double center_m, double gate_mm) {
    if (gate_mm == 0.0) return scene.axis();
    return {center_m - 0.5e-3 * gate_mm, 1e-3 * gate_mm, 1};
}

// Where the gain of `ellipsoidal` passes 1, the histogram left out.
double crossing_mm(const std::vector<GateBench>& gates) {
    const GateBench* wider = nullptr;
    for (const GateBench& gate : gates) {
        if (gate.gate_mm == 0.0 || gate.method != "ellipsoidal") continue;
        if (wider != nullptr && (wider->gain > 1.0) != (gate.gain > 1.0)) {
            const double fraction = std::log(wider->gain) / std::log(wider->gain / gate.gain);
            return wider->gate_mm * std::pow(gate.gate_mm / wider->gate_mm, fraction);
        }
        wider = &gate;
    }
    return 0.0;
}

// Two independent long runs.
std::array<core::Capture, 2> references(const Case& c) {
    const int samples = samples_for(c, kReferenceFactor * kRunSeconds);
    return {run(c, samples, kReferenceSeed).capture, run(c, samples, kReferenceSeed + 1).capture};
}

std::vector<GateBench> bench_gate(Case c, double gate_mm, int repeats) {
    c.settings.method = Estimator::Ellipsoidal;
    const auto [a, b] = references(c);
    std::vector<GateBench> rows;
    Cost path;
    for (const Estimator method : {Estimator::Path, Estimator::Ellipsoidal, Estimator::Restir}) {
        c.settings.method = method;
        const Cost found = cost(c, a, b, repeats);
        if (rows.empty()) path = found;
        const double gain = path.all.mean / found.all.mean;
        rows.push_back({gate_mm,
                        std::string(core::enum_name(method)),
                        found.all.mean,
                        gain,
                        gain * std::hypot(path.all.standard_error / path.all.mean,
                                          found.all.standard_error / found.all.mean),
                        path.trimmed.mean / found.trimmed.mean});
    }
    return rows;
}

}  // namespace

GateTable bench_gates(const std::string& scene_path,
                      int max_bounces,
                      int repeats,
                      const core::Progress& progress) {
    const BenchScene scene(scene_path);
    const core::ThreadLimit one_thread(1);
    renderer::RenderSettings settings = scene.settings();
    if (max_bounces > 0) settings.max_bounces = max_bounces;
    GateTable table{scene_path,
                    settings.max_bounces,
                    middle_of_signal_m(scene, renderer::Exclusion::None),
                    {},
                    0.0};
    double done = 0.0;
    for (const double gate_mm : kGates_mm) {
        progress.update(done++ / std::size(kGates_mm), "gates");
        const Case c{scene, gate_axis(scene, table.center_m, gate_mm), settings};
        const auto rows = bench_gate(c, gate_mm, repeats);
        table.gates.insert(table.gates.end(), rows.begin(), rows.end());
    }
    table.crossing_mm = crossing_mm(table.gates);
    return table;
}

void bench_exclusion(const std::string& scene_path, int repeats, core::Json& rows) {
    using renderer::Exclusion;
    constexpr std::array kModes{Exclusion::None, Exclusion::Mis, Exclusion::Drop};
    const BenchScene scene(scene_path);
    const core::ThreadLimit one_thread(1);
    const double all_m = middle_of_signal_m(scene, Exclusion::None);
    const double kept_m = middle_of_signal_m(scene, Exclusion::Drop);
    for (const int max_bounces : {3, 5}) {
        for (const auto& [gate_mm, center_m] :
             {std::pair{0.0, all_m}, std::pair{10.0, all_m}, std::pair{10.0, kept_m}}) {
            Case c{scene, gate_axis(scene, center_m, gate_mm), scene.settings()};
            c.settings.method = Estimator::Ellipsoidal;
            c.settings.max_bounces = max_bounces;
            const int samples = samples_for(c, kRunSeconds);
            std::array<Spread, kModes.size()> spreads;
            // In turns: what else the machine does slows all of them.
            for (int i = 0; i < std::max(2, repeats); ++i) {
                for (std::size_t mode = 0; mode < kModes.size(); ++mode) {
                    c.settings.exclude = kModes[mode];
                    spreads[mode].add(run(c, samples, static_cast<std::uint64_t>(i)));
                }
            }
            for (std::size_t mode = 0; mode < kModes.size(); ++mode) {
                const double variance = spreads[mode].relative_variance();
                rows.push_back(
                    {{"scene", scene_path},
                     {"mode", core::write_value(kModes[mode])},  // what becomes of them
                     {"max_bounces", max_bounces},
                     {"gate_mm", gate_mm},            // width in path length; 0: the histogram
                     {"center_m", center_m},          // of the gate in path length
                     {"variance_seconds", variance},  // relative to the squared signal
                     {"gain", spreads[0].relative_variance() / variance}});  // over mode none
            }
        }
    }
}

}  // namespace apps
