// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/compare/compare.h"
#include "renderer/core/system/data_folder.h"
#include "renderer/render.h"
#include "renderer/scene/scene_file.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

namespace apps {

/// The description of a scene, which may be one that comes with the program.
///
/// overrides   `key.path=value` texts for it
inline renderer::SceneDescription read_bench_scene(const std::string& path,
                                                   const std::vector<std::string>& overrides) {
    return renderer::read_scene_description(core::shipped_file(path), overrides);
}

/// A scene that benchmarks render again and again with other settings.
class BenchScene {
 public:
    /// overrides   `key.path=value` texts for the scene description
    explicit BenchScene(const std::string& scene_path,
                        const std::vector<std::string>& overrides = {})
        : description_(read_bench_scene(scene_path, overrides)),
          scan_(renderer::make_scan(description_)),
          scene_(renderer::load_scene(description_, scan_)) {}

    const renderer::SceneDescription& description() const { return description_; }
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
    core::Capture render() const { return render(settings()); }

 private:
    renderer::SceneDescription description_;
    core::Scan scan_;
    renderer::Scene scene_;
};

/// What an estimator of its own computed, as a capture.
inline core::Capture capture_of(const core::Scan& scan,
                                const core::TimeAxis& axis,
                                const core::Transient& transient) {
    core::Capture capture;
    capture.scan = scan;
    capture.time_axis = axis;
    capture.transient = transient;
    return capture;
}

/// Relative L2 distance of one capture from another.
inline double relative_l2(const core::Capture& a, const core::Capture& b) {
    return nlos::compare_captures(a, b).rel_l2.value_or(0.0);
}

/// Photons of a whole capture whose brightest bin expects so many.
inline double photons_for_peak(const core::Capture& capture, double peak_counts) {
    const auto values = capture.transient.values();
    const double sum = std::accumulate(values.begin(), values.end(), 0.0);
    return peak_counts * sum / double{*std::max_element(values.begin(), values.end())};
}

/// The bin in which this fraction of the capture's light has arrived.
inline int bin_of_fraction(const core::Capture& capture, double fraction) {
    std::vector<double> arrived(static_cast<std::size_t>(capture.transient.num_bins()));
    const auto values = capture.transient.values();
    for (std::size_t i = 0; i < values.size(); ++i) {
        arrived[i % arrived.size()] += double{values[i]};
    }
    std::partial_sum(arrived.begin(), arrived.end(), arrived.begin());
    const auto bin = std::lower_bound(arrived.begin(), arrived.end(), fraction * arrived.back());
    return static_cast<int>(bin - arrived.begin());
}

}  // namespace apps
