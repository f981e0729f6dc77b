// SPDX-License-Identifier: MIT
// What one element or point adds to one pair: the chain rule from wall points, corners and normals
// to the knots of the kernel.
#include "calib/forward/forward_model.h"
#include "calib/forward/knot_changes.h"
#include "calib/forward/path_legs.h"

#include <array>
#include <cmath>
#include <vector>

namespace calib {
namespace {

using core::Vec3;
using renderer::Gradients;

/// How a parameter changes the knots.
struct ColumnChange {
    std::size_t column;
    KnotChange change;
};

enum class LegPair { Retroreflected, Confocal, Apart };

// Paths by way of an element's nodes.
// Returns false where one of the wall points looks at the element's back.
bool find_paths(const PathEndpoints& ends,
                const std::array<Vec3, 6>& nodes,
                const Vec3& normal,
                LegPair legs,
                Gradients gradients,
                std::array<Path, 6>& paths) {
    for (std::size_t i = 0; i < 6; ++i) {
        const Leg sensor = make_leg(*ends.sensor, nodes[i], normal, gradients);
        if (legs == LegPair::Retroreflected) {
            paths[i] = retroreflected(ends, sensor, gradients);
        } else if (legs == LegPair::Confocal) {
            paths[i] = join_legs(ends, sensor, sensor, gradients);
        } else {
            const Leg light = make_leg(*ends.light, nodes[i], normal, gradients);
            if (light.side != sensor.side) return false;
            paths[i] = join_legs(ends, light, sensor, gradients);
        }
    }
    return true;
}

void add_means(const renderer::TriangleBins& bins, PairModel& result) {
    const auto first = static_cast<std::size_t>(bins.first_bin);
    for (std::size_t b = 0; b < bins.bins.size(); ++b) {
        result.mean[first + b] += bins.bins[b].slots[0];
    }
}

// Time zero and the response's width change every element alike.
//
// albedo_column   of the surface's or point's albedo; -1: fixed
void add_gradients(const SceneModel& model,
                   const renderer::TriangleBins& bins,
                   const std::vector<ColumnChange>& changes,
                   int albedo_column,
                   double width_share,
                   PairModel& result) {
    const auto* time_zero = model.find(ParameterKind::TimeZero);
    const auto* width = model.find(ParameterKind::ResponseWidth);
    const auto first = static_cast<std::size_t>(bins.first_bin);
    const auto columns = static_cast<std::size_t>(model.num_columns());
    for (std::size_t b = 0; b < bins.bins.size(); ++b) {
        const auto& s = bins.bins[b].slots;
        double* row = result.gradients.data() + (first + b) * columns;
        for (const auto& [column, change] : changes) {
            row[column] += s[1] * change.opl[0] + s[2] * change.opl[1] + s[3] * change.opl[2] +
                           s[4] * change.weight[0] + s[5] * change.weight[1] +
                           s[6] * change.weight[2];
        }
        if (albedo_column >= 0) row[albedo_column] += s[0];
        if (time_zero != nullptr) row[time_zero->first_column] += s[1] + s[2] + s[3];
        if (width != nullptr) row[width->first_column] += width_share * s[7];
    }
}

// Calls add(column, which) for what is free of the wall: which is 0 for its bow, 1 for its scale.
template <class Add>
void for_each_wall_parameter(const SceneModel& model, const Add& add) {
    for (const std::size_t which : {0UL, 1UL}) {
        const auto* block =
            model.find(which == 0 ? ParameterKind::WallBow : ParameterKind::WallScale);
        if (block != nullptr) add(block->first_column, which);
    }
}

}  // namespace

void ForwardModel::add_element(const PosedElement& element,
                               renderer::VisibilityMask mask,
                               std::size_t pair,
                               PairModel& result) const {
    const PathEndpoints ends{&moved_points_[light_index(pair)], &moved_points_[sensor_index(pair)]};
    const bool is_confocal = scan_.pattern == core::ScanPattern::Confocal;
    if (element.is_retroreflective && !is_confocal) return;
    const LegPair legs = element.is_retroreflective ? LegPair::Retroreflected
                         : is_confocal              ? LegPair::Confocal
                                                    : LegPair::Apart;
    std::array<Path, 6> paths;
    if (!find_paths(ends, element.nodes, element.normal, legs, gradients_, paths)) return;
    const KnotFit fit =
        fit_knots(paths, state_.time_zero_m + settings_.offset_m[pair], element.weight);
    const VisibleWeights visible(fit.knots().weight, mask);
    thread_local renderer::TriangleBins bins;
    renderer::evaluate_triangle(
        {fit.knots().opl_m, visible.values()}, sigma_m_, fine_axis(), gradients_, bins);
    add_means(bins, result);
    if (gradients_ == Gradients::Without || bins.bins.empty()) return;

    thread_local std::vector<ColumnChange> changes;
    changes.clear();
    const auto add_change = [&](int column, const auto& opl_gradient, const auto& factor_gradient) {
        std::array<double, 6> opl{};
        std::array<double, 6> weight{};
        for (std::size_t i = 0; i < 6; ++i) {
            opl[i] = opl_gradient(i);
            weight[i] = element.weight * factor_gradient(i);
        }
        changes.push_back({static_cast<std::size_t>(column), fit.change(opl, weight)});
        visible.convert_change(changes.back().change.weight);
    };
    for (std::size_t c = 0; c < element.columns.size(); ++c) {
        add_change(
            element.columns[c],
            [&](std::size_t i) {
                return paths[i].opl_by_position.dot(element.node_gradients[c][i]);
            },
            [&](std::size_t i) {
                return paths[i].factor_by_position.dot(element.node_gradients[c][i]) +
                       paths[i].factor_by_normal.dot(element.normal_gradients[c]) +
                       paths[i].factor * element.log_area_gradients[c];
            });
    }
    for_each_wall_parameter(model_, [&](int column, std::size_t which) {
        add_change(
            column,
            [&](std::size_t i) { return paths[i].opl_by_wall[which]; },
            [&](std::size_t i) { return paths[i].factor_by_wall[which]; });
    });
    add_gradients(model_, bins, changes, element.albedo_column, width_share_, result);
}

void ForwardModel::add_point(std::size_t index, std::size_t pair, PairModel& result) const {
    const PathEndpoints ends{&moved_points_[light_index(pair)], &moved_points_[sensor_index(pair)]};
    const PointState& point = state_.points[index];
    Leg light = make_point_leg(*ends.light, point.position_m);
    Leg sensor = make_point_leg(*ends.sensor, point.position_m);
    light.by_normal = sensor.by_normal = Vec3::Zero();
    const Path path = join_legs(ends, light, sensor, Gradients::With);
    const double constant =
        std::exp(point.log_albedo + state_.log_scale) * settings_.radiance_factor;
    const double opl = path.opl + state_.time_zero_m + settings_.offset_m[pair];

    // A triangle with equal knots is a point; without a response the kernel has no gradient there,
    // so that light is spread evenly over a bin.
    const core::TimeAxis axis = fine_axis();
    const double half = sigma_m_ > 0.0 ? 0.0 : 0.5 * axis.bin_width_m;
    thread_local renderer::TriangleBins bins;
    const double weight = constant * path.factor;
    renderer::evaluate_triangle({{opl - half, opl, opl + half}, {weight, weight, weight}},
                                sigma_m_,
                                axis,
                                gradients_,
                                bins);
    add_means(bins, result);
    if (gradients_ == Gradients::Without) return;

    std::vector<ColumnChange> changes;
    const auto add_change = [&](int column, double by_opl, double by_factor) {
        const double by_weight = constant * by_factor;
        changes.push_back({static_cast<std::size_t>(column),
                           {{by_opl, by_opl, by_opl}, {by_weight, by_weight, by_weight}}});
    };
    const int position = model_.find(ParameterKind::PointPosition, index)->first_column;
    for (int a = 0; a < 3; ++a) {
        add_change(position + a, path.opl_by_position[a], path.factor_by_position[a]);
    }
    for_each_wall_parameter(model_, [&](int column, std::size_t which) {
        add_change(column, path.opl_by_wall[which], path.factor_by_wall[which]);
    });
    const int albedo = model_.find(ParameterKind::PointAlbedo, index)->first_column;
    add_gradients(model_, bins, changes, albedo, width_share_, result);
}

}  // namespace calib
