// SPDX-License-Identifier: MIT
#pragma once

#include "apps/dataset/recipe.h"
#include "renderer/core/mesh.h"
#include "renderer/core/settings/json_fwd.h"

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// A surface around the origin whose longest side is 1.
struct UnitMesh {
    std::string name;
    core::TriangleMesh mesh;
    double radius = 0.0;  ///< of a sphere around the origin that holds it
};

/// The surfaces that a recipe draws from, read when they are asked for; the last ones read are kept
/// within bounded memory. Safe to use from several threads.
class MeshLibrary {
 public:
    /// Lists the files.
    /// throws   core::Error when the folder or a file does not exist, or the folder has no mesh
    explicit MeshLibrary(const Recipe& recipe);

    std::size_t size() const { return files_.size() + shapes_.size(); }
    /// What the meshes are, for the recipe's fingerprint: names, sizes and checksums of files; of
    /// collections above a gigabyte, checksums of their files' beginnings.
    core::Json listing() const;

    /// The mesh with an index below size(); null when it is broken, the same whenever it is asked
    /// for. A mesh is broken when its file is, or holds no surface.
    std::shared_ptr<const UnitMesh> mesh(std::size_t index);
    /// The name of a mesh: the path of its file below the folder, or that of its shape.
    std::string name(std::size_t index) const;
    /// Why mesh() gave null for an index.
    std::string why_broken(std::size_t index) const;

 private:
    struct Entry {
        std::shared_ptr<const UnitMesh> mesh;
        std::uint64_t last_use = 0;
        std::size_t bytes = 0;
    };

    UnitMesh load(std::size_t index) const;
    void forget_oldest();

    std::string folder_;
    std::vector<std::string> files_;  ///< paths, sorted by name
    std::vector<BasicShape> shapes_;
    std::optional<double> tolerance_;  ///< of simplification, for a longest side of 1; none: never

    mutable std::mutex mutex_;
    std::map<std::size_t, Entry> kept_;
    std::map<std::size_t, std::string> broken_;
    std::size_t kept_bytes_ = 0;
    std::uint64_t uses_ = 0;
};

/// Moves a mesh to the origin and scales it so that the longest side of its box is 1; drops
/// triangles without area and vertices that none uses.
/// throws   core::Error when nothing is left, or a vertex is not finite
core::TriangleMesh normalise_mesh(const core::TriangleMesh& mesh, const std::string& name);

/// Takes away triangles as long as the surface stays within a distance of what it was.
///
/// tolerance   in the mesh's unit
/// source      quadric error metrics [Garland1997], by meshoptimizer
core::TriangleMesh simplify_mesh(const core::TriangleMesh& mesh, double tolerance);

}  // namespace apps
