// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/film/pass_histogram.h"
#include "renderer/scene/scene.h"

#include <array>
#include <cstdint>

namespace renderer {

/// Paths that are whole but for the question whether two neighbours on them see each other. Shadow
/// rays are traced for many of them together; those in sight go into a histogram.
class ShadowRayQueue {
 public:
    /// Both must outlive this.
    ShadowRayQueue(const Scene& scene, PassHistogram& histogram)
        : scene_(scene), histogram_(histogram) {}

    /// One of the two neighbours: a point and its normal (unit).
    struct End {
        const core::Vec3& position;
        const core::Vec3& normal;
    };
    void add(
        const End& from, const End& to, int channel, const OpticalPath& optical_path, double value);
    /// Traces what still waits; to be called after the last add().
    void finish();
    std::uint64_t num_rays() const { return num_rays_; }

 private:
    static constexpr std::size_t kSize = SegmentPacket::kSize;

    const Scene& scene_;
    PassHistogram& histogram_;
    std::uint64_t num_rays_ = 0;
    int count_ = 0;
    SegmentEnds from_;
    SegmentEnds to_;
    std::array<double, kSize> values_;
    std::array<OpticalPath, kSize> optical_paths_;
    std::array<int, kSize> channels_;
};

}  // namespace renderer
