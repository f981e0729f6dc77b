// SPDX-License-Identifier: MIT
#include "calib/compare_fit.h"

#include "renderer/core/error.h"
#include "renderer/core/principal_axes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace calib {
namespace {

using core::Vec3;

constexpr std::size_t kSamples = 4000;
constexpr std::size_t kCloudSamples = 40'000;
constexpr std::uint64_t kSampleSeed = 1;

// The objects of one node, and of those below it, as one mesh.
struct Shape {
    core::TriangleMesh mesh;
    core::Transform world_from_node = core::Transform::Identity();
    double albedo = 0.0;
    Vec3 centroid = Vec3::Zero();  // by area
    double area_m2 = 0.0;
};

// Where the node of the name stands that the object belongs to; nothing when it belongs to none.
std::optional<core::Transform> node_of(const renderer::Object& object, const std::string& name) {
    for (const renderer::NodeGroup& group : object.groups) {
        if (group.name == name) return group.world_from_node;
    }
    if (object.name == name) return object.world_from_node;
    return std::nullopt;
}

std::optional<Shape> shape_of(const renderer::SceneGeometry& geometry, const std::string& name) {
    Shape shape;
    for (const renderer::Object& object : geometry.objects) {
        const auto node = node_of(object, name);
        if (!node) continue;
        if (shape.mesh.vertices.empty()) {
            shape.world_from_node = *node;
            shape.albedo = object.material.albedo;
        }
        const auto base = static_cast<std::uint32_t>(shape.mesh.vertices.size());
        for (const Vec3& v : object.mesh.vertices) shape.mesh.vertices.push_back(v);
        for (const auto& [a, b, c] : object.mesh.triangles) {
            shape.mesh.triangles.push_back({base + a, base + b, base + c});
            const auto& v = object.mesh.vertices;
            const double area = core::triangle_area_vector(v[a], v[b], v[c]).norm();
            shape.area_m2 += area;
            shape.centroid += area * (v[a] + v[b] + v[c]) / 3.0;
        }
    }
    if (shape.area_m2 == 0.0) return std::nullopt;
    shape.centroid /= shape.area_m2;
    return shape;
}

core::Mat3 rotation_of(const Shape& shape) {
    return shape.world_from_node.rotation();
}

// Whether a turn takes every vertex to a vertex, up to 2 % of the shape's extent.
bool is_symmetry(const core::Mat3& turn, const std::vector<Vec3>& local) {
    double extent = 0.0;
    for (const Vec3& p : local) extent = std::max(extent, p.norm());
    for (const Vec3& p : local) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Vec3& q : local) nearest = std::min(nearest, (turn * p - q).squaredNorm());
        if (std::sqrt(nearest) > 0.02 * extent) return false;
    }
    return true;
}

// Rotations of the node's frame that map the vertices onto themselves: of the half, third, quarter
// and sixth turns about the principal axes and about the node's axes, and their products.
std::vector<core::Mat3> symmetries(const Shape& shape) {
    std::vector<Vec3> local;
    for (const Vec3& v : shape.mesh.vertices) {
        local.push_back(rotation_of(shape).transpose() * (v - shape.centroid));
    }
    std::vector<core::Mat3> group{core::Mat3::Identity()};
    constexpr std::size_t kMaxVertices = 2000;
    if (local.size() > kMaxVertices) return group;
    const core::PointCloud samples = core::sample_surface(shape.mesh, kSamples, kSampleSeed);
    const core::Mat3 principal =
        rotation_of(shape).transpose() * core::principal_axes(samples.positions).axes;
    std::vector<core::Mat3> generators;
    for (const core::Mat3& axes : {core::Mat3(core::Mat3::Identity()), principal}) {
        for (int a = 0; a < 3; ++a) {
            for (const int parts : {2, 3, 4, 6}) {
                const core::Mat3 turn =
                    Eigen::AngleAxisd(2.0 * core::kPi / parts, axes.col(a)).toRotationMatrix();
                if (is_symmetry(turn, local)) generators.push_back(turn);
            }
        }
    }
    constexpr std::size_t kLargestGroup = 48;
    for (std::size_t i = 0; i < group.size() && group.size() < kLargestGroup; ++i) {
        for (const core::Mat3& generator : generators) {
            const core::Mat3 product = generator * group[i];
            const bool is_known = std::any_of(group.begin(), group.end(), [&](const auto& known) {
                return (known - product).norm() < 0.05;
            });
            if (!is_known) group.push_back(product);
        }
    }
    return group;
}

void append_samples(const Shape& shape, core::PointCloud& cloud) {
    const core::PointCloud samples = core::sample_surface(shape.mesh, kCloudSamples, kSampleSeed);
    cloud.positions.insert(
        cloud.positions.end(), samples.positions.begin(), samples.positions.end());
    cloud.normals.insert(cloud.normals.end(), samples.normals.begin(), samples.normals.end());
}

void keep_worst(std::optional<double>& worst, double value) {
    worst = std::max(worst.value_or(0.0), value);
}

void compare_shapes(const Shape& fitted, const Shape& truth, FitErrors& errors) {
    keep_worst(errors.position_m, (fitted.centroid - truth.centroid).norm());
    keep_worst(errors.size, std::abs(std::sqrt(fitted.area_m2 / truth.area_m2) - 1.0));
    if (truth.albedo > 0.0) {
        keep_worst(errors.albedo, std::abs(fitted.albedo / truth.albedo - 1.0));
    }
    double least = std::numeric_limits<double>::infinity();
    for (const core::Mat3& symmetry : symmetries(truth)) {
        const core::Mat3 difference =
            rotation_of(fitted) * (rotation_of(truth) * symmetry).transpose();
        least = std::min(least, std::abs(Eigen::AngleAxisd(difference).angle()));
    }
    keep_worst(errors.rotation_deg, core::kDegreesPerRadian * least);
    append_samples(fitted, errors.fitted_points);
    append_samples(truth, errors.true_points);
}

}  // namespace

FitErrors compare_fit(const FitResult& fit,
                      const renderer::SceneGeometry& fitted,
                      const renderer::SceneGeometry& truth,
                      const std::vector<FittedPoint>& true_points) {
    FitErrors errors;
    for (const FittedObject& object : fit.objects) {
        const auto shape = shape_of(fitted, object.name);
        const auto reference = shape_of(truth, object.name);
        if (shape && reference) compare_shapes(*shape, *reference, errors);
    }
    for (const FittedPoint& point : fit.points) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const FittedPoint& other : true_points) {
            nearest = std::min(nearest, (other.position_m - point.position_m).norm());
        }
        for (const renderer::Object& object : truth.objects) {
            if (object.role == renderer::Role::RelayWall) continue;
            for (const Vec3& p :
                 core::sample_surface(object.mesh, kSamples, kSampleSeed).positions) {
                nearest = std::min(nearest, (p - point.position_m).norm());
            }
        }
        if (!std::isfinite(nearest)) continue;
        keep_worst(errors.position_m, nearest);
    }
    if (!errors.position_m) {
        throw core::Error(
            "compare", "found no object of the fit in the scene", "nodes must have the same names");
    }
    return errors;
}

}  // namespace calib
