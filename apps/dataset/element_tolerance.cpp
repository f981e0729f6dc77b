// SPDX-License-Identifier: MIT
#include "apps/dataset/element_tolerance.h"

#include "nlos/compare/compare.h"
#include "renderer/core/system/parallel.h"
#include "renderer/render.h"

#include <algorithm>
#include <array>

namespace apps {
namespace {

constexpr std::array kTolerances{32.0, 16.0, 8.0, 4.0, 2.0, 1.0, 0.5};  // by target error
constexpr double kReferenceFraction = 0.2;
constexpr double kAllowedFraction = 0.75;
constexpr int kMostPointsPerSide = 6;

using Errors = std::array<double, kTolerances.size()>;

bool may_calibrate(const Recipe& recipe) {
    const renderer::RenderSettings& render = recipe.scene.render;
    const bool draws_render =
        std::any_of(recipe.draw.begin(), recipe.draw.end(), [](const auto& entry) {
            return entry.first.starts_with("scene.render");
        });
    return recipe.calibration_items > 0 && render.target_error &&
           renderer::traits_of(render.method).integrates && render.max_bounces == 3 &&
           !draws_render;
}

core::Capture render_with(const renderer::Scene& scene,
                          const core::Scan& scan,
                          const renderer::SceneDescription& description,
                          std::optional<double> target_error,
                          std::optional<double> element_tolerance) {
    renderer::RenderSettings settings = description.render;
    settings.target_error = target_error;
    settings.element_tolerance = element_tolerance;
    return renderer::render(scene, scan, {description.time_axis, std::nullopt}, settings, {})
        .capture;
}

Errors errors_of_item(const Recipe& recipe, MeshLibrary& meshes, std::uint64_t item) {
    ItemPlan plan = plan_item(recipe, meshes, item);
    renderer::SceneDescription& description = plan.settings.scene;
    for (int& count : description.scan.sensing_points) count = std::min(count, kMostPointsPerSide);
    const core::Scan scan = renderer::make_scan(description);
    const renderer::Scene scene = renderer::make_scene(geometry_of(plan), description, scan);
    const double target = *recipe.scene.render.target_error;
    const core::Capture reference =
        render_with(scene, scan, description, kReferenceFraction * target, std::nullopt);
    Errors errors{};
    for (std::size_t i = 0; i < kTolerances.size(); ++i) {
        const core::Capture capture =
            render_with(scene, scan, description, std::nullopt, kTolerances[i] * target);
        errors[i] = nlos::compare_captures(capture, reference).rel_l2.value_or(0.0);  // none: dark
    }
    return errors;
}

}  // namespace

std::optional<double> find_element_tolerance(const Recipe& recipe,
                                             MeshLibrary& meshes,
                                             const core::Progress& progress) {
    if (!may_calibrate(recipe)) return std::nullopt;
    std::vector<Errors> errors(recipe.calibration_items);
    core::parallel_for(errors.size(), [&](std::size_t item) {
        if (progress.should_stop()) return;
        core::run_on_one_thread([&] { errors[item] = errors_of_item(recipe, meshes, item); });
    });
    if (progress.should_stop()) {
        throw core::Failure("generate", "interrupted before the first item");
    }
    const double target = *recipe.scene.render.target_error;
    for (std::size_t i = 0; i < kTolerances.size(); ++i) {
        const bool holds = std::all_of(errors.begin(), errors.end(), [&](const Errors& of_item) {
            return of_item[i] <= kAllowedFraction * target;
        });
        if (holds) return kTolerances[i] * target;
    }
    return std::nullopt;
}

}  // namespace apps
