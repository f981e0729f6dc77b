// SPDX-License-Identifier: MIT
#include "calib/model/scene_model.h"
#include "renderer/core/principal_axes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace calib {
namespace {

using core::Vec3;

// Vertices that meet others this closely, over the extent, cover them.
constexpr double kSame = 1e-6;
constexpr std::size_t kMaxVertices = 2000;

std::vector<Vec3> vertices_of(const SceneModel& model, const SceneState& state, std::size_t body) {
    std::vector<Vec3> result;
    for (std::size_t v = 0; v < model.bodies()[body].vertices.size(); ++v) {
        result.push_back(model.bodies()[body].vertex_world(state.bodies[body], v));
    }
    return result;
}

Vec3 center_of(const std::vector<Vec3>& points) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& p : points) sum += p;
    return sum / static_cast<double>(points.size());
}

double farthest_vertex(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    const Vec3 center = center_of(b);
    double extent = 0.0;
    double farthest = 0.0;
    for (const Vec3& q : b) extent = std::max(extent, (q - center).norm());
    for (const Vec3& p : a) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Vec3& q : b) nearest = std::min(nearest, (p - q).squaredNorm());
        farthest = std::max(farthest, std::sqrt(nearest));
    }
    return extent > 0.0 ? farthest / extent : 0.0;
}

}  // namespace

bool are_different_poses(const SceneModel& model, const SceneState& a, const SceneState& b) {
    constexpr double kOtherPosition = 0.1;
    constexpr double kSameShape = 0.005;
    constexpr double kOtherTurn_rad = 0.35;
    for (std::size_t body = 0; body < model.bodies().size(); ++body) {
        if (model.bodies()[body].vertices.size() > kMaxVertices) continue;
        const double distance =
            farthest_vertex(vertices_of(model, a, body), vertices_of(model, b, body));
        const double angle = a.bodies[body].rotation.angularDistance(b.bodies[body].rotation);
        if (distance > kOtherPosition || (distance > kSameShape && angle > kOtherTurn_rad))
            return true;
    }
    return false;
}

std::vector<std::pair<std::string, SceneState>> symmetric_poses(const SceneModel& model,
                                                                const SceneState& state,
                                                                double max_distance) {
    std::vector<std::pair<std::string, SceneState>> result;
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
        const ModelBody& body = model.bodies()[b];
        const bool is_rigid = !model.is_free(Owner::Body, b, Effect::Deforms);
        if (!model.is_free(Owner::Body, b, Effect::Rotates) || !is_rigid ||
            body.vertices.size() > kMaxVertices) {
            continue;
        }
        const std::vector<Vec3> vertices = vertices_of(model, state, b);
        const core::PrincipalAxes principal = core::principal_axes(vertices);
        const Vec3& center = principal.center_m;
        std::vector<std::vector<Vec3>> found;
        for (int axis = 0; axis < 3; ++axis) {
            for (const double degrees : {90.0, 180.0, 270.0}) {
                const Eigen::Quaterniond turn(
                    Eigen::AngleAxisd(degrees / 180.0 * core::kPi, principal.axes.col(axis)));
                SceneState turned = state;
                BodyState& pose = turned.bodies[b];
                pose.rotation = (turn * pose.rotation).normalized();
                if (model.is_free(Owner::Body, b, Effect::Translates)) {
                    pose.position_m = center + turn * (pose.position_m - center);
                }
                const std::vector<Vec3> moved = vertices_of(model, turned, b);
                const double distance = farthest_vertex(moved, vertices);
                if (distance < kSame || distance > max_distance) continue;
                const bool is_known = std::any_of(found.begin(), found.end(), [&](const auto& f) {
                    return farthest_vertex(moved, f) < kSame;
                });
                if (is_known) continue;
                found.push_back(moved);
                result.emplace_back(fmt::format("{} turned by {:g} degrees", body.name, degrees),
                                    turned);
            }
        }
    }
    return result;
}

}  // namespace calib
