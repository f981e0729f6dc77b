// SPDX-License-Identifier: MIT
// What one piece or point adds to one pair: the chain rule from wall points, corners and normals to
// the knots of the kernel.
#include "calib/forward_model.h"

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

using core::Slopes;
using core::Vec3;

// One leg between a wall point w and a surface point x, d = x - w: its length, the factor
// (n_w.d) |n.d| / |d|^4 and the gradients of both. The gradients by w are minus those by x.
struct Leg {
    double length = 0.0;
    double factor = 0.0;
    double side = 0.0;    // sign of n.d
    Vec3 direction;       // d/|d|
    Vec3 by_position;     // of the factor, by x
    Vec3 by_normal;       // by n
    Vec3 by_wall_normal;  // by n_w
};

Leg make_leg(const MovedWallPoint& wall, const Vec3& x, const Vec3& normal, Slopes slopes) {
    const Vec3 d = x - wall.position;
    const double squared = d.squaredNorm();
    const double front = wall.normal.dot(d);
    const double facing = normal.dot(d);
    Leg leg;
    leg.length = std::sqrt(squared);
    leg.direction = d / leg.length;
    leg.side = facing < 0.0 ? -1.0 : 1.0;
    const double per4 = 1.0 / (squared * squared);
    const bool is_in_front = front > 0.0;
    leg.factor = is_in_front ? front * std::abs(facing) * per4 : 0.0;
    if (slopes == Slopes::Without) return leg;
    if (!is_in_front) {
        leg.by_position = leg.by_normal = leg.by_wall_normal = Vec3::Zero();
        return leg;
    }
    leg.by_position = per4 * (std::abs(facing) * wall.normal + front * leg.side * normal) -
                      4.0 * leg.factor / squared * d;
    leg.by_normal = front * leg.side * per4 * d;
    leg.by_wall_normal = std::abs(facing) * per4 * d;
    return leg;
}

// (n_w.d) / |d|^3 of an isotropic scatterer.
Leg make_point_leg(const MovedWallPoint& wall, const Vec3& x) {
    const Vec3 d = x - wall.position;
    const double squared = d.squaredNorm();
    const double front = wall.normal.dot(d);
    Leg leg;
    leg.length = std::sqrt(squared);
    leg.direction = d / leg.length;
    leg.by_position = leg.by_wall_normal = Vec3::Zero();
    if (!(front > 0.0)) return leg;
    const double per3 = 1.0 / (squared * leg.length);
    leg.factor = front * per3;
    leg.by_position = per3 * wall.normal - 3.0 * leg.factor / squared * d;
    leg.by_wall_normal = per3 * d;
    return leg;
}

// Both legs of a path by way of one surface point.
struct Path {
    double opl = 0.0;
    double factor = 0.0;
    Vec3 opl_by_position;
    Vec3 factor_by_position;
    Vec3 factor_by_normal;
    std::array<double, 2> opl_by_wall{};  // bow, log scale
    std::array<double, 2> factor_by_wall{};
};

struct PathEnds {
    const MovedWallPoint* light;
    const MovedWallPoint* sensor;
};

Path join_legs(const PathEnds& ends, const Leg& light, const Leg& sensor, Slopes slopes) {
    Path path;
    path.opl = light.length + sensor.length;
    path.factor = light.factor * sensor.factor;
    if (slopes == Slopes::Without) return path;
    path.opl_by_position = light.direction + sensor.direction;
    path.factor_by_position = sensor.factor * light.by_position + light.factor * sensor.by_position;
    path.factor_by_normal = sensor.factor * light.by_normal + light.factor * sensor.by_normal;
    for (std::size_t i = 0; i < 2; ++i) {
        const auto& light_slope = ends.light->position_slope[i];
        const auto& sensor_slope = ends.sensor->position_slope[i];
        path.opl_by_wall[i] =
            -light.direction.dot(light_slope) - sensor.direction.dot(sensor_slope);
        path.factor_by_wall[i] =
            sensor.factor * (light.by_wall_normal.dot(ends.light->normal_slope[i]) -
                             light.by_position.dot(light_slope)) +
            light.factor * (sensor.by_wall_normal.dot(ends.sensor->normal_slope[i]) -
                            sensor.by_position.dot(sensor_slope));
    }
    return path;
}

// A retroreflector sends back one leg's factor.
Path retroreflected(const PathEnds& ends, const Leg& leg, Slopes slopes) {
    Leg mirror = leg;
    mirror.factor = 1.0;
    mirror.by_position = mirror.by_normal = mirror.by_wall_normal = Vec3::Zero();
    return join_legs(ends, leg, mirror, slopes);
}

// core::match_midpoints for a derivative: how the knots change when the nodes do.
struct KnotChange {
    std::array<double, 3> opl;
    std::array<double, 3> weight;
};

double mean3(const std::array<double, 6>& values, std::size_t first) {
    return (values[first] + values[first + 1] + values[first + 2]) / 3.0;
}

class KnotFit {
 public:
    KnotFit(const std::array<double, 6>& opl, const std::array<double, 6>& weight) {
        core::TriangleKnots corners{{opl[0], opl[1], opl[2]}, {weight[0], weight[1], weight[2]}};
        core::TriangleKnots middles{{opl[3], opl[4], opl[5]}, {weight[3], weight[4], weight[5]}};
        knots_ = core::match_midpoints(corners, middles);
        corners_ = corners.weight;
        mean_ = mean3(weight, 3);
        corner_mean_ = mean3(weight, 0);
        lowest_ = static_cast<std::size_t>(std::min_element(corners_.begin(), corners_.end()) -
                                           corners_.begin());
        is_clamped_ = corners_[lowest_] - corner_mean_ < -mean_;
    }

    const core::TriangleKnots& knots() const { return knots_; }

    KnotChange change(const std::array<double, 6>& opl, const std::array<double, 6>& weight) const {
        KnotChange result;
        const double shift = mean3(opl, 3) - mean3(opl, 0);
        const double mean = mean3(weight, 3);
        const double corner_mean = mean3(weight, 0);
        double spread = 1.0;
        double spread_change = 0.0;
        if (is_clamped_) {
            const double depth = corner_mean_ - corners_[lowest_];
            spread = mean_ / depth;
            spread_change = (mean - spread * (corner_mean - weight[lowest_])) / depth;
        }
        for (std::size_t j = 0; j < 3; ++j) {
            result.opl[j] = opl[j] + shift;
            result.weight[j] = mean + spread * (weight[j] - corner_mean) +
                               spread_change * (corners_[j] - corner_mean_);
        }
        return result;
    }

 private:
    core::TriangleKnots knots_;
    std::array<double, 3> corners_{};
    double mean_ = 0.0;
    double corner_mean_ = 0.0;
    std::size_t lowest_ = 0;
    bool is_clamped_ = false;
};

// The weights of a piece's visible part: the product of two linear functions, made linear again
// with its integral kept, and how it changes with the weights.
//
// With W, S and P the sums of weights w, shares s and products w s, the integral of the product is
// (W S + P)/12 times twice the area, that of linear corner values p is their sum over 6 times it.
class VisibleWeights {
 public:
    VisibleWeights(const std::array<double, 3>& weight, renderer::VisibilityMask mask)
        : is_whole_(mask == renderer::kAllVisible), weight_(weight) {
        if (is_whole_) return;
        share_ = renderer::visible_share(mask);
        for (std::size_t j = 0; j < 3; ++j) {
            weights_ += weight[j];
            shares_ += share_[j];
            products_ += weight[j] * share_[j];
        }
        factor_ = products_ > 0.0 ? 0.25 * (weights_ * shares_ / products_ + 1.0) : 0.0;
    }

    std::array<double, 3> values() const {
        if (is_whole_) return weight_;
        std::array<double, 3> result{};
        for (std::size_t j = 0; j < 3; ++j) result[j] = factor_ * weight_[j] * share_[j];
        return result;
    }

    void convert_change(std::array<double, 3>& change) const {
        if (is_whole_) return;
        if (!(products_ > 0.0)) {
            change = {0.0, 0.0, 0.0};
            return;
        }
        double weights = 0.0;
        double products = 0.0;
        for (std::size_t j = 0; j < 3; ++j) {
            weights += change[j];
            products += change[j] * share_[j];
        }
        const double factor =
            0.25 * shares_ / products_ * (weights - weights_ * products / products_);
        for (std::size_t j = 0; j < 3; ++j) {
            change[j] = share_[j] * (factor_ * change[j] + factor * weight_[j]);
        }
    }

 private:
    bool is_whole_;
    std::array<double, 3> weight_;
    std::array<double, 3> share_{};
    double weights_ = 0.0;
    double shares_ = 0.0;
    double products_ = 0.0;
    double factor_ = 0.0;
};

}  // namespace

void ForwardModel::add_piece(const PosedPiece& piece,
                             renderer::VisibilityMask mask,
                             std::size_t pair,
                             PairModel& result) const {
    const PathEnds ends{&light_points_[scan_.illumination_index(pair)],
                        &sensor_points_[scan_.sensing_index(pair)]};
    const bool is_confocal = scan_.pattern == core::ScanPattern::Confocal;
    if (piece.is_retroreflective && !is_confocal) return;
    const double constant = piece.weight;
    const double extra = state_.time_zero_m + settings_.offset_m[pair];
    std::array<Path, 6> paths;
    std::array<double, 6> opl{};
    std::array<double, 6> weight{};
    for (std::size_t i = 0; i < 6; ++i) {
        const Leg sensor = make_leg(*ends.sensor, piece.nodes[i], piece.normal, slopes_);
        if (piece.is_retroreflective) {
            paths[i] = retroreflected(ends, sensor, slopes_);
        } else if (is_confocal) {
            paths[i] = join_legs(ends, sensor, sensor, slopes_);
        } else {
            const Leg light = make_leg(*ends.light, piece.nodes[i], piece.normal, slopes_);
            if (light.side != sensor.side) return;  // one of them looks at the facet's back
            paths[i] = join_legs(ends, light, sensor, slopes_);
        }
        opl[i] = paths[i].opl + extra;
        weight[i] = constant * paths[i].factor;
    }
    const KnotFit fit(opl, weight);
    const VisibleWeights visible(fit.knots().weight, mask);
    thread_local core::TriangleBins bins;
    core::evaluate_triangle(
        {fit.knots().opl_m, visible.values()}, sigma_m_, fine_axis(), slopes_, bins);
    const auto first = static_cast<std::size_t>(bins.first_bin);
    for (std::size_t b = 0; b < bins.bins.size(); ++b) {
        result.mean[first + b] += bins.bins[b].slots[0];
    }
    if (slopes_ == Slopes::Without || bins.bins.empty()) return;

    thread_local std::vector<std::pair<std::size_t, KnotChange>> changes;
    changes.clear();
    const auto add_change = [&](int column, const auto& opl_slope, const auto& factor_slope) {
        for (std::size_t i = 0; i < 6; ++i) {
            opl[i] = opl_slope(i);
            weight[i] = constant * factor_slope(i);
        }
        changes.emplace_back(static_cast<std::size_t>(column), fit.change(opl, weight));
        visible.convert_change(changes.back().second.weight);
    };
    for (std::size_t c = 0; c < piece.columns.size(); ++c) {
        add_change(
            piece.columns[c],
            [&](std::size_t i) { return paths[i].opl_by_position.dot(piece.node_slopes[c][i]); },
            [&](std::size_t i) {
                return paths[i].factor_by_position.dot(piece.node_slopes[c][i]) +
                       paths[i].factor_by_normal.dot(piece.normal_slopes[c]) +
                       paths[i].factor * piece.log_area_slopes[c];
            });
    }
    for (const std::size_t w : {0UL, 1UL}) {
        const auto kind = w == 0 ? ParameterKind::WallBow : ParameterKind::WallScale;
        const auto* block = model_.find(kind);
        if (block == nullptr) continue;
        add_change(
            block->first_column,
            [&](std::size_t i) { return paths[i].opl_by_wall[w]; },
            [&](std::size_t i) { return paths[i].factor_by_wall[w]; });
    }
    const auto* time_zero = model_.find(ParameterKind::TimeZero);
    const auto* width = model_.find(ParameterKind::ResponseWidth);
    const auto columns = static_cast<std::size_t>(model_.num_columns());
    for (std::size_t b = 0; b < bins.bins.size(); ++b) {
        const auto& s = bins.bins[b].slots;
        double* row = result.slopes.data() + (first + b) * columns;
        for (const auto& [column, change] : changes) {
            row[column] += s[1] * change.opl[0] + s[2] * change.opl[1] + s[3] * change.opl[2] +
                           s[4] * change.weight[0] + s[5] * change.weight[1] +
                           s[6] * change.weight[2];
        }
        if (piece.albedo_column >= 0) row[piece.albedo_column] += s[0];
        if (time_zero != nullptr) row[time_zero->first_column] += s[1] + s[2] + s[3];
        if (width != nullptr) row[width->first_column] += width_share_ * s[7];
    }
}

void ForwardModel::add_point(std::size_t index, std::size_t pair, PairModel& result) const {
    const PathEnds ends{&light_points_[scan_.illumination_index(pair)],
                        &sensor_points_[scan_.sensing_index(pair)]};
    const PointState& point = state_.points[index];
    Leg light = make_point_leg(*ends.light, point.position_m);
    Leg sensor = make_point_leg(*ends.sensor, point.position_m);
    light.by_normal = sensor.by_normal = Vec3::Zero();
    const Path path = join_legs(ends, light, sensor, Slopes::With);
    const double constant =
        std::exp(point.log_albedo + state_.log_scale) * settings_.radiance_factor;
    const double opl = path.opl + state_.time_zero_m + settings_.offset_m[pair];

    // A triangle with equal knots is a point; without a response the kernel has no slope there, so
    // that light is spread evenly over a bin.
    const core::TimeAxis axis = fine_axis();
    const double half = sigma_m_ > 0.0 ? 0.0 : 0.5 * axis.bin_width_m;
    thread_local core::TriangleBins bins;
    const double weight = constant * path.factor;
    core::evaluate_triangle(
        {{opl - half, opl, opl + half}, {weight, weight, weight}}, sigma_m_, axis, slopes_, bins);
    const auto* position = model_.find(ParameterKind::PointPosition, index);
    const auto* albedo = model_.find(ParameterKind::PointAlbedo, index);
    const auto* time_zero = model_.find(ParameterKind::TimeZero);
    const auto* width = model_.find(ParameterKind::ResponseWidth);
    const auto columns = static_cast<std::size_t>(model_.num_columns());
    for (std::size_t b = 0; b < bins.bins.size(); ++b) {
        const auto& s = bins.bins[b].slots;
        const std::size_t bin = static_cast<std::size_t>(bins.first_bin) + b;
        result.mean[bin] += s[0];
        if (slopes_ == Slopes::Without) continue;
        double* row = result.slopes.data() + bin * columns;
        const double by_opl = s[1] + s[2] + s[3];
        const double by_factor = constant * (s[4] + s[5] + s[6]);
        for (int a = 0; a < 3; ++a) {
            row[position->first_column + a] +=
                by_opl * path.opl_by_position[a] + by_factor * path.factor_by_position[a];
        }
        row[albedo->first_column] += s[0];
        if (time_zero != nullptr) row[time_zero->first_column] += by_opl;
        if (width != nullptr) row[width->first_column] += width_share_ * s[7];
        for (const std::size_t w : {0UL, 1UL}) {
            const auto* block =
                model_.find(w == 0 ? ParameterKind::WallBow : ParameterKind::WallScale);
            if (block == nullptr) continue;
            row[block->first_column] +=
                by_opl * path.opl_by_wall[w] + by_factor * path.factor_by_wall[w];
        }
    }
}

}  // namespace calib
