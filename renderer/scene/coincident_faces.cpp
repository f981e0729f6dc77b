// SPDX-License-Identifier: MIT
#include "renderer/scene/coincident_faces.h"

#include "renderer/core/system/parallel.h"
#include "renderer/scene/box_tree.h"
#include "renderer/scene/convex_polygon.h"
#include "renderer/scene/ray_caster.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>

namespace renderer {
namespace {

using core::Vec2;
using core::Vec3;

/// A triangle of the scene.
struct Face {
    std::uint32_t object;
    std::uint32_t number;    ///< among those of the object
    Eigen::Vector3f normal;  ///< near enough to tell whether faces may be parallel
};

/// A face's plane, with coordinates along its first edge and across it.
class FacePlane {
 public:
    explicit FacePlane(const std::array<Vec3, 3>& corners) : origin_(corners[0]) {
        const Vec3 edge1 = corners[1] - corners[0];
        const Vec3 edge2 = corners[2] - corners[0];
        const double longest = std::max({edge1.norm(), edge2.norm(), (edge2 - edge1).norm()});
        normal_ = edge1.cross(edge2).normalized();
        x_ = edge1.normalized();
        y_ = normal_.cross(x_);
        face_ = {Vec2::Zero(), Vec2(x_.dot(edge1), 0.0), Vec2(x_.dot(edge2), y_.dot(edge2))};
        width_m_ = face_[1].x() * face_[2].y() / longest;
    }

    const std::array<Vec2, 3>& face() const { return face_; }
    double area_m2() const { return 0.5 * face_[1].x() * face_[2].y(); }
    double width_m() const { return width_m_; }  ///< the least one
    double height(const Vec3& point) const { return normal_.dot(point - origin_); }

    /// Where points lie in the plane, counterclockwise.
    std::array<Vec2, 3> seen(const std::array<Vec3, 3>& corners) const {
        std::array<Vec2, 3> triangle;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 offset = corners[i] - origin_;
            triangle[i] = {x_.dot(offset), y_.dot(offset)};
        }
        const Vec2 a = triangle[1] - triangle[0];
        const Vec2 b = triangle[2] - triangle[0];
        if (a.x() * b.y() < a.y() * b.x()) std::swap(triangle[1], triangle[2]);
        return triangle;
    }

    /// How far above a place of this plane another one lies, along the normal.
    double height_at(const Vec2& place, const FacePlane& other) const {
        const Vec3 point = origin_ + place.x() * x_ + place.y() * y_;
        return -other.height(point) / other.normal_.dot(normal_);
    }

    /// Weights of the second and the third corner; exact at corners.
    Vec2 weights(const Vec2& place) const {
        const double third = place.y() / face_[2].y();
        return {(place.x() - third * face_[2].x()) / face_[1].x(), third};
    }

 private:
    Vec3 origin_, x_, y_, normal_;
    std::array<Vec2, 3> face_;
    double width_m_;
};

/// Looks for faces that others cover.
class CoverFinder {
 public:
    CoverFinder(std::span<const Object> objects,
                const FacePrecedence& precedence,
                double tolerance_m)
        : objects_(objects), precedence_(precedence), tolerance_m_(tolerance_m), tree_(boxes()) {}

    std::vector<CoveredFace> find() const {
        constexpr std::size_t kBlock = 1024;
        std::vector<std::vector<CoveredFace>> found((faces_.size() + kBlock - 1) / kBlock);
        core::parallel_blocks(faces_.size(), kBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (auto covered = look_at(i)) found[begin / kBlock].push_back(std::move(*covered));
            }
        });
        std::vector<CoveredFace> all;
        for (auto& part : found) std::move(part.begin(), part.end(), std::back_inserter(all));
        std::sort(all.begin(), all.end(), [](const CoveredFace& a, const CoveredFace& b) {
            return std::tie(a.object, a.face) < std::tie(b.object, b.face);
        });
        return all;
    }

 private:
    std::array<Vec3, 3> corners(const Face& face) const {
        const core::TriangleMesh& mesh = objects_[face.object].mesh;
        const auto& [a, b, c] = mesh.triangles[face.number];
        return {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
    }

    BoxTree::Box box(const Face& face) const {
        BoxTree::Box box;
        for (const Vec3& corner : corners(face)) box.extend(corner);
        return box;
    }

    /// Lists all faces, those that count first in front; returns their boxes.
    std::vector<BoxTree::Box> boxes() {
        std::vector<BoxTree::Box> boxes;
        for (const std::size_t object : precedence_.order) {
            const std::size_t count = objects_[object].mesh.triangles.size();
            for (std::size_t i = 0; i < count; ++i) {
                Face face{static_cast<std::uint32_t>(object), static_cast<std::uint32_t>(i), {}};
                const auto [a, b, c] = corners(face);
                face.normal = (b - a).cross(c - a).normalized().cast<float>();
                faces_.push_back(face);
                boxes.push_back(box(face));
            }
        }
        return boxes;
    }

    std::optional<CoveredFace> look_at(std::size_t index) const {
        const Face& face = faces_[index];
        BoxTree::Box near = box(face);
        near.extend(Vec3(near.min().array() - tolerance_m_));
        near.extend(Vec3(near.max().array() + tolerance_m_));
        std::optional<FacePlane> plane;
        std::vector<std::array<Vec2, 3>> covers;
        std::uint32_t first = ~0U;
        tree_.find(near, [&](std::uint32_t other) {
            if (other >= index || !may_cover(faces_[other], face)) return;
            if (!plane) plane.emplace(corners(face));
            const auto cover = cover_of(*plane, corners(faces_[other]));
            if (!cover) return;
            covers.push_back(*cover);
            first = std::min(first, other);
        });
        if (covers.empty()) return std::nullopt;
        const std::vector<ConvexPolygon> rest = subtract(
            ConvexPolygon(plane->face().begin(), plane->face().end()), covers, slack_m(*plane));
        double rest_m2 = 0.0;
        for (const ConvexPolygon& polygon : rest) rest_m2 += area_of(polygon);
        if (rest_m2 > kWhole * plane->area_m2()) return std::nullopt;
        return CoveredFace{
            face.object, face.number, faces_[first].object, triangles_of(rest, *plane)};
    }

    bool may_cover(const Face& cover, const Face& face) const {
        constexpr float kParallel = 0.99F;
        return std::abs(cover.normal.dot(face.normal)) > kParallel &&
               precedence_.group[cover.object] == precedence_.group[face.object];
    }

    // In the plane of a face, what covers it of another one; nothing when they do not overlap or
    // are too far apart anywhere where they do.
    std::optional<std::array<Vec2, 3>> cover_of(const FacePlane& plane,
                                                const std::array<Vec3, 3>& other) const {
        std::array<double, 3> heights;
        for (std::size_t i = 0; i < 3; ++i) heights[i] = plane.height(other[i]);
        const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
        if (*low > tolerance_m_ || *high < -tolerance_m_) return std::nullopt;
        const std::array<Vec2, 3> cover = plane.seen(other);
        if (are_apart(plane.face(), cover, slack_m(plane))) return std::nullopt;
        const FacePlane other_plane(other);
        for (const Vec2& place : intersection(plane.face(), cover)) {
            if (std::abs(plane.height_at(place, other_plane)) > tolerance_m_) return std::nullopt;
        }
        return cover;
    }

    static std::vector<std::array<Vec2, 3>> triangles_of(const std::vector<ConvexPolygon>& polygons,
                                                         const FacePlane& plane) {
        std::vector<std::array<Vec2, 3>> triangles;
        for (const ConvexPolygon& polygon : polygons) {
            for (std::size_t i = 2; i < polygon.size(); ++i) {
                triangles.push_back({plane.weights(polygon[0]),
                                     plane.weights(polygon[i - 1]),
                                     plane.weights(polygon[i])});
            }
        }
        return triangles;
    }

    // Within a face's plane, so that narrow faces are no exception.
    double slack_m(const FacePlane& plane) const {
        constexpr double kFractionOfWidth = 0.01;
        return std::min(tolerance_m_, kFractionOfWidth * plane.width_m());
    }

    static constexpr double kWhole = 1.0 - 1e-9;  ///< of a face of which nothing is covered

    std::span<const Object> objects_;
    const FacePrecedence& precedence_;
    double tolerance_m_;
    std::vector<Face> faces_;
    BoxTree tree_;
};

/// Puts what covers leave of an object's faces in the place of these.
class FaceCutter {
 public:
    explicit FaceCutter(Object& object) : object_(object) {}

    /// Takes a face's triangles in `rest`, as CoveredFace has them.
    void add(const std::array<std::uint32_t, 3>& face,
             const std::vector<std::array<Vec2, 3>>& rest) {
        for (const auto& weights : rest) {
            std::array<std::uint32_t, 3> triangle;
            for (std::size_t i = 0; i < 3; ++i) triangle[i] = vertex(face, weights[i]);
            const auto& vertices = object_.mesh.vertices;
            const Vec3& corner = vertices[triangle[0]];
            if (core::has_area(vertices[triangle[1]] - corner, vertices[triangle[2]] - corner)) {
                triangles_.push_back(triangle);
            }
        }
    }
    void keep(const std::array<std::uint32_t, 3>& face) { triangles_.push_back(face); }
    void finish() {
        object_.mesh.triangles = std::move(triangles_);
        object_.mesh.normals.clear();
    }

 private:
    std::uint32_t vertex(const std::array<std::uint32_t, 3>& face, const Vec2& weights) {
        const auto& [a, b, c] = face;
        if (weights == Vec2::Zero()) return a;
        if (weights == Vec2::UnitX()) return b;
        if (weights == Vec2::UnitY()) return c;
        const auto between = [&](auto& values) {
            values.push_back(values[a] + weights.x() * (values[b] - values[a]) +
                             weights.y() * (values[c] - values[a]));
        };
        between(object_.mesh.vertices);
        if (!object_.uv.empty()) between(object_.uv);
        if (!object_.vertex_albedo.empty()) between(object_.vertex_albedo);
        return static_cast<std::uint32_t>(object_.mesh.vertices.size() - 1);
    }

    Object& object_;
    std::vector<std::array<std::uint32_t, 3>> triangles_;
};

void cut_faces(Object& object, std::span<const CoveredFace> covered) {
    FaceCutter cutter(object);
    const auto faces = object.mesh.triangles;
    auto next = covered.begin();
    for (std::size_t i = 0; i < faces.size(); ++i) {
        if (next != covered.end() && next->face == i) {
            cutter.add(faces[i], next->rest);
            ++next;
        } else {
            cutter.keep(faces[i]);
        }
    }
    cutter.finish();
}

}  // namespace

FacePrecedence::FacePrecedence(std::span<const Object> objects) : order(objects.size()) {
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_partition(order.begin(), order.end(), [&](std::size_t i) {
        return objects[i].role == Role::RelayWall;
    });
    std::map<std::tuple<double, double, double>, std::size_t> groups;
    for (const Object& object : objects) {
        const Vec3& v = object.velocity_m_per_s;
        const auto place = groups.try_emplace({v.x(), v.y(), v.z()}, groups.size()).first;
        group.push_back(place->second);
    }
}

double coincidence_m(std::span<const Object> objects, std::span<const Vec3> ray_ends) {
    constexpr double kLeast_m = 2e-7;
    constexpr double kPerRayOffset = 1.25;
    Eigen::AlignedBox3d box;
    for (const Object& object : objects) {
        for (const Vec3& vertex : object.mesh.vertices) box.extend(vertex);
    }
    for (const Vec3& point : ray_ends) box.extend(point);
    return box.isEmpty() ? kLeast_m : std::max(kLeast_m, kPerRayOffset * ray_offset_m(box));
}

std::vector<CoveredFace> find_covered_faces(std::span<const Object> objects,
                                            const FacePrecedence& precedence,
                                            double tolerance_m) {
    return CoverFinder(objects, precedence, tolerance_m).find();
}

std::vector<CoincidentFaces> leave_out_covered_faces(std::vector<Object>& objects,
                                                     const FacePrecedence& precedence,
                                                     double tolerance_m) {
    const std::vector<CoveredFace> covered = find_covered_faces(objects, precedence, tolerance_m);
    std::vector<CoincidentFaces> result;
    for (auto begin = covered.begin(); begin != covered.end();) {
        const auto end = std::find_if(begin, covered.end(), [&](const CoveredFace& face) {
            return face.object != begin->object;
        });
        Object& object = objects[begin->object];
        auto entry = std::find_if(result.begin(), result.end(), [&](const CoincidentFaces& e) {
            return e.object == object.name;
        });
        if (entry == result.end()) {
            entry = result.insert(entry, {object.name, objects[begin->by].name});
        }
        const auto gone = static_cast<std::size_t>(
            std::count_if(begin, end, [](const CoveredFace& face) { return face.rest.empty(); }));
        entry->num_faces += object.mesh.triangles.size();
        entry->num_left_out += gone;
        entry->num_cut += static_cast<std::size_t>(end - begin) - gone;
        cut_faces(object, {begin, end});
        begin = end;
    }
    std::erase_if(objects, [](const Object& object) { return object.mesh.triangles.empty(); });
    return result;
}

std::string describe(std::span<const CoincidentFaces> faces) {
    constexpr std::size_t kMost = 4;
    if (faces.empty()) return "";
    std::vector<std::string> parts;
    for (const CoincidentFaces& f : faces.first(std::min(kMost, faces.size()))) {
        std::vector<std::string> counts;
        if (f.num_left_out > 0) counts.push_back(fmt::format("{}", f.num_left_out));
        if (f.num_cut > 0) counts.push_back(fmt::format("a part of {}", f.num_cut));
        parts.push_back(fmt::format("{} of {} faces of {} lie on {}",
                                    fmt::join(counts, " and "),
                                    f.num_faces,
                                    f.object,
                                    f.by == f.object ? "others of it" : f.by));
    }
    if (faces.size() > kMost) {
        parts.push_back(fmt::format("and so on for {} objects more", faces.size() - kMost));
    }
    return fmt::format("faces at one place count once: {}", fmt::join(parts, ", "));
}

}  // namespace renderer
