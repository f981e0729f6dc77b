// SPDX-License-Identifier: MIT
#include "renderer/path/short_paths.h"

namespace renderer {

void add_short_paths(const Scene& scene,
                     const PathEndpoints& ends,
                     const RenderSettings& settings,
                     PassHistogram& histogram) {
    const auto channel = [&](int order) { return settings.by_order ? order - 1 : 0; };
    if (ends.coincide) {
        if (settings.direct_return) {
            histogram.add(channel(1),
                          {ends.device_legs_m, 0.0},
                          ends.light.strength / settings.laser_spot_m2);
        }
        return;
    }
    if (settings.max_bounces < 2 || scene.has_relay_wall()) return;
    const core::Vec3 offset = ends.light.position - ends.sensor.position;
    const double distance = offset.norm();
    const core::Vec3 direction = offset / distance;
    const double value =
        ends.sensor.factor(direction) * ends.light.factor(-direction) / (distance * distance);
    if (value > 0.0 &&
        !scene.rays().is_blocked(
            ends.sensor.position, ends.sensor.normal, ends.light.position, ends.light.normal)) {
        histogram.add(channel(2), {distance + ends.device_legs_m, 0.0}, value);
    }
}

}  // namespace renderer
