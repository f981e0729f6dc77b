// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/ground_truth.h"

#include <string>

namespace apps {

/// A scene file, loaded to be looked at.
class SceneTruth {
 public:
    /// throws   core::Error as reading does, and when the scene has a camera and no relay wall
    explicit SceneTruth(const std::string& scene_path)
        : SceneTruth(renderer::read_scene_description(scene_path, {}), scene_path) {}

    /// A scene that is described and has its geometry.
    SceneTruth(renderer::SceneDescription description, renderer::SceneGeometry geometry)
        : description_(std::move(description)),
          scene_(renderer::make_scene(
              std::move(geometry), description_, renderer::make_scan(description_))) {
        require_wall("scene");
    }

    /// What the whole wall sees, at the scene's own resolution.
    core::DepthMap depth_map() const { return renderer::trace_ground_truth(scene_, description_); }

    /// The surface that the whole wall sees, to score points with.
    core::TrueSurface surface() const { return renderer::trace_true_surface(scene_, description_); }

    /// What is seen from the columns of a volume or of a depth map, to score it.
    template <class Columns>
    core::TrueSurface surface(const Columns& columns) const {
        return renderer::trace_true_surface(
            scene_, description_, columns.world_from_wall, columns.x_m, columns.y_m);
    }

 private:
    SceneTruth(renderer::SceneDescription description, const std::string& name)
        : description_(std::move(description)),
          scene_(renderer::load_scene(description_, renderer::make_scan(description_))) {
        require_wall(name);
    }

    void require_wall(const std::string& name) const {
        if (!description_.camera) return;
        throw core::Error(name,
                          "found a camera in place of a relay wall",
                          "must have a relay wall, from which depth is seen");
    }

    renderer::SceneDescription description_;
    renderer::Scene scene_;
};

}  // namespace apps
