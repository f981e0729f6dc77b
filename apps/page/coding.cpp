// SPDX-License-Identifier: MIT
#include "apps/page/coding.h"

namespace apps {

core::Json add_points(PageArrays& arrays, const std::vector<core::Vec3>& points) {
    constexpr double kSteps = std::numeric_limits<std::uint16_t>::max();
    core::Vec3 low = points.empty() ? core::Vec3::Zero().eval() : points.front();
    core::Vec3 high = low;
    for (const core::Vec3& point : points) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    std::vector<std::uint16_t> codes;
    codes.reserve(3 * points.size());
    for (const core::Vec3& point : points) {
        for (int axis = 0; axis < 3; ++axis) {
            const double size = high[axis] - low[axis];
            const double share = size > 0.0 ? (point[axis] - low[axis]) / size : 0.0;
            codes.push_back(static_cast<std::uint16_t>(0.5 + kSteps * share));
        }
    }
    core::Json json = arrays.add(codes);
    json.update({{"count", points.size()},
                 {"low", {low[0], low[1], low[2]}},
                 {"high", {high[0], high[1], high[2]}}});
    return json;
}

}  // namespace apps
