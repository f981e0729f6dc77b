// SPDX-License-Identifier: MIT
#include "calib/setup/setup_geometry.h"

#include "renderer/core/error.h"

#include <Eigen/SparseCore>
#include <ceres/ceres.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace calib {
namespace {

using core::Vec3;

constexpr int kNumUnknowns = 9;
enum Unknown { kDistance, kTiltX, kTiltY, kSpin, kFootX, kFootY, kZero, kGainX, kGainY };

// A calibration whose distance or gain is known no better than this is no calibration.
constexpr double kWorstRelativeDistance = 0.01;
constexpr double kWorstRelativeGain = 0.01;
constexpr double kWorstTilt_rad = 0.05;

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

// Device frame in the wall's: spin about the normal, then tilts about x and y.
template <class T>
Vector3<T> rotated(const T* p, const Vector3<T>& d) {
    using std::cos;
    using std::sin;
    const T x = cos(p[kSpin]) * d[0] - sin(p[kSpin]) * d[1];
    const T y = sin(p[kSpin]) * d[0] + cos(p[kSpin]) * d[1];
    const T y2 = cos(p[kTiltX]) * y - sin(p[kTiltX]) * d[2];
    const T z = sin(p[kTiltX]) * y + cos(p[kTiltX]) * d[2];
    return {T(cos(p[kTiltY]) * x + sin(p[kTiltY]) * z),
            y2,
            T(-sin(p[kTiltY]) * x + cos(p[kTiltY]) * z)};
}

template <class T>
Vector3<T> device_of(const T* p) {
    const Vector3<T> forward = rotated<T>(p, Vector3<T>(T(0.0), T(0.0), T(-1.0)));
    return Vector3<T>(p[kFootX], p[kFootY], T(0.0)) - p[kDistance] * forward;
}

// Where a command's beam meets the plane z = 0, and its length.
template <class T>
Vector3<T> spot_of(const T* p, const std::array<double, 2>& command, T& length) {
    using std::tan;
    const Vector3<T> beam = rotated<T>(
        p, Vector3<T>(tan(p[kGainX] * command[0]), tan(p[kGainY] * command[1]), T(-1.0)));
    const Vector3<T> device = device_of(p);
    const T share = -device[2] / beam[2];
    length = share * beam.norm();
    return device + share * beam;
}

struct RangeCost {
    static constexpr int kResiduals = 1;
    std::array<double, 2> command;
    double opl_m;
    double sigma_m;
    template <class T>
    bool operator()(const T* p, T* residual) const {
        T length;
        spot_of(p, command, length);
        residual[0] = (p[kZero] + 2.0 * length - opl_m) / sigma_m;
        return true;
    }
};

struct SpotCost {
    static constexpr int kResiduals = 2;
    std::array<double, 2> command;
    core::Vec2 pixel;
    double sigma_px;
    const CameraCalibration* camera;
    template <class T>
    bool operator()(const T* p, T* residual) const {
        T length;
        const Vector3<T> wall = spot_of(p, command, length);
        const Eigen::Matrix<T, 2, 1> seen = camera->project<T>(wall);
        residual[0] = (seen[0] - pixel.x()) / sigma_px;
        residual[1] = (seen[1] - pixel.y()) / sigma_px;
        return true;
    }
};

struct KnownCost {
    static constexpr int kResiduals = 1;
    int parameter;
    KnownValue known;
    template <class T>
    bool operator()(const T* p, T* residual) const {
        residual[0] = (p[parameter] - known.value) / known.sigma;
        return true;
    }
};

// Commands in volts leave the gain open.
bool has_known_gain(const SetupObservations& o) {
    return o.galvo_gain || o.command_unit == CommandUnit::Rad;
}

std::vector<int> held_parameters(const SetupObservations& o) {
    std::vector<int> held;
    if (!o.camera) held = {kSpin, kFootX, kFootY};
    if (has_known_gain(o) && !o.galvo_gain) {
        held.push_back(kGainX);
        held.push_back(kGainY);
    }
    return held;
}

void add_costs(const SetupObservations& o, double* p, ceres::Problem& problem) {
    const auto add = [&]<class Cost>(const Cost& cost) {
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<Cost, Cost::kResiduals, kNumUnknowns>(new Cost(cost)),
            nullptr,
            p);
    };
    for (std::size_t i = 0; i < o.returns.size(); ++i) {
        add(RangeCost{o.commands[i], o.returns[i].opl_m, o.returns[i].sigma_m});
        if (!o.camera) continue;
        add(SpotCost{o.commands[i], o.spots_px[i], o.spot_sigma_px, &*o.camera});
    }
    if (o.wall_distance_m) add(KnownCost{kDistance, *o.wall_distance_m});
    if (o.time_zero_m) add(KnownCost{kZero, *o.time_zero_m});
    if (o.galvo_gain) add(KnownCost{kGainX, *o.galvo_gain});
    if (o.galvo_gain) add(KnownCost{kGainY, *o.galvo_gain});
}

// Starting points: a few tilts; with a camera the spots give foot and gain at once.
std::vector<std::array<double, 9>> starts(const SetupObservations& o) {
    const double mean_opl =
        std::accumulate(o.returns.begin(),
                        o.returns.end(),
                        0.0,
                        [](double sum, const DirectReturn& r) { return sum + r.opl_m; }) /
        static_cast<double>(o.returns.size());
    std::array<double, 9> start{};
    const double zero = o.time_zero_m ? o.time_zero_m->value : 0.0;
    start[kZero] = zero;
    start[kDistance] =
        o.wall_distance_m ? o.wall_distance_m->value : std::max(0.1, 0.5 * (mean_opl - zero));
    if (!o.time_zero_m) start[kZero] = mean_opl - 2.0 * start[kDistance];
    const double gain = o.galvo_gain ? o.galvo_gain->value : 1.0;
    start[kGainX] = start[kGainY] = gain;
    if (o.camera) {
        core::Vec2 foot = core::Vec2::Zero();
        for (const core::Vec2& spot : o.spots_px) {
            foot += o.camera->wall_point(spot) / static_cast<double>(o.spots_px.size());
        }
        start[kFootX] = foot.x();
        start[kFootY] = foot.y();
    }
    std::vector<std::array<double, 9>> result;
    for (const double tilt_x : {0.0, -0.5, 0.5}) {
        for (const double tilt_y : {0.0, -0.5, 0.5}) {
            for (const double scale : {1.0, 0.2}) {
                if (scale != 1.0 && has_known_gain(o)) continue;
                auto one = start;
                one[kTiltX] = tilt_x;
                one[kTiltY] = tilt_y;
                one[kGainX] = one[kGainY] = scale * gain;
                result.push_back(one);
            }
        }
    }
    return result;
}

Eigen::MatrixXd jacobian_of(ceres::Problem& problem) {
    ceres::CRSMatrix sparse;
    problem.Evaluate({}, nullptr, nullptr, nullptr, &sparse);
    return Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>>(
        sparse.num_rows,
        sparse.num_cols,
        static_cast<Eigen::Index>(sparse.values.size()),
        sparse.rows.data(),
        sparse.cols.data(),
        sparse.values.data());
}

void refuse_if_singular(const SetupObservations& o, const SetupGeometry& setup) {
    const double distance = setup.values[kDistance];
    const bool is_loose =
        setup.sigma[kDistance] > kWorstRelativeDistance * distance ||
        setup.sigma[kGainX] > kWorstRelativeGain * std::abs(setup.values[kGainX]) ||
        setup.sigma[kGainY] > kWorstRelativeGain * std::abs(setup.values[kGainY]) ||
        setup.sigma[kTiltX] > kWorstTilt_rad || setup.sigma[kTiltY] > kWorstTilt_rad;
    if (!is_loose) return;
    std::string help = "a view of the wall tilted by some 30 degrees";
    if (!o.wall_distance_m) help += ", known.wall_distance_m";
    if (!has_known_gain(o)) help += ", known.galvo_gain";
    if (!o.time_zero_m) help += ", known.time_zero_m";
    if (!o.camera) help += ", a camera with boards";
    const std::string which = setup.uncertainty.unidentifiable.empty()
                                  ? "its parameters"
                                  : setup.uncertainty.unidentifiable.front();
    throw core::Failure(
        "calibrate",
        fmt::format("singular: the data hardly determine {} (condition number {:.1e}, wall "
                    "distance known to {:.1f} mm); any of these would help: {}",
                    which,
                    setup.uncertainty.condition_number,
                    1e3 * setup.sigma[kDistance],
                    help));
}

// Standard deviation of a function of the free parameters.
template <class Function>
double propagated(const Function& function,
                  const SetupGeometry& setup,
                  const std::vector<int>& free) {
    using Jet = ceres::Jet<double, kNumUnknowns>;
    std::array<Jet, kNumUnknowns> p;
    for (int i = 0; i < kNumUnknowns; ++i) {
        p[static_cast<std::size_t>(i)] = Jet(setup.values[static_cast<std::size_t>(i)], i);
    }
    const Jet value = function(p.data());
    Eigen::VectorXd gradient(static_cast<Eigen::Index>(free.size()));
    for (std::size_t i = 0; i < free.size(); ++i) {
        gradient[static_cast<Eigen::Index>(i)] = value.v[free[i]];
    }
    return std::sqrt(gradient.dot(setup.uncertainty.covariance * gradient));
}

void store_points(const SetupObservations& o, const std::vector<int>& free, SetupGeometry& setup) {
    setup.device_m = device_of(setup.values.data());
    for (std::size_t i = 0; i < o.commands.size(); ++i) {
        double length = 0.0;
        setup.points_m.push_back(spot_of(setup.values.data(), o.commands[i], length));
        setup.points_m.back().z() = 0.0;
        setup.opl_offset_m.push_back(setup.values[kZero] + 2.0 * length);
        const double misfit = setup.opl_offset_m.back() - o.returns[i].opl_m;
        setup.range_rms_m += misfit * misfit / static_cast<double>(o.commands.size());
        double variance = 0.0;
        for (int axis = 0; axis < 2; ++axis) {
            const double sigma = propagated(
                [&](const auto* p) {
                    std::decay_t<decltype(p[0])> unused;
                    return spot_of(p, o.commands[i], unused)[axis];
                },
                setup,
                free);
            variance += sigma * sigma;
        }
        setup.point_sigma_m.push_back(std::sqrt(variance));
        setup.opl_offset_sigma_m.push_back(propagated(
            [&](const auto* p) {
                std::decay_t<decltype(p[0])> beam;
                spot_of(p, o.commands[i], beam);
                return p[kZero] + 2.0 * beam;
            },
            setup,
            free));
    }
    setup.range_rms_m = std::sqrt(setup.range_rms_m);
}

}  // namespace

SetupGeometry solve_setup(const SetupObservations& o) {
    const std::vector<int> held = held_parameters(o);
    std::vector<int> free;
    std::vector<std::string> names;
    for (int i = 0; i < kNumUnknowns; ++i) {
        if (std::find(held.begin(), held.end(), i) != held.end()) continue;
        free.push_back(i);
        names.push_back(kSetupNames[static_cast<std::size_t>(i)]);
    }
    SetupGeometry best;
    double best_cost = std::numeric_limits<double>::infinity();
    for (const auto& start : starts(o)) {
        std::array<double, 9> p = start;
        ceres::Problem problem;
        add_costs(o, p.data(), problem);
        if (!held.empty()) {
            problem.SetManifold(p.data(), new ceres::SubsetManifold(kNumUnknowns, held));
        }
        problem.SetParameterLowerBound(p.data(), kDistance, 0.01);
        problem.SetParameterLowerBound(p.data(), kGainX, 1e-6);
        problem.SetParameterLowerBound(p.data(), kGainY, 1e-6);
        for (const int tilt : {kTiltX, kTiltY}) {
            problem.SetParameterLowerBound(p.data(), tilt, -1.4);
            problem.SetParameterUpperBound(p.data(), tilt, 1.4);
        }
        ceres::Solver::Options options;
        options.linear_solver_type = ceres::DENSE_QR;
        options.max_num_iterations = 300;
        options.function_tolerance = 1e-12;
        options.parameter_tolerance = 1e-12;
        options.logging_type = ceres::SILENT;
        options.num_threads = 1;
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem, &summary);
        if (!summary.IsSolutionUsable() || summary.final_cost >= best_cost) continue;
        best_cost = summary.final_cost;
        best.values = p;
        const Eigen::MatrixXd jacobian = jacobian_of(problem);
        best.uncertainty = assess(jacobian.transpose() * jacobian, names);
    }
    if (!std::isfinite(best_cost)) {
        throw core::Failure("calibrate", "no start leads to a set-up that explains the data");
    }
    for (std::size_t i = 0; i < free.size(); ++i) {
        best.sigma[static_cast<std::size_t>(free[i])] =
            best.uncertainty.sigma[static_cast<Eigen::Index>(i)];
    }
    refuse_if_singular(o, best);
    store_points(o, free, best);
    return best;
}

}  // namespace calib
