// SPDX-License-Identifier: MIT
#include "renderer/recentred.h"

namespace renderer {
namespace {

/// Of a sequence: how far all its frames are moved, and what is there.
struct RecentredFrames {
    std::optional<core::Vec3> way;
    core::Scan scan;
    FrameRenderer render;
    std::shared_ptr<const Scene> stated;  ///< of the last frame
    std::shared_ptr<const Scene> moved;
};

}  // namespace

std::optional<core::Vec3> way_to_origin(const core::Vec3& center, double half_size_m) {
    // Scenes as far as that beside their size cost six of 53 bits.
    constexpr double kFar = 64.0;
    if (center.cwiseAbs().maxCoeff() <= kFar * half_size_m) return std::nullopt;
    return -center;
}

FrameRenderer make_recentred_frame_renderer(const core::Scan& scan,
                                            const RenderSettings& settings,
                                            FrameRenderer (*make)(const core::Scan& scan,
                                                                  const RenderSettings& settings)) {
    const auto frames = std::make_shared<RecentredFrames>();
    return [frames, &scan, settings, make](
               const Frame& frame, const core::Scan& frame_scan, const core::Progress& progress) {
        if (!frames->render) {
            const RayCaster& rays = frame.scene->rays();
            frames->way = way_to_origin(rays.origin(), rays.half_size_m());
            frames->scan = frames->way ? core::moved(scan, *frames->way) : scan;
            frames->render = make(frames->scan, settings);
        }
        if (!frames->way) return frames->render(frame, frame_scan, progress);
        if (frames->stated != frame.scene) {
            frames->stated = frame.scene;
            frames->moved =
                std::make_shared<const Scene>(frame.scene->moved(*frames->way, frames->scan));
        }
        Frame there = frame;
        there.scene = frames->moved;
        RenderResult result = frames->render(there, frames->scan, progress);
        result.capture.scan = frame_scan;
        return result;
    };
}

}  // namespace renderer
