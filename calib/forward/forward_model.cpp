// SPDX-License-Identifier: MIT
#include "calib/forward/forward_model.h"

#include "calib/forward/model_elements.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace calib {
namespace {

using core::Vec3;
using renderer::Gradients;

// A measured response is applied to bins this much finer than the data's.
constexpr int kOversampling = 3;

std::vector<int> columns_of(const SceneModel& model, Owner owner, std::size_t item, Effect effect) {
    std::vector<int> columns;
    for (const ParameterBlock* block : model.find(owner, item, effect)) {
        columns.push_back(block->first_column);
    }
    return columns;
}

// Of each one's light: that of its own, and what scales all of it.
template <class Item>
std::vector<double> factors_of(const SceneState& state,
                               Owner owner,
                               const std::vector<Item>& items) {
    const double log_scale = sum_of(state, Owner::Scene, 0, Effect::Multiplies);
    std::vector<double> factors;
    for (std::size_t i = 0; i < items.size(); ++i) {
        factors.push_back(std::exp(sum_of(state, owner, i, Effect::Multiplies) + log_scale));
    }
    return factors;
}

}  // namespace

ForwardModel::Columns::Columns(const SceneModel& model)
    : time_shifts(columns_of(model, Owner::Scene, 0, Effect::ShiftsTime)),
      widths(columns_of(model, Owner::Scene, 0, Effect::WidensResponse)),
      scales(columns_of(model, Owner::Scene, 0, Effect::Multiplies)) {
    std::size_t index = 0;
    for (const Parameter* row : parameters()) {
        if (row->effect != Effect::MovesWall) continue;
        if (const auto* block = model.find(*row)) wall.emplace_back(block->first_column, index);
        ++index;
    }
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
        bodies.push_back(columns_of(model, Owner::Body, b, Effect::Multiplies));
    }
    for (std::size_t i = 0; i < model.num_points(); ++i) {
        points.push_back({columns_of(model, Owner::Point, i, Effect::Translates).front(),
                          columns_of(model, Owner::Point, i, Effect::Multiplies)});
    }
}

ForwardModel::ForwardModel(const SceneModel& model,
                           core::WallScan scan,
                           const WallMotion& wall,
                           ForwardSettings settings)
    : model_(model),
      columns_(model),
      scan_(std::move(scan)),
      settings_(std::move(settings)),
      wall_(wall) {
    wall_points_ = scan_.sensing;
    wall_points_.grid.reset();
    if (scan_.pattern != core::ScanPattern::Confocal) {
        const auto append = [](auto& list, const auto& more) {
            list.insert(list.end(), more.begin(), more.end());
        };
        append(wall_points_.positions, scan_.illumination.positions);
        append(wall_points_.normals, scan_.illumination.normals);
    }
    if (!settings_.measured) return;
    oversampling_ = kOversampling;
    const core::ResponseFilter filter =
        core::sample_response(*settings_.measured, settings_.axis.bin_width_m / oversampling_);
    first_delay_ = filter.first_delay;
    const int taps = static_cast<int>(filter.weights.size());
    const int reach = std::max(std::abs(first_delay_), std::abs(first_delay_ + taps));
    margin_ = (reach / oversampling_ + 1) * oversampling_;
    for (int phase = 0; phase < oversampling_; ++phase) {
        auto& weights = phase_weights_.emplace_back((taps + phase) / oversampling_ + 1, 0.0);
        for (int k = 0; k < taps; ++k) {
            weights[static_cast<std::size_t>((k + phase) / oversampling_)] +=
                filter.weights[static_cast<std::size_t>(k)];
        }
    }
}

core::TimeAxis ForwardModel::fine_axis() const {
    core::TimeAxis axis = settings_.axis;
    axis.bin_width_m /= oversampling_;
    axis.num_bins = axis.num_bins * oversampling_ + 2 * margin_;
    axis.opl_start_m -= margin_ * axis.bin_width_m;
    return axis;
}

void ForwardModel::refresh(const SceneState& state) {
    // A response narrower than half a bin asks for no more than the bins do.
    const double half_bin_m = 0.5 * settings_.axis.bin_width_m;
    const double smear = settings_.measured ? half_bin_m : std::max(half_bin_m, settings_.sigma_m);
    const auto old_masks = std::exchange(masks_, {});
    edge_gradients_.clear();
    elements_ = cut_elements(model_, state, scan_, smear, settings_.tolerance);
    if (!is_planar(model_, state)) masks_ = trace(state);
    visibility_changed_ = old_masks != masks_;
}

void ForwardModel::update(const SceneState& state, Gradients gradients) {
    state_ = state;
    gradients_ = gradients;
    time_shift_m_ = sum_of(state, Owner::Scene, 0, Effect::ShiftsTime);
    ambient_ = added_light(state) * settings_.bins_per_ambient;
    body_factors_ = factors_of(state, Owner::Body, state.bodies);
    point_factors_ = factors_of(state, Owner::Point, state.points);
    const double width = std::exp(sum_of(state, Owner::Scene, 0, Effect::WidensResponse));
    const double response2 =
        settings_.response_fraction * settings_.sigma_m * settings_.sigma_m * width * width;
    const double blur2 =
        (1.0 - settings_.response_fraction) * settings_.sigma_m * settings_.sigma_m;
    sigma_m_ = settings_.measured ? 0.0 : std::sqrt(response2 + blur2);
    width_fraction_ = sigma_m_ > 0.0 ? response2 / (response2 + blur2) : 0.0;
    moved_points_ = wall_.moved(wall_points_, state);
    posed_.clear();
    posed_.reserve(elements_.size());
    FacetMotion motion;
    for (std::size_t i = 0; i < elements_.size(); ++i) {
        if (i == 0 || elements_[i].facet != elements_[i - 1].facet) {
            motion = model_.motion(state, elements_[i].facet);
        }
        posed_.push_back(pose(elements_[i], motion));
    }
}

ForwardModel::PosedElement ForwardModel::pose(const ModelElement& element,
                                              const FacetMotion& motion) const {
    const ModelFacet& facet = model_.facets()[element.facet];
    const Vec3 edge1 = motion.corners[1] - motion.corners[0];
    const Vec3 edge2 = motion.corners[2] - motion.corners[0];
    const Vec3 across = edge1.cross(edge2);
    const double norm = across.norm();
    PosedElement posed;
    posed.normal = across / norm;
    posed.is_retroreflective = facet.is_retroreflective;
    posed.weight = 0.5 * norm * element.area_fraction * facet.albedo_ratio *
                   body_factors_[facet.body] * settings_.radiance_factor;
    if (posed.is_retroreflective) posed.weight *= core::kPi / settings_.spot_m2;
    const auto interpolate = [&](const std::array<Vec3, 3>& corners, std::array<Vec3, 6>& nodes) {
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3& b = element.barycentric[i];
            nodes[i] = b[0] * corners[0] + b[1] * corners[1] + b[2] * corners[2];
        }
        for (std::size_t i = 0; i < 3; ++i) nodes[3 + i] = 0.5 * (nodes[i] + nodes[(i + 1) % 3]);
    };
    interpolate(motion.corners, posed.nodes);
    if (gradients_ == Gradients::Without) return posed;

    posed.factor_columns = &columns_.bodies[facet.body];
    posed.columns = motion.columns;
    for (const auto& corners : motion.by_column) {
        interpolate(corners, posed.node_gradients.emplace_back());
        const Vec3 change =
            (corners[1] - corners[0]).cross(edge2) + edge1.cross(Vec3(corners[2] - corners[0]));
        const double along = posed.normal.dot(change) / norm;
        posed.normal_gradients.push_back(change / norm - along * posed.normal);
        posed.log_area_gradients.push_back(along);
    }
    return posed;
}

std::size_t ForwardModel::light_index(std::size_t pair) const {
    const std::size_t first =
        scan_.pattern == core::ScanPattern::Confocal ? 0 : scan_.sensing.size();
    return first + scan_.illumination_index(pair);
}

renderer::VisibilityMask ForwardModel::visible_part(const Masks& masks,
                                                    std::size_t element,
                                                    std::size_t pair) const {
    if (masks.empty()) return renderer::kAllVisible;
    return masks[light_index(pair) * elements_.size() + element] &
           masks[sensor_index(pair) * elements_.size() + element];
}

void ForwardModel::evaluate(std::size_t pair, PairModel& result) const {
    thread_local PairModel fine;
    const bool is_filtered = settings_.measured.has_value();
    PairModel& target = is_filtered ? fine : result;
    const auto bins = static_cast<std::size_t>(fine_axis().num_bins);
    const auto columns = static_cast<std::size_t>(model_.num_columns());
    target.mean.assign(bins, 0.0);
    target.gradients.assign(gradients_ == Gradients::With ? bins * columns : 0, 0.0);
    for (std::size_t i = 0; i < posed_.size(); ++i) {
        const renderer::VisibilityMask mask = visible_part(masks_, i, pair);
        if (mask != 0) add_element(posed_[i], mask, pair, target);
    }
    for (std::size_t i = 0; i < state_.points.size(); ++i) add_point(i, pair, target);
    finish(target, result);
    if (gradients_ == Gradients::With) add_shadow_edges(pair, result);
}

// Every fine bin's light goes to the bins that the response delays it to.
void ForwardModel::add_response(const PairModel& fine, PairModel& result) const {
    const bool with_gradients = gradients_ == Gradients::With;
    const auto columns = static_cast<std::size_t>(model_.num_columns());
    const auto bins = static_cast<std::size_t>(settings_.axis.num_bins);
    result.mean.assign(bins, 0.0);
    result.gradients.assign(with_gradients ? bins * columns : 0, 0.0);
    for (std::size_t f = 0; f < fine.mean.size(); ++f) {
        if (fine.mean[f] == 0.0) continue;
        // Counted from far enough ahead of the axis to divide without sign.
        const int from = static_cast<int>(f) + first_delay_ + margin_;
        const auto& weights = phase_weights_[static_cast<std::size_t>(from % oversampling_)];
        const int first_bin = from / oversampling_ - 2 * margin_ / oversampling_;
        const int begin = std::max(0, -first_bin);
        const int end =
            std::min(static_cast<int>(weights.size()), settings_.axis.num_bins - first_bin);
        for (int k = begin; k < end; ++k) {
            const double weight = weights[static_cast<std::size_t>(k)];
            const auto b = static_cast<std::size_t>(first_bin + k);
            result.mean[b] += weight * fine.mean[f];
            if (!with_gradients) continue;
            const double* row = fine.gradients.data() + f * columns;
            double* target = result.gradients.data() + b * columns;
            for (std::size_t c = 0; c < columns; ++c) target[c] += weight * row[c];
        }
    }
}

// Signal becomes data: scale, response, ambient light.
void ForwardModel::finish(PairModel& fine, PairModel& result) const {
    const auto columns = static_cast<std::size_t>(model_.num_columns());
    const bool with_gradients = gradients_ == Gradients::With;
    for (std::size_t b = 0; b < fine.mean.size() && with_gradients; ++b) {
        for (const int column : columns_.scales) {
            fine.gradients[b * columns + static_cast<std::size_t>(column)] = fine.mean[b];
        }
    }
    if (settings_.measured) add_response(fine, result);
    for (double& value : result.mean) value += ambient_;
    if (!with_gradients) return;
    for (const ParameterBlock* block : model_.find(Owner::Scene, 0, Effect::AddsLight)) {
        const double light = std::exp(block->row->numbers(state_)[0]) * settings_.bins_per_ambient;
        for (std::size_t b = 0; b < result.mean.size(); ++b) {
            result.gradients[b * columns + static_cast<std::size_t>(block->first_column)] = light;
        }
    }
}

}  // namespace calib
