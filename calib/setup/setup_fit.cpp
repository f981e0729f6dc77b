// SPDX-License-Identifier: MIT
#include "calib/setup/setup_fit.h"

#include "calib/setup/setup_costs.h"
#include "calib/statistics/quiet_ceres.h"
#include "renderer/core/statistics.h"

#include <Eigen/SparseCore>
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

namespace calib {
namespace {

constexpr double kNearestWall_m = 0.01;
constexpr double kSmallestGain = 1e-6;
constexpr double kLargestTilt_rad = 1.4;

std::vector<int> held_parameters(const SetupObservations& o) {
    std::vector<int> held;
    if (!o.camera) held = {kSpin, kFootX, kFootY};
    if (has_known_gain(o) && !o.galvo_gain) {
        held.push_back(kGainX);
        held.push_back(kGainY);
    }
    return held;
}

// Residuals of points, through a loss, and of known values, which have none.
void add_costs(const SetupObservations& o,
               ceres::LossFunction* loss,
               double* p,
               ceres::Problem& problem) {
    const auto add = [&]<class Cost>(const Cost& cost, ceres::LossFunction* its_loss) {
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<Cost, Cost::kResiduals, kNumSetupParameters>(
                new Cost(cost)),
            its_loss,
            p);
    };
    for (std::size_t i = 0; i < o.returns.size(); ++i) {
        if (!o.counts(i)) continue;
        add(LengthCost{o.commands[i], o.returns[i].opl_m, o.returns[i].sigma_m}, loss);
        if (!o.camera) continue;
        add(SpotCost{o.commands[i], o.spots_px[i], o.spot_sigma_px, &*o.camera}, loss);
    }
    for (const KnownKey& key : kKnownKeys) {
        if (!(o.*key.value)) continue;
        for (const int parameter : key.parameters) {
            add(KnownCost{parameter, *(o.*key.value)}, nullptr);
        }
    }
}

// Starting points: a few tilts; with a camera the spots give foot and gain at once.
std::vector<SetupValues> starts(const SetupObservations& o) {
    const double mean_opl =
        std::accumulate(o.returns.begin(),
                        o.returns.end(),
                        0.0,
                        [](double sum, const DirectReturn& r) { return sum + r.opl_m; }) /
        static_cast<double>(o.returns.size());
    SetupValues start{};
    const double zero = o.time_zero_m ? o.time_zero_m->value : 0.0;
    start[kZero] = zero;
    start[kDistance] =
        o.wall_distance_m ? o.wall_distance_m->value : std::max(0.1, 0.5 * (mean_opl - zero));
    if (!o.time_zero_m) start[kZero] = mean_opl - 2.0 * start[kDistance];
    const double gain = o.galvo_gain ? o.galvo_gain->value : angle_of(o.command_unit).value_or(1.0);
    start[kGainX] = start[kGainY] = gain;
    if (o.camera) {
        core::Vec2 foot = core::Vec2::Zero();
        for (const core::Vec2& spot : o.spots_px) {
            foot += o.camera->wall_point(spot) / static_cast<double>(o.spots_px.size());
        }
        start[kFootX] = foot.x();
        start[kFootY] = foot.y();
    }
    std::vector<SetupValues> result;
    for (const double tilt_x : {0.0, -0.5, 0.5}) {
        for (const double tilt_y : {0.0, -0.5, 0.5}) {
            for (const double scale : {1.0, 0.2}) {
                if (scale != 1.0 && has_known_gain(o)) continue;
                SetupValues one = start;
                one[kTiltX] = tilt_x;
                one[kTiltY] = tilt_y;
                one[kGainX] = one[kGainY] = scale * gain;
                result.push_back(one);
            }
        }
    }
    return result;
}

void set_bounds(double* p, ceres::Problem& problem) {
    problem.SetParameterLowerBound(p, kDistance, kNearestWall_m);
    problem.SetParameterLowerBound(p, kGainX, kSmallestGain);
    problem.SetParameterLowerBound(p, kGainY, kSmallestGain);
    for (const int tilt : {kTiltX, kTiltY}) {
        problem.SetParameterLowerBound(p, tilt, -kLargestTilt_rad);
        problem.SetParameterUpperBound(p, tilt, kLargestTilt_rad);
    }
}

std::string bound_of(const SetupFit& fit) {
    const auto touches = [&](int parameter, double bound) {
        return std::abs(fit.values[static_cast<std::size_t>(parameter)] - bound) <=
               1e-6 * std::abs(bound);
    };
    for (const int i : fit.free) {
        const bool is_tilt = i == kTiltX || i == kTiltY;
        if ((i == kDistance && touches(i, kNearestWall_m)) ||
            ((i == kGainX || i == kGainY) && touches(i, kSmallestGain)) ||
            (is_tilt && (touches(i, kLargestTilt_rad) || touches(i, -kLargestTilt_rad)))) {
            return kSetupNames[static_cast<std::size_t>(i)];
        }
    }
    return "";
}

Eigen::MatrixXd information_of(ceres::Problem& problem) {
    ceres::CRSMatrix sparse;
    problem.Evaluate({}, nullptr, nullptr, nullptr, &sparse);
    const Eigen::MatrixXd jacobian = Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>>(
        sparse.num_rows,
        sparse.num_cols,
        static_cast<Eigen::Index>(sparse.values.size()),
        sparse.rows.data(),
        sparse.cols.data(),
        sparse.values.data());
    return jacobian.transpose() * jacobian;
}

// What the values leave unexplained; false when a beam misses the wall.
bool measure_misfit(const SetupObservations& o, SetupFit& fit) {
    const double* p = fit.values.data();
    double count = 0.0;
    double squares = 0.0;
    double noise = 0.0;
    double spots = 0.0;
    fit.chi_square = 0.0;
    for (std::size_t i = 0; i < o.returns.size(); ++i) {
        double length = 0.0;
        const core::Vec3 spot = spot_of(p, o.commands[i], length);
        const double reach = std::max(std::abs(p[kGainX] * o.commands[i][0]),
                                      std::abs(p[kGainY] * o.commands[i][1]));
        if (o.counts(i) && (!(length > 0.0) || !(reach < core::kPi / 2.0))) return false;
        fit.length_misfit_m.push_back(p[kZero] + 2.0 * length - o.returns[i].opl_m);
        if (o.camera) {
            fit.spot_misfit_px.push_back((o.camera->project(spot) - o.spots_px[i]).norm());
        }
        if (!o.counts(i)) continue;
        count += 1.0;
        squares += std::pow(fit.length_misfit_m[i], 2.0);
        noise += std::pow(o.returns[i].sigma_m, 2.0);
        fit.chi_square += std::pow(fit.length_misfit_m[i] / o.returns[i].sigma_m, 2.0);
        if (o.camera) spots += std::pow(fit.spot_misfit_px[i], 2.0);
    }
    fit.chi_square += spots / std::pow(o.spot_sigma_px, 2.0);
    fit.degrees_of_freedom = (o.camera ? 3.0 : 1.0) * count - static_cast<double>(fit.free.size());
    for (const KnownKey& key : kKnownKeys) {
        if (!(o.*key.value)) continue;
        for (const int parameter : key.parameters) {
            fit.chi_square +=
                std::pow((p[parameter] - (o.*key.value)->value) / (o.*key.value)->sigma, 2.0);
            fit.degrees_of_freedom += 1.0;
        }
    }
    fit.length_rms_m = std::sqrt(squares / count);
    fit.noise_rms_m = std::sqrt(noise / count);
    fit.spot_rms_px = std::sqrt(spots / count);
    return true;
}

// From one start; the cost tells starts apart.
SetupFit fit_from(const SetupObservations& o,
                  const SetupValues& start,
                  ceres::LossFunction* loss,
                  double& cost) {
    SetupFit fit;
    fit.values = start;
    const std::vector<int> held = held_parameters(o);
    for (int i = 0; i < kNumSetupParameters; ++i) {
        if (std::find(held.begin(), held.end(), i) == held.end()) fit.free.push_back(i);
    }
    ceres::Problem::Options ownership;
    ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(ownership);
    add_costs(o, loss, fit.values.data(), problem);
    if (!held.empty()) {
        problem.SetManifold(fit.values.data(),
                            new ceres::SubsetManifold(kNumSetupParameters, held));
    }
    set_bounds(fit.values.data(), problem);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 300;
    options.function_tolerance = 1e-12;
    options.parameter_tolerance = 1e-12;
    options.logging_type = ceres::SILENT;
    options.num_threads = 1;
    ceres::Solver::Summary summary;
    quiet_ceres();
    ceres::Solve(options, &problem, &summary);
    cost = summary.final_cost;
    if (!summary.IsSolutionUsable() || !measure_misfit(o, fit)) return {};
    fit.information = information_of(problem);
    fit.at_bound = bound_of(fit);
    return fit;
}

}  // namespace

SetupFit fit_setup(const SetupObservations& o) {
    SetupFit best;
    double best_cost = std::numeric_limits<double>::infinity();
    for (const SetupValues& start : starts(o)) {
        double cost = 0.0;
        SetupFit fit = fit_from(o, start, nullptr, cost);
        if (!fit.is_found() || cost >= best_cost) continue;
        best_cost = cost;
        best = std::move(fit);
    }
    return best;
}

SetupFit fit_setup_robustly(const SetupObservations& o, const SetupFit& start) {
    constexpr int kMostRounds = 12;
    constexpr double kUsual = 2.0;  // standard deviations
    SetupFit fit = start;
    for (int round = 0; round < kMostRounds && fit.is_found(); ++round) {
        const double scale = std::max(kUsual, 1.5 * core::median(point_misfits(o, fit)));
        ceres::CauchyLoss loss(scale);
        double cost = 0.0;
        fit = fit_from(o, fit.values, &loss, cost);
        if (scale == kUsual) break;
    }
    return fit;
}

double length_error_m(const SetupObservations& o, std::size_t point) {
    return std::hypot(o.returns[point].sigma_m, o.axis.bin_width_m / std::sqrt(12.0));
}

double spot_error_px(const SetupObservations& o) {
    return std::hypot(o.spot_sigma_px, o.camera->reprojection_rms_px);
}

std::vector<double> point_misfits(const SetupObservations& o, const SetupFit& fit) {
    std::vector<double> misfits;
    for (std::size_t i = 0; i < o.returns.size(); ++i) {
        double misfit = std::abs(fit.length_misfit_m[i]) / length_error_m(o, i);
        if (o.camera) misfit = std::max(misfit, fit.spot_misfit_px[i] / spot_error_px(o));
        misfits.push_back(misfit);
    }
    return misfits;
}

}  // namespace calib
