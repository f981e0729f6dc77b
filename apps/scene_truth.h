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
        : description_(renderer::read_scene_description(scene_path, {})),
          scene_(renderer::load_scene(description_, renderer::make_scan(description_))) {
        if (!description_.camera) return;
        throw core::Error(scene_path,
                          "found a camera in place of a relay wall",
                          "must have a relay wall, from which depth is seen");
    }

    /// What the whole wall sees, at the scene's own resolution.
    core::DepthMap depth_map() const { return renderer::trace_ground_truth(scene_, description_); }

    /// What is seen from given columns of a frame, see renderer::trace_depth_map.
    core::DepthMap depth_map(const core::Transform& world_from_wall,
                             const std::vector<double>& x_m,
                             const std::vector<double>& y_m) const {
        return renderer::trace_depth_map(scene_, world_from_wall, x_m, y_m);
    }

 private:
    renderer::SceneDescription description_;
    renderer::Scene scene_;
};

}  // namespace apps
