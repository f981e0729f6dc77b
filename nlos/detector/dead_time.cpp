// SPDX-License-Identifier: MIT
#include "nlos/detector/dead_time.h"

#include "nlos/detector/count_sampling.h"

#include <Eigen/SparseLU>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

/// Follows detectors through the last of several pulses.
///
/// history   detections in each bin of whole periods; those of the last period are filled in
/// detect    (detectors that can see, probability to detect) -> detections
template <class Detect>
void follow_pulse(const std::vector<double>& probabilities,
                  const PulseTrain& train,
                  double detectors,
                  std::vector<double>& history,
                  Detect&& detect) {
    const std::size_t period = probabilities.size();
    const std::size_t begin = history.size() - period;
    const std::size_t blind = train.blind_bins;
    double recent = 0.0;   // detections of the last `blind` bins
    double blocked = 0.0;  // earlier ones of this pulse that nothing may follow
    for (std::size_t i = begin - blind; i < begin; ++i) recent += history[i];
    for (std::size_t i = begin; i < history.size(); ++i) {
        const double seeing = std::max(0.0, detectors - recent - blocked);
        history[i] = detect(seeing, probabilities[i - begin]);
        const std::size_t expired = i - blind;
        recent += history[i] - history[expired];
        if (train.first_photon_only && expired >= begin) blocked += history[expired];
    }
}

/// Fills a history with what is exact for steady light: a detector sees with the probability
/// 1 / (1 + expected detections within a blind time). The closer to the steady state, the less
/// there is to forget; detectors that are blind in step with the pulses forget slowly.
void start_steadily(const std::vector<double>& probabilities,
                    std::size_t blind_bins,
                    std::vector<double>& history) {
    const std::size_t period = probabilities.size();
    double before = 0.0;  // probabilities of the last `blind_bins` bins
    for (std::size_t i = 0; i < blind_bins; ++i) before += probabilities[period - 1 - i % period];
    for (std::size_t i = 0; i < history.size(); ++i) {
        const std::size_t bin = i % period;
        history[i] = probabilities[bin] / (1.0 + before);
        const std::size_t expired =
            (bin + (blind_bins / period + 1) * period - blind_bins) % period;
        if (blind_bins > 0) before += probabilities[bin] - probabilities[expired];
    }
}

/// The same, where detectors that are blind in step with bright pulses would take very long to
/// forget their start: as linear equations. With s_i the probability to see in bin i, of detections
/// p_i s_i, and b = q periods + r bins of blindness,
///     s_(i+1) = s_i - p_i s_i + p_(i-r) s_(i-r)     what was detected is blind, what expires sees;
///     1 = s_0 + sum of the last b of p s            a detector that does not see has detected.
/// The band is narrow where detectors are in step: r is small or close to the period.
///
/// returns   detections in each bin of one period; empty where light is so bright that detectors
///           never forget, to rounding
std::vector<double> solve_steady_state(const std::vector<double>& probabilities,
                                       const PulseTrain& train) {
    constexpr double kRounding = 1e-9;
    const int period = static_cast<int>(probabilities.size());
    const int whole = static_cast<int>(train.blind_bins) / period;
    const int rest = static_cast<int>(train.blind_bins) % period;
    const auto p = [&](int bin) { return probabilities[static_cast<std::size_t>(bin)]; };
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i + 1 < period; ++i) {
        entries.emplace_back(i, i + 1, 1.0);
        entries.emplace_back(i, i, p(i) - 1.0);
        // After the first photon of a pulse nothing follows until the next.
        if (train.first_photon_only && whole == 0 && i >= rest) continue;
        const int expired = (i - rest + period) % period;
        entries.emplace_back(i, expired, -p(expired));
    }
    const int last = period - 1;
    entries.emplace_back(last, 0, 1.0);
    for (int i = 0; i < period; ++i) {
        entries.emplace_back(last, i, (whole + (i >= period - rest ? 1 : 0)) * p(i));
    }
    Eigen::SparseMatrix<double> equations(period, period);
    equations.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SparseLU<Eigen::SparseMatrix<double>> solver(equations);
    if (solver.info() != Eigen::Success) return {};
    const Eigen::VectorXd seeing = solver.solve(Eigen::VectorXd::Unit(period, last));
    if (!(seeing.minCoeff() > -kRounding && seeing.maxCoeff() < 1.0 + kRounding)) return {};
    std::vector<double> detections;
    for (int i = 0; i < period; ++i) detections.push_back(std::max(0.0, p(i) * seeing[i]));
    return detections;
}

/// Detections of one detector, per pulse, once its start is forgotten: a fixed point. Mixing each
/// step with the one before damps the swing of detectors that are blind in step.
std::vector<double> find_steady_state(const std::vector<double>& probabilities,
                                      const PulseTrain& train,
                                      std::size_t history_periods) {
    constexpr int kMaxSteps = 1000;      // from here on solving is quicker
    constexpr double kTolerance = 1e-9;  // of all detections
    const auto period = static_cast<std::ptrdiff_t>(probabilities.size());
    std::vector<double> history((history_periods + 1) * probabilities.size());
    start_steadily(probabilities, train.blind_bins, history);
    const auto keep_probability = [](double seeing, double p) { return seeing * p; };
    for (int step = 0; step < kMaxSteps; ++step) {
        if (step > 0) std::rotate(history.begin(), history.begin() + period, history.end());
        follow_pulse(probabilities, train, 1.0, history, keep_probability);
        if (train.blind_bins == 0) return history;
        double change = 0.0;
        double sum = 0.0;
        for (auto now = history.end() - period; now != history.end(); ++now) {
            const double before = *(now - period);
            change += std::abs(*now - before);
            sum += *now;
            *now = 0.5 * (*now + before);
        }
        if (change <= kTolerance * sum) return history;
    }
    const std::vector<double> solved = solve_steady_state(probabilities, train);
    if (solved.empty()) return history;
    for (std::size_t i = 0; i < history.size(); ++i) history[i] = solved[i % solved.size()];
    return history;
}

}  // namespace

std::vector<double> count_with_dead_time(std::span<const double> rates,
                                         const PulseTrain& train,
                                         core::Rng* rng) {
    std::vector<double> probabilities;
    for (const double rate : rates) probabilities.push_back(-std::expm1(-rate));
    probabilities.resize(rates.size() + train.gap_bins, -std::expm1(-train.gap_rate));
    const std::size_t period = probabilities.size();
    const std::size_t history_periods = (train.blind_bins + period - 1) / period;
    const auto bins = static_cast<std::ptrdiff_t>(rates.size());
    const auto pulses = static_cast<double>(train.pulses);

    std::vector<double> history = find_steady_state(probabilities, train, history_periods);
    const auto pulse_begin = history.end() - static_cast<std::ptrdiff_t>(period);
    if (rng == nullptr) {
        std::vector<double> counts(pulse_begin, pulse_begin + bins);
        for (double& count : counts) count *= pulses;
        return counts;
    }
    const auto draw = [&](double detectors, double probability) {
        return static_cast<double>(sample_binomial(
            *rng, static_cast<std::int64_t>(detectors), std::clamp(probability, 0.0, 1.0)));
    };
    // A detector that is blind when the pulse begins has detected once in the last `blind_bins`
    // bins: a draw of one of them, or of none. History ends one period before the drawn pulse.
    std::rotate(history.begin(),
                history.begin() + static_cast<std::ptrdiff_t>(history_periods > 0 ? period : 0),
                history.end());
    double undecided = pulses;
    double left = 1.0;
    for (auto before = pulse_begin - static_cast<std::ptrdiff_t>(train.blind_bins);
         before != pulse_begin;
         ++before) {
        const double fraction = *before;
        *before = left > 0.0 ? draw(undecided, fraction / left) : 0.0;
        undecided -= *before;
        left -= fraction;
    }
    follow_pulse(probabilities, train, pulses, history, draw);
    return {pulse_begin, pulse_begin + bins};
}

}  // namespace nlos
