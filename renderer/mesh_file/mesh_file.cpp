// SPDX-License-Identifier: MIT
#include "renderer/mesh_file/mesh_file.h"

#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/nearest_name.h"
#include "renderer/mesh_file/assimp_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

namespace renderer {
namespace {

namespace fs = std::filesystem;
using core::Vec3;

std::string lower_suffix(const std::string& path) {
    return core::lower_case(fs::path(path).extension().string());
}

/// The rows are where the world's x, y and z point in the file.
core::Mat3 world_from_axes(FileAxis up) {
    static constexpr double kRows[6][9]{{0, -1, 0, 1, 0, 0, 0, 0, 1},
                                        {0, 1, 0, -1, 0, 0, 0, 0, 1},
                                        {1, 0, 0, 0, 1, 0, 0, 0, 1},
                                        {1, 0, 0, 0, -1, 0, 0, 0, -1},
                                        {1, 0, 0, 0, 0, 1, 0, -1, 0},
                                        {1, 0, 0, 0, 0, -1, 0, 1, 0}};  // as FileAxis lists them
    using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    return Eigen::Map<const Rows>(kRows[static_cast<std::size_t>(up)]);
}

Material material_of(const FileMaterial& source, const std::string& path) {
    for (const double value : source.colour) {
        if (value >= 0.0 && value <= 1.0) continue;
        throw core::Error(path + ": material " + source.name,
                          fmt::format("has the diffuse colour {:.4g} {:.4g} {:.4g}",
                                      source.colour[0],
                                      source.colour[1],
                                      source.colour[2]),
                          "must be from 0 to 1");
    }
    Material material;
    material.name = source.name;
    material.model = source.metallic > 0.0 ? SurfaceModel::Ggx : SurfaceModel::Lambertian;
    material.albedo = mean_albedo(source.colour);
    material.roughness = std::clamp(source.roughness, 0.0, 1.0);
    return material;
}

core::TriangleMesh world_mesh(const FileMesh& source,
                              const core::Mat3& world_from_file,
                              const std::string& path) {
    core::TriangleMesh mesh;
    for (const auto& [x, y, z] : source.vertices) {
        mesh.vertices.push_back(world_from_file * Vec3(x, y, z));
        if (!mesh.vertices.back().allFinite()) {
            throw core::Error(path, "has a vertex that is not finite", "must have finite ones");
        }
    }
    for (const auto& triangle : source.triangles) {
        const auto& [a, b, c] = triangle;
        const Vec3& corner = mesh.vertices[a];
        if (core::has_area(mesh.vertices[b] - corner, mesh.vertices[c] - corner)) {
            mesh.triangles.push_back(triangle);
        }
    }
    return mesh;
}

std::string object_name(const FileMesh& mesh, const std::string& path) {
    // What assimp calls parts that the file does not name.
    const bool is_named = !mesh.name.empty() && mesh.name != "defaultobject" &&
                          !mesh.name.starts_with("<") && mesh.name != fs::path(path).filename();
    return is_named ? mesh.name : fs::path(path).stem().string();
}

void add_warnings(const AssimpFile& file, std::vector<std::string>& warnings) {
    warnings.insert(warnings.end(), file.warnings.begin(), file.warnings.end());
    for (const FileMaterial& material : file.materials) {
        for (const std::string& text : material.warnings) {
            warnings.push_back("material " + material.name + ": " + text);
        }
    }
}

void require_readable(const std::string& path) {
    constexpr const char* kAllowed = "must be a readable OBJ, PLY or STL file";
    std::error_code ignored;
    if (!fs::exists(path, ignored)) throw core::Error(path, "does not exist", kAllowed);
    core::MappedFile(path, kAllowed).require_stored();
}

}  // namespace

bool is_mesh_file(const std::string& path) {
    const std::string suffix = lower_suffix(path);
    return suffix == ".obj" || suffix == ".ply" || suffix == ".stl";
}

SceneGeometry load_mesh_file(const std::string& path, const MeshFrame& frame) {
    require_readable(path);
    const AssimpFile file = read_with_assimp(path, lower_suffix(path));
    const core::Mat3 world_from_file = frame.unit_m * world_from_axes(frame.up);
    SceneGeometry geometry;
    for (const FileMesh& source : file.meshes) {
        Object object;
        object.name = object_name(source, path);
        object.material = material_of(file.materials.at(source.material), path);
        object.mesh = world_mesh(source, world_from_file, path);
        if (object.mesh.triangles.empty()) continue;
        Eigen::AlignedBox3d box;
        for (const Vec3& vertex : object.mesh.vertices) box.extend(vertex);
        object.world_from_node.translation() = box.center();
        geometry.objects.push_back(std::move(object));
    }
    if (geometry.objects.empty()) {
        throw core::Error(path, "has no triangles with an area", "must have at least one");
    }
    add_warnings(file, geometry.warnings);
    return geometry;
}

}  // namespace renderer
