// SPDX-License-Identifier: MIT
#include "renderer/scene/coinciding_points.h"

#include <array>
#include <set>

namespace renderer {
namespace {

using PointKey = std::array<double, 6>;  // position and normal

PointKey point_key(const core::WallPoints& points, std::size_t i) {
    const core::Vec3& p = points.positions[i];
    const core::Vec3& n = points.normals[i];
    return {p.x(), p.y(), p.z(), n.x(), n.y(), n.z()};
}

std::vector<bool> found_in(const core::WallPoints& points, const core::WallPoints& others) {
    std::set<PointKey> keys;
    for (std::size_t i = 0; i < others.size(); ++i) keys.insert(point_key(others, i));
    std::vector<bool> found;
    for (std::size_t i = 0; i < points.size(); ++i) {
        found.push_back(keys.contains(point_key(points, i)));
    }
    return found;
}

}  // namespace

CoincidingPoints::CoincidingPoints(const core::WallScan& scan) {
    if (scan.pattern == core::ScanPattern::Confocal) {
        illumination.assign(scan.illumination.size(), true);
        sensing.assign(scan.sensing.size(), true);
        return;
    }
    illumination = found_in(scan.illumination, scan.sensing);
    sensing = found_in(scan.sensing, scan.illumination);
}

}  // namespace renderer
