// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/render.h"
#include "renderer/scene_file.h"

#include <string>
#include <vector>

namespace apps {

/// A scene that benchmarks render again and again with other settings.
class BenchScene {
 public:
    /// overrides   `key.path=value` texts for the scene description
    explicit BenchScene(const std::string& scene_path,
                        const std::vector<std::string>& overrides = {})
        : description_(renderer::read_scene_description(scene_path, overrides)),
          scan_(renderer::make_scan(description_)),
          scene_(renderer::load_scene(description_, scan_)) {}

    const renderer::RenderSettings& settings() const { return description_.render; }
    const core::TimeAxis& axis() const { return description_.time_axis; }
    const core::Scan& scan() const { return scan_; }
    const renderer::Scene& scene() const { return scene_; }

    core::Capture render(const core::TimeAxis& axis,
                         const renderer::RenderSettings& settings) const {
        return renderer::render(scene_, scan_, axis, settings, {}).capture;
    }
    core::Capture render(const renderer::RenderSettings& settings) const {
        return render(axis(), settings);
    }

 private:
    renderer::SceneDescription description_;
    core::Scan scan_;
    renderer::Scene scene_;
};

}  // namespace apps
