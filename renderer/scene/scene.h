// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/material/bsdf.h"
#include "renderer/material/scene_geometry.h"
#include "renderer/scene/coincident_faces.h"
#include "renderer/scene/ray_caster.h"
#include "renderer/scene/scene_file.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace renderer {

/// One triangle of the scene in world coordinates.
struct Facet {
    core::Vec3 corner;  ///< first corner [m]
    core::Vec3 edge1;   ///< from the first to the second corner
    core::Vec3 edge2;   ///< from the first to the third corner
    core::Vec3 normal;  ///< unit, geometric
    double area_m2 = 0.0;
    std::uint32_t object = 0;
    std::uint32_t triangle = 0;  ///< within the object's mesh

    /// b1 and b2 are the weights of the second and the third corner.
    core::Vec3 point(double b1, double b2) const { return corner + b1 * edge1 + b2 * edge2; }
    std::array<core::Vec3, 3> corners() const { return {corner, corner + edge1, corner + edge2}; }
    /// Orthonormal, third column the normal.
    core::Mat3 world_from_facet() const { return core::frame_from_normal(normal, edge1); }
};

/// A point on a facet.
struct SurfacePoint {
    core::Vec3 position = core::Vec3::Zero();
    std::uint32_t facet = 0;
};

/// Everything that scatters light: facets, materials and the relay wall; and rays against them.
///
/// Of surfaces at one place that move together one counts, see coincident_faces.h.
class Scene {
 public:
    /// geometry     objects in world coordinates
    /// scan         points that rays will start from
    /// wall         becomes a surface unless a mesh has that role or the scan lies elsewhere;
    ///              images have none, and meshes of that role are hidden surfaces to them
    Scene(SceneGeometry geometry, const core::Scan& scan, const RelayWall& wall);

    /// The same elsewhere.
    ///
    /// scan   moved likewise
    Scene moved(const core::Vec3& way, const core::Scan& scan) const;

    const std::vector<Object>& objects() const { return geometry_.objects; }
    /// Which faces of the geometry are not among those of objects(): they lie on others.
    const std::vector<CoincidentFaces>& coincident_faces() const { return coincident_faces_; }
    /// What the geometry's file says that is not modelled, for people.
    const std::vector<std::string>& warnings() const { return geometry_.warnings; }
    std::span<const Facet> facets() const { return facets_; }
    const Facet& facet(std::uint32_t index) const { return facets_[index]; }
    const Object& object_of(std::uint32_t facet) const {
        return geometry_.objects[facets_[facet].object];
    }
    /// Of a facet's surface, world.
    const core::Vec3& velocity_m_per_s(std::uint32_t facet) const {
        return object_of(facet).velocity_m_per_s;
    }
    bool is_hidden(std::uint32_t facet) const { return object_of(facet).role != Role::RelayWall; }
    /// A direction that rotates with the scene and is not parallel to `normal` (unit).
    const core::Vec3& tangent_hint(const core::Vec3& normal) const;

    const RayCaster& rays() const { return rays_; }

    /// Rounding of the coordinates in which the scene has been given, wherever it stands now [m].
    double stated_rounding_m() const { return stated_rounding_m_; }

    /// The surface model at a point, textures applied.
    Bsdf bsdf_at(const SurfacePoint& point) const;

    /// True when the relay wall is a surface of the scene (a rectangle or a mesh of that role).
    bool has_relay_wall() const { return has_relay_wall_; }
    /// Albedo at the scan's points: that of the mesh with the relay wall's role, else `wall`'s.
    double wall_albedo() const { return wall_albedo_; }

    /// Nearest surface point along a ray that starts on a surface with `normal`.
    std::optional<SurfacePoint> first_hit(const core::Vec3& from,
                                          const core::Vec3& normal,
                                          const core::Vec3& direction) const;

 private:
    /// The objects are all surfaces, the relay wall among them if it is one.
    Scene(SceneGeometry geometry, const std::vector<core::Vec3>& path_ends, double wall_albedo);

    SceneGeometry geometry_;
    std::vector<CoincidentFaces> coincident_faces_;
    std::vector<Facet> facets_;
    std::vector<Bsdf> bsdfs_;  ///< per object, untextured
    bool has_relay_wall_ = false;
    double wall_albedo_;
    RayCaster rays_;
    double stated_rounding_m_;
};

/// Sets a scene up for the scan of its description.
///
/// geometry   with the description's objects applied
/// throws   core::Error for a bad file and for what check_geometry() and check_scene() refuse
Scene make_scene(SceneGeometry geometry,
                 const SceneDescription& description,
                 const core::Scan& scan);

/// The same with the geometry that the description names.
Scene load_scene(const SceneDescription& description, const core::Scan& scan);

}  // namespace renderer
