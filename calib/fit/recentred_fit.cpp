// SPDX-License-Identifier: MIT
#include "calib/fit/recentred_fit.h"

#include "renderer/recentred.h"

namespace calib {

using core::Vec3;

std::optional<Vec3> way_to_origin(const FitInput& input) {
    Eigen::AlignedBox3d box;
    for (const Vec3& point : input.capture.scan.path_ends()) box.extend(point);
    return renderer::way_to_origin(box.center(), box.sizes().maxCoeff());
}

FitInput moved(FitInput input, const Vec3& way) {
    input.capture.scan = core::moved(input.capture.scan, way);
    input.scene.relay_wall.center_m += way;
    input.geometry.move(way);
    for (Vec3& point : input.start_points) point += way;
    return input;
}

void move(FittedValues& values, const Vec3& way) {
    for (FittedObject& object : values.objects) object.position_m += way;
    for (FittedPoint& point : values.points) point.position_m += way;
    values.geometry.move(way);
}

}  // namespace calib
