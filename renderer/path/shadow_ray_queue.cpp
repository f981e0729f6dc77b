// SPDX-License-Identifier: MIT
#include "renderer/path/shadow_ray_queue.h"

namespace renderer {

void ShadowRayQueue::add(
    const End& from, const End& to, int channel, const OpticalPath& optical_path, double value) {
    const auto lane = static_cast<std::size_t>(count_++);
    from_.set(lane, from.position, from.normal);
    to_.set(lane, to.position, to.normal);
    channels_[lane] = channel;
    optical_paths_[lane] = optical_path;
    values_[lane] = value;
    if (count_ == SegmentPacket::kSize) finish();
}

void ShadowRayQueue::finish() {
    if (count_ == 0) return;
    SegmentPacket packet;
    scene_.rays().aim(packet, from_.lanes(), to_.lanes(), count_);
    scene_.rays().trace(packet);
    num_rays_ += static_cast<std::uint64_t>(count_);
    for (int lane = 0; lane < count_; ++lane) {
        if ((packet.blocked >> lane & 1U) != 0) continue;
        const auto i = static_cast<std::size_t>(lane);
        histogram_.add(channels_[i], optical_paths_[i], values_[i]);
    }
    count_ = 0;
}

}  // namespace renderer
