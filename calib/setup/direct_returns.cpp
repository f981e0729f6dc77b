// SPDX-License-Identifier: MIT
#include "calib/setup/direct_returns.h"

#include "calib/setup/direct_return_checks.h"
#include "calib/statistics/poisson_deviance.h"
#include "calib/statistics/quiet_ceres.h"
#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/statistics.h"

#include <ceres/ceres.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

// A peak is looked at this many response widths around its highest bin.
constexpr double kWindow = 12.0;
constexpr double kMinMean = 1e-9;

// What all points share: [log sigma, log tail, log ambient].
using Shared = std::array<double, 3>;

struct Peak {
    std::array<double, 2> parameters{};  ///< log counts, path length [m]
    int first_bin = 0;
    int last_bin = 0;
};

bool has_tail(ResponseShape shape) {
    return shape == ResponseShape::GaussianExponential;
}

template <class T>
T cumulative(const T& delay, const T& sigma, const T& tail, ResponseShape shape) {
    if (!has_tail(shape)) return core::gaussian_cdf(delay, sigma);
    return core::exponential_gaussian_cdf(delay, sigma, tail);
}

// Expected counts of a bin, for numbers or automatic derivatives.
template <class T>
T expected_counts(
    const T* peak, const T* shared, const core::TimeAxis& axis, int bin, ResponseShape shape) {
    using std::exp;
    const T sigma = exp(shared[0]);
    const T tail = exp(shared[1]);
    const T above = cumulative<T>(T(axis.bin_begin_m(bin + 1)) - peak[1], sigma, tail, shape);
    const T below = cumulative<T>(T(axis.bin_begin_m(bin)) - peak[1], sigma, tail, shape);
    return exp(peak[0]) * (above - below) + exp(shared[2]);
}

struct PeakCost {
    std::span<const float> histogram;
    core::TimeAxis axis;
    int first_bin;
    int last_bin;
    ResponseShape shape;

    template <class T>
    bool operator()(const T* peak, const T* shared, T* residuals) const {
        for (int bin = first_bin; bin <= last_bin; ++bin) {
            const T mean = expected_counts(peak, shared, axis, bin, shape);
            residuals[bin - first_bin] =
                deviance_of(mean, static_cast<double>(histogram[static_cast<std::size_t>(bin)]));
        }
        return true;
    }

 private:
    static double deviance_of(double mean, double counted) {
        return signed_deviance(std::max(mean, kMinMean), counted).value;
    }
    template <int N>
    static ceres::Jet<double, N> deviance_of(const ceres::Jet<double, N>& mean, double counted) {
        const Residual residual = signed_deviance(std::max(mean.a, kMinMean), counted);
        return {residual.value, residual.gradient * mean.v};
    }
};

// The middle of the window of about the response's width that holds most counts.
int brightest_bin(std::span<const float> histogram, double sigma_m, double bin_width_m) {
    const int size = static_cast<int>(histogram.size());
    const int reach = std::min(static_cast<int>(sigma_m / bin_width_m), (size - 1) / 2);
    double sum = 0.0;
    for (int b = 0; b < 2 * reach; ++b) sum += double{histogram[static_cast<std::size_t>(b)]};
    double most = -1.0;
    int brightest = reach;
    for (int b = reach; b + reach < size; ++b) {
        sum += double{histogram[static_cast<std::size_t>(b + reach)]};
        if (sum > most) {
            most = sum;
            brightest = b;
        }
        sum -= double{histogram[static_cast<std::size_t>(b - reach)]};
    }
    return brightest;
}

Peak first_guess(const core::Capture& capture, std::size_t point, double sigma_m) {
    const auto histogram = capture.transient.histogram(point);
    const core::TimeAxis& axis = capture.time_axis;
    const auto [first_seen, end_seen] = capture.observed_range(point);
    Peak peak;
    const int bin = brightest_bin(histogram, sigma_m, axis.bin_width_m);
    const int reach = static_cast<int>(kWindow * sigma_m / axis.bin_width_m) + 2;
    peak.first_bin = std::max(first_seen, bin - reach);
    peak.last_bin = std::min(end_seen - 1, bin + reach);
    double sum = 0.0;
    double moment = 0.0;
    const int core_reach = static_cast<int>(2.0 * sigma_m / axis.bin_width_m) + 1;
    for (int b = std::max(0, bin - core_reach); b <= std::min(axis.num_bins - 1, bin + core_reach);
         ++b) {
        const double counts = static_cast<double>(histogram[static_cast<std::size_t>(b)]);
        sum += counts;
        moment += counts * axis.bin_center_m(b);
    }
    peak.parameters = {std::log(sum), moment / sum};
    return peak;
}

// Of pairs of photons in one histogram, by their distance in bins: a peak's pairs lie root 2 times
// as wide as its photons, noise is the same at all distances but 0, and no photon need be placed.
double rough_width(const core::Capture& capture) {
    constexpr std::size_t kReach = 400;
    std::vector<double> pairs(std::min(kReach, capture.transient.num_bins()), 0.0);
    for (std::size_t p = 0; p < capture.transient.num_pairs(); ++p) {
        const auto histogram = capture.transient.histogram(p);
        for (std::size_t b = 0; b < histogram.size(); ++b) {
            if (histogram[b] == 0.0F) continue;
            const std::size_t end = std::min(pairs.size(), histogram.size() - b);
            for (std::size_t d = 1; d < end; ++d) {
                pairs[d] += double{histogram[b]} * double{histogram[b + d]};
            }
        }
    }
    constexpr double kNarrowest = 0.4;  // bins
    if (pairs.size() < 3) return kNarrowest * capture.time_axis.bin_width_m;
    const double base = core::median({pairs.begin() + 1, pairs.end()});
    const double half = 0.5 * (pairs[1] + base);
    const auto below =
        std::find_if(pairs.begin() + 1, pairs.end(), [&](double value) { return value <= half; });
    const double half_width = static_cast<double>(below - pairs.begin()) - 0.5;
    return std::max(kNarrowest, half_width / (std::sqrt(2.0) * 1.1774)) *
           capture.time_axis.bin_width_m;
}

double mean_outside(const core::Capture& capture, const std::vector<Peak>& peaks) {
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t p = 0; p < peaks.size(); ++p) {
        const auto histogram = capture.transient.histogram(p);
        const core::BinRange observed = capture.observed_range(p);
        for (int b = observed.begin; b < observed.end; ++b) {
            if (b >= peaks[p].first_bin && b <= peaks[p].last_bin) continue;
            sum += static_cast<double>(histogram[static_cast<std::size_t>(b)]);
            count += 1.0;
        }
    }
    return count > 0.0 ? std::max(sum / count, 1e-6) : 1e-3;
}

// Fisher information of one point's [log counts, opl], and its coupling to the shared three.
struct PointInformation {
    Eigen::Matrix2d own;
    Eigen::Matrix<double, 2, 3> coupling;
};

// Fisher information of the shared three, points eliminated; stores what the points' own errors
// need, the deviance and how it scatters.
Eigen::Matrix3d schur_of_shared(const core::Capture& capture,
                                const std::vector<Peak>& peaks,
                                const Shared& shared,
                                ResponseShape shape,
                                std::vector<PointInformation>& points,
                                double& scatter,
                                DirectReturns& result) {
    using Jet = ceres::Jet<double, 5>;
    Eigen::Matrix3d total = Eigen::Matrix3d::Zero();
    double variance = 0.0;
    for (const Peak& peak : peaks) {
        const Jet p[2]{Jet(peak.parameters[0], 0), Jet(peak.parameters[1], 1)};
        const Jet s[3]{Jet(shared[0], 2), Jet(shared[1], 3), Jet(shared[2], 4)};
        Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
        const auto index = static_cast<std::size_t>(&peak - peaks.data());
        for (int bin = peak.first_bin; bin <= peak.last_bin; ++bin) {
            const Jet mean = expected_counts(p, s, capture.time_axis, bin, shape);
            const double safe = std::max(mean.a, kMinMean);
            information += mean.v * mean.v.transpose() / safe;
            const double counted = static_cast<double>(
                capture.transient.histogram(index)[static_cast<std::size_t>(bin)]);
            const double residual = signed_deviance(safe, counted).value;
            result.deviance += residual * residual;
            const DevianceMoments moments = deviance_moments(safe);
            result.expected_deviance += moments.mean;
            variance += moments.variance;
        }
        const PointInformation& point = points.emplace_back(PointInformation{
            information.topLeftCorner<2, 2>(), information.topRightCorner<2, 3>()});
        total += information.bottomRightCorner<3, 3>() -
                 point.coupling.transpose() * point.own.inverse() * point.coupling;
    }
    if (!has_tail(shape)) total(1, 1) += 1.0;  // no tail to know
    scatter = std::sqrt(variance);
    return total;
}

void store_errors(const core::Capture& capture,
                  const std::vector<Peak>& peaks,
                  const Shared& shared,
                  ResponseShape shape,
                  DirectReturns& result) {
    std::vector<PointInformation> points;
    double scatter = 0.0;
    const Eigen::Matrix3d covariance =
        schur_of_shared(capture, peaks, shared, shape, points, scatter, result).inverse();
    result.sigma_error_m = result.sigma_m * std::sqrt(covariance(0, 0));
    result.tail_error_m = result.tail_m * std::sqrt(covariance(1, 1));
    result.ambient_error = result.ambient * std::sqrt(covariance(2, 2));
    for (std::size_t p = 0; p < peaks.size(); ++p) {
        const Eigen::Matrix2d own = points[p].own.inverse();
        const Eigen::Matrix<double, 2, 3> lever = own * points[p].coupling;
        const Eigen::Matrix2d whole = own + lever * covariance * lever.transpose();
        const auto& [log_counts, opl_m] = peaks[p].parameters;
        result.points.push_back({opl_m, std::sqrt(whole(1, 1)), std::exp(log_counts)});
    }
    result.warnings = peak_warnings(capture, result, scatter);
}

}  // namespace

DirectReturns fit_direct_returns(const core::Capture& capture, ResponseShape shape) {
    require_peaks(capture);
    const double width_m = rough_width(capture);
    std::vector<Peak> peaks;
    for (std::size_t p = 0; p < capture.transient.num_pairs(); ++p) {
        peaks.push_back(first_guess(capture, p, width_m));
    }
    Shared shared{
        std::log(0.8 * width_m), std::log(width_m), std::log(mean_outside(capture, peaks))};

    ceres::Problem problem;
    for (std::size_t p = 0; p < peaks.size(); ++p) {
        auto* cost = new ceres::AutoDiffCostFunction<PeakCost, ceres::DYNAMIC, 2, 3>(
            new PeakCost{capture.transient.histogram(p),
                         capture.time_axis,
                         peaks[p].first_bin,
                         peaks[p].last_bin,
                         shape},
            peaks[p].last_bin - peaks[p].first_bin + 1);
        problem.AddResidualBlock(cost, nullptr, peaks[p].parameters.data(), shared.data());
    }
    if (!has_tail(shape)) {
        problem.SetManifold(shared.data(), new ceres::SubsetManifold(3, {1}));
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;  // points meet only in the shared three
    options.max_num_iterations = 200;
    options.function_tolerance = 1e-10;
    options.parameter_tolerance = 1e-10;
    options.logging_type = ceres::SILENT;
    options.num_threads = 1;
    ceres::Solver::Summary summary;
    quiet_ceres();
    ceres::Solve(options, &problem, &summary);
    if (summary.termination_type != ceres::CONVERGENCE) {
        throw core::Failure("direct_returns", "the peaks' fit did not converge");
    }
    DirectReturns result;
    result.shape = shape;
    result.sigma_m = std::exp(shared[0]);
    result.tail_m = has_tail(shape) ? std::exp(shared[1]) : 0.0;
    result.ambient = std::exp(shared[2]);
    store_errors(capture, peaks, shared, shape, result);
    if (has_tail(shape) && !(result.tail_error_m < result.tail_m)) {
        // A tail shorter than its own error is none; its delay would only blur the peaks' places.
        return fit_direct_returns(capture, ResponseShape::Gaussian);
    }
    return result;
}

}  // namespace calib
