// SPDX-License-Identifier: MIT
#include "calib/model/parameter.h"

#include <cmath>

namespace calib {
namespace {

Numbers& numbers_of(SceneState& state, Owner owner, std::size_t item) {
    if (owner == Owner::Body) return state.bodies[item].numbers;
    return owner == Owner::Point ? state.points[item].numbers : state.numbers;
}

}  // namespace

std::span<double> Parameter::numbers(SceneState& state, std::size_t item) const {
    if (storage != nullptr) return storage(state, item);
    return {&numbers_of(state, owner, item).try_emplace(name, fixed).first->second, 1};
}

std::span<const double> Parameter::numbers(const SceneState& state, std::size_t item) const {
    auto& changeable = const_cast<SceneState&>(state);  // only looked at
    if (storage != nullptr) return storage(changeable, item);
    const Numbers& known = numbers_of(changeable, owner, item);
    const auto it = known.find(name);
    return {it == known.end() ? &fixed : &it->second, 1};
}

Estimate Parameter::estimate(double number, double sigma, const FitSettings& settings) const {
    const double one = unit == nullptr ? 1.0 : unit(settings);
    const double value = one * (is_logarithm ? std::exp(number) : number);
    return {value, (is_logarithm ? value : one) * sigma};
}

double sum_of(const SceneState& state, Owner owner, std::size_t item, Effect effect) {
    double sum = 0.0;
    for (const Parameter* row : parameters()) {
        if (row->owner == owner && row->effect == effect) sum += row->numbers(state, item)[0];
    }
    return sum;
}

double added_light(const SceneState& state) {
    double light = 0.0;
    for (const Parameter* row : parameters()) {
        if (row->effect == Effect::AddsLight) light += std::exp(row->numbers(state)[0]);
    }
    return light;
}

SceneState without_added_light(SceneState state) {
    for (const Parameter* row : parameters()) {
        if (row->effect != Effect::AddsLight) continue;
        row->numbers(state)[0] = -std::numeric_limits<double>::infinity();
    }
    return state;
}

}  // namespace calib
