// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/path/path_vertex.h"
#include "renderer/scene/scene.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace renderer {

/// Bounces of the shortest paths that a scan samples.
int first_order(const core::Scan& scan);

/// Where the light paths of a scan's pairs start and end.
///
/// Paths of a wall pair connect two wall points. Paths of a pixel start at the surface point seen
/// through it and end at the camera's light. A lit spot counts as a bounce, like the laser spot of
/// a scan; the camera and a point light do not.
class SensorPairs {
 public:
    /// Both must outlive this.
    /// throws   core::Error when the spot of a camera's light lies on no surface
    SensorPairs(const Scene& scene, const core::Scan& scan);
    SensorPairs(const Scene& scene, core::Scan&& scan) = delete;

    std::size_t num_pairs() const { return scan_->num_pairs(); }
    bool is_image() const { return camera_ != nullptr; }
    const core::PinholeCamera& camera() const { return *camera_; }  ///< of an image

    int first_order() const { return renderer::first_order(*scan_); }

    /// The fixed ends of a pair's paths; the sensor of a pixel is the pinhole.
    PathEndpoints ends(std::size_t pair) const;

    /// The first vertex of a pixel's paths: the surface point seen through a point of the pixel.
    ///
    /// u         uniform in [0, 1)^2: the position within the pixel
    /// returns   a vertex of throughput 1, so that the pixel's radiance is the mean over u of the
    ///           radiance that leaves it towards the camera; nothing when the ray leaves the scene
    std::optional<PathVertex> first_vertex(std::size_t pixel, const core::Vec2& u) const;

    /// The same for at most kAtOnce points of a pixel: appends the vertices that there are.
    void find_first_vertices(std::size_t pixel,
                             std::span<const core::Vec2> u,
                             std::vector<PathVertex>& vertices) const;
    static constexpr int kAtOnce = DirectionPacket::kSize;

 private:
    core::Vec3 direction_through(std::size_t pixel, const core::Vec2& u) const;
    PathVertex seen_vertex(const SurfacePoint& point, const core::Vec3& direction) const;
    PathEndpoint spot_light(const core::Vec3& spot) const;

    const Scene* scene_;
    const core::Scan* scan_;
    const core::WallScan* wall_ = nullptr;         ///< what the scan is of: either this
    const core::PinholeCamera* camera_ = nullptr;  ///< or this
    PathEndpoint light_;                           ///< of images
    core::Mat3 world_from_image_ = core::Mat3::Identity();
};

}  // namespace renderer
