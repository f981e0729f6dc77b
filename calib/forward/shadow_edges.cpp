// SPDX-License-Identifier: MIT
// Which parts of the elements the wall points see, and the derivatives of the data by the motion of
// shadow edges; fit/solution.h says what they are for.
//
// Visibility is resolved to a quarter of an element's edge, so the data jump as a shadow moves.
// Central differences over about that length, with everything but visibility held fixed, smooth the
// jumps.
#include "calib/forward/forward_model.h"
#include "calib/forward/model_elements.h"
#include "calib/model/state_vector.h"
#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace calib {
namespace {

using core::Vec3;

// Difference steps move no vertex farther than this fraction of an element's mean edge.
constexpr double kStepPerEdge = 0.25;

}  // namespace

ForwardModel::Masks ForwardModel::trace(const SceneState& state) const {
    return trace_masks(model_, state, elements_, scan_, wall_.moved_points(wall_points_, state));
}

bool ForwardModel::has_shadow_edges() const {
    return std::any_of(masks_.begin(), masks_.end(), [](renderer::VisibilityMask mask) {
        return mask != 0 && mask != renderer::kAllVisible;
    });
}

// Per column, how far the fastest vertex or wall point moves per unit of the parameter.
std::vector<double> ForwardModel::vertex_speeds(const SceneState& state) const {
    std::vector<double> speeds(static_cast<std::size_t>(model_.num_columns()), 0.0);
    const auto add = [&](int column, const Vec3& gradient) {
        double& speed = speeds[static_cast<std::size_t>(column)];
        speed = std::max(speed, gradient.norm());
    };
    for (std::size_t f = 0; f < model_.facets().size(); ++f) {
        const FacetMotion motion = model_.motion(state, f);
        for (std::size_t c = 0; c < motion.columns.size(); ++c) {
            for (const Vec3& gradient : motion.by_column[c]) add(motion.columns[c], gradient);
        }
    }
    for (const MovedWallPoint& p : wall_.moved(scan_.sensing, state)) {
        for (const auto& [column, index] : columns_.wall) add(column, p.gradients[index].position);
    }
    return speeds;
}

std::vector<double> ForwardModel::change_of_light(const Masks& from, const Masks& to) const {
    const auto bins = static_cast<std::size_t>(settings_.axis.num_bins);
    const auto fine_bins = static_cast<std::size_t>(fine_axis().num_bins);
    std::vector<double> changes(scan_.num_pairs() * bins);
    core::parallel_for(scan_.num_pairs(), [&](std::size_t pair) {
        thread_local PairModel before;
        thread_local PairModel after;
        thread_local PairModel filtered;
        before.mean.assign(fine_bins, 0.0);
        after.mean.assign(fine_bins, 0.0);
        for (std::size_t i = 0; i < posed_.size(); ++i) {
            const renderer::VisibilityMask was = visible_part(from, i, pair);
            const renderer::VisibilityMask is = visible_part(to, i, pair);
            if (was == is) continue;
            if (was != 0) add_element(posed_[i], was, pair, before);
            if (is != 0) add_element(posed_[i], is, pair, after);
        }
        std::transform(after.mean.begin(),
                       after.mean.end(),
                       before.mean.begin(),
                       after.mean.begin(),
                       std::minus<>());
        if (settings_.measured) add_response(after, filtered);
        const std::vector<double>& change = settings_.measured ? filtered.mean : after.mean;
        std::copy(change.begin(),
                  change.end(),
                  changes.begin() + static_cast<std::ptrdiff_t>(pair * bins));
    });
    return changes;
}

void ForwardModel::find_shadow_edges(const SceneState& state) {
    edge_gradients_.clear();
    if (!has_shadow_edges()) return;
    update(state, renderer::Gradients::Without);
    double area = 0.0;
    for (const ModelElement& element : elements_) {
        const auto corners = model_.motion(state, element.facet).corners;
        area +=
            (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() * element.area_fraction;
    }
    const double edge_m = std::sqrt(area / static_cast<double>(elements_.size()));
    const std::vector<double> speeds = vertex_speeds(state);
    const auto columns = speeds.size();
    std::vector<double> gradients;
    for (std::size_t column = 0; column < columns; ++column) {
        if (!(speeds[column] > 0.0)) continue;
        Eigen::VectorXd step = Eigen::VectorXd::Zero(model_.num_columns());
        double& size = step[static_cast<Eigen::Index>(column)];
        size = kStepPerEdge * edge_m / speeds[column];
        const std::vector<double> changes = change_of_light(trace(moved_by(model_, state, -step)),
                                                            trace(moved_by(model_, state, step)));
        gradients.resize(changes.size() * columns, 0.0);
        for (std::size_t i = 0; i < changes.size(); ++i) {
            gradients[i * columns + column] = changes[i] / (2.0 * size);
        }
    }
    edge_gradients_ = std::move(gradients);
}

void ForwardModel::add_shadow_edges(std::size_t pair, PairModel& result) const {
    if (edge_gradients_.empty()) return;
    const double* edges = edge_gradients_.data() + pair * result.gradients.size();
    for (std::size_t i = 0; i < result.gradients.size(); ++i) result.gradients[i] += edges[i];
}

}  // namespace calib
