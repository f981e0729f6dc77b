// SPDX-License-Identifier: MIT
// What one element or point adds to one pair: the chain rule from wall points, corners and normals
// to the knots of the kernel.
#include "calib/forward/forward_model.h"
#include "calib/forward/knot_derivatives.h"
#include "calib/forward/path_segments.h"

#include <array>
#include <cmath>
#include <vector>

namespace calib {
namespace {

using core::Vec3;
using renderer::Gradients;

enum class SegmentPair { Retroreflected, Confocal, Apart };

// Paths by way of an element's nodes.
// Returns false where one of the wall points looks at the element's back.
bool find_paths(const PathEndpoints& ends,
                const std::array<Vec3, 6>& nodes,
                const Vec3& normal,
                SegmentPair segments,
                Gradients gradients,
                std::array<Path, 6>& paths) {
    for (std::size_t i = 0; i < 6; ++i) {
        const Segment sensor = make_segment(*ends.sensor, nodes[i], normal, gradients);
        if (segments == SegmentPair::Retroreflected) {
            paths[i] = retroreflected(sensor, gradients);
        } else if (segments == SegmentPair::Confocal) {
            paths[i] = join_segments(sensor, sensor, gradients);
        } else {
            const Segment light = make_segment(*ends.light, nodes[i], normal, gradients);
            if (light.side != sensor.side) return false;
            paths[i] = join_segments(light, sensor, gradients);
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

}  // namespace

// What shifts time and widens the response changes every element alike.
//
// factors   columns of what multiplies this element or point alone
void ForwardModel::add_gradients(const renderer::TriangleBins& bins,
                                 const std::vector<ColumnChange>& changes,
                                 const std::vector<int>& factors,
                                 PairModel& result) const {
    const auto first = static_cast<std::size_t>(bins.first_bin);
    const auto columns = static_cast<std::size_t>(model_.num_columns());
    for (std::size_t b = 0; b < bins.bins.size(); ++b) {
        const auto& s = bins.bins[b].slots;
        double* row = result.gradients.data() + (first + b) * columns;
        for (const auto& [column, change] : changes) {
            row[column] += s[1] * change.opl[0] + s[2] * change.opl[1] + s[3] * change.opl[2] +
                           s[4] * change.weight[0] + s[5] * change.weight[1] +
                           s[6] * change.weight[2];
        }
        for (const int column : factors) row[column] += s[0];
        for (const int column : columns_.time_shifts) row[column] += s[1] + s[2] + s[3];
        for (const int column : columns_.widths) row[column] += width_fraction_ * s[7];
    }
}

void ForwardModel::add_element(const PosedElement& element,
                               renderer::VisibilityMask mask,
                               std::size_t pair,
                               PairModel& result) const {
    const PathEndpoints ends{&moved_points_[light_index(pair)], &moved_points_[sensor_index(pair)]};
    const bool is_confocal = scan_.pattern == core::ScanPattern::Confocal;
    if (element.is_retroreflective && !is_confocal) return;
    const SegmentPair segments = element.is_retroreflective ? SegmentPair::Retroreflected
                                 : is_confocal              ? SegmentPair::Confocal
                                                            : SegmentPair::Apart;
    std::array<Path, 6> paths;
    if (!find_paths(ends, element.nodes, element.normal, segments, gradients_, paths)) return;
    const KnotFit fit = fit_knots(paths, time_shift_m_ + settings_.offset_m[pair], element.weight);
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
        changes.push_back({column, fit.change(opl, weight)});
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
    for (const auto& [column, index] : columns_.wall) {
        std::array<PathChange, 6> by_wall;
        for (std::size_t i = 0; i < 6; ++i) by_wall[i] = paths[i].by_wall(ends, index);
        add_change(
            column,
            [&](std::size_t i) { return by_wall[i].opl; },
            [&](std::size_t i) { return by_wall[i].factor; });
    }
    add_gradients(bins, changes, *element.factor_columns, result);
}

void ForwardModel::add_point(std::size_t index, std::size_t pair, PairModel& result) const {
    const PathEndpoints ends{&moved_points_[light_index(pair)], &moved_points_[sensor_index(pair)]};
    const PointState& point = state_.points[index];
    Segment light = make_point_segment(*ends.light, point.position_m);
    Segment sensor = make_point_segment(*ends.sensor, point.position_m);
    light.by_normal = sensor.by_normal = Vec3::Zero();
    const Path path = join_segments(light, sensor, Gradients::With);
    const double constant = point_factors_[index] * settings_.radiance_factor;
    const double opl = path.opl + time_shift_m_ + settings_.offset_m[pair];

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
        changes.push_back({column, {{by_opl, by_opl, by_opl}, {by_weight, by_weight, by_weight}}});
    };
    const PointColumns& own = columns_.points[index];
    for (int a = 0; a < 3; ++a) {
        add_change(own.position + a, path.opl_by_position[a], path.factor_by_position[a]);
    }
    for (const auto& [column, wall] : columns_.wall) {
        const PathChange change = path.by_wall(ends, wall);
        add_change(column, change.opl, change.factor);
    }
    add_gradients(bins, changes, own.factors, result);
}

}  // namespace calib
