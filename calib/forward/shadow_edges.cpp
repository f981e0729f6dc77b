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
#include "renderer/core/parallel.h"

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

using core::Vec3;

// Difference steps move no vertex farther than this share of an element's mean edge.
constexpr double kStepPerEdge = 0.25;

}  // namespace

void ForwardModel::trace(const SceneState& state) {
    masks_ = trace_masks(model_, state, elements_, scan_, wall_.moved_points(wall_points_, state));
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
    for (const std::size_t w : {0UL, 1UL}) {
        const auto* block = model_.find(w == 0 ? ParameterKind::WallBow : ParameterKind::WallScale);
        if (block == nullptr) continue;
        for (const MovedWallPoint& p : wall_.moved(scan_.sensing, state)) {
            add(block->first_column, p.position_gradient[w]);
        }
    }
    return speeds;
}

std::vector<double> ForwardModel::evaluate_all() const {
    const auto bins = static_cast<std::size_t>(settings_.axis.num_bins);
    std::vector<double> all(scan_.num_pairs() * bins);
    core::parallel_for(scan_.num_pairs(), [&](std::size_t pair) {
        thread_local PairModel one;
        evaluate(pair, one);
        std::copy(one.mean.begin(),
                  one.mean.end(),
                  all.begin() + static_cast<std::ptrdiff_t>(pair * bins));
    });
    return all;
}

void ForwardModel::find_shadow_edges(const SceneState& state) {
    edge_gradients_.clear();
    if (!has_shadow_edges()) return;
    update(state, renderer::Gradients::Without);
    double area = 0.0;
    for (const ModelElement& element : elements_) {
        const auto corners = model_.motion(state, element.facet).corners;
        area +=
            (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() * element.area_share;
    }
    const double edge_m = std::sqrt(area / static_cast<double>(elements_.size()));
    const std::vector<double> speeds = vertex_speeds(state);
    const auto masks = masks_;
    const auto columns = speeds.size();
    std::vector<double> gradients;
    for (std::size_t column = 0; column < columns; ++column) {
        if (!(speeds[column] > 0.0)) continue;
        Eigen::VectorXd step = Eigen::VectorXd::Zero(model_.num_columns());
        double& size = step[static_cast<Eigen::Index>(column)];
        size = kStepPerEdge * edge_m / speeds[column];
        trace(moved_by(model_, state, step));
        const std::vector<double> ahead = evaluate_all();
        trace(moved_by(model_, state, -step));
        const std::vector<double> behind = evaluate_all();
        gradients.resize(ahead.size() * columns, 0.0);
        for (std::size_t i = 0; i < ahead.size(); ++i) {
            gradients[i * columns + column] = (ahead[i] - behind[i]) / (2.0 * size);
        }
    }
    masks_ = masks;
    edge_gradients_ = std::move(gradients);
}

void ForwardModel::add_shadow_edges(std::size_t pair, PairModel& result) const {
    if (edge_gradients_.empty()) return;
    const double* edges = edge_gradients_.data() + pair * result.gradients.size();
    for (std::size_t i = 0; i < result.gradients.size(); ++i) result.gradients[i] += edges[i];
}

}  // namespace calib
