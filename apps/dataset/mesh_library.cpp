// SPDX-License-Identifier: MIT
#include "apps/dataset/mesh_library.h"

#include "apps/batch/checksum.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/mesh_file/mesh_file.h"
#include "renderer/scene/load_geometry.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace apps {
namespace {

namespace fs = std::filesystem;
using core::Vec3;

constexpr int kCellsOfShape = 100;
constexpr std::size_t kMostKeptBytes = std::size_t{1} << 30;

bool is_mesh(const fs::path& path) {
    std::string suffix = path.extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) {
        return static_cast<char>(std::tolower(c));
    });
    return suffix == ".glb" || suffix == ".gltf" || renderer::is_mesh_file(path.string());
}

std::vector<std::string> meshes_in(const std::string& folder) {
    std::error_code error;
    if (!fs::is_directory(folder, error)) {
        throw core::Error("meshes.folder: " + folder, "is no folder", "must be one");
    }
    std::vector<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
        std::error_code unreadable;
        if (entry.is_regular_file(unreadable) && is_mesh(entry.path())) {
            files.push_back(entry.path().string());
        }
    }
    if (error) throw core::Error("meshes.folder: " + folder, error.message(), "must be readable");
    if (files.empty()) {
        throw core::Error("meshes.folder: " + folder,
                          "holds no mesh",
                          "must hold .glb, .gltf, .obj, .ply or .stl files");
    }
    std::sort(files.begin(), files.end());
    return files;
}

/// How far a surface may move in the largest object of a recipe before a bin tells.
std::optional<double> tolerance_of(const Recipe& recipe) {
    if (recipe.meshes.tolerance_bins == 0.0) return std::nullopt;
    double largest = 0.0;
    for (const core::Json& size : extremes(recipe.objects.size_m)) {
        largest = std::max(largest, size.get<double>());
    }
    return recipe.meshes.tolerance_bins * recipe.scene.time_axis.bin_width_m / largest;
}

core::TriangleMesh one_mesh(const renderer::SceneGeometry& geometry) {
    core::TriangleMesh all;
    for (const renderer::Object& object : geometry.objects) core::append_mesh(object.mesh, all);
    return all;
}

std::size_t bytes_of(const core::TriangleMesh& mesh) {
    return mesh.vertices.size() * sizeof(Vec3) + mesh.triangles.size() * sizeof(mesh.triangles[0]);
}

/// Keeps the vertices that a triangle uses, in the order of their first use.
core::TriangleMesh without_unused_vertices(const std::vector<Vec3>& vertices,
                                           std::vector<std::array<std::uint32_t, 3>> triangles) {
    constexpr std::uint32_t kUnused = ~0U;
    core::TriangleMesh mesh;
    std::vector<std::uint32_t> new_index(vertices.size(), kUnused);
    for (auto& triangle : triangles) {
        for (std::uint32_t& corner : triangle) {
            if (new_index[corner] == kUnused) {
                new_index[corner] = static_cast<std::uint32_t>(mesh.vertices.size());
                mesh.vertices.push_back(vertices[corner]);
            }
            corner = new_index[corner];
        }
    }
    mesh.triangles = std::move(triangles);
    return mesh;
}

}  // namespace

core::TriangleMesh normalise_mesh(const core::TriangleMesh& mesh, const std::string& name) {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    Eigen::AlignedBox3d box;
    for (const auto& triangle : mesh.triangles) {
        const Vec3& a = mesh.vertices.at(triangle[0]);
        const Vec3& b = mesh.vertices.at(triangle[1]);
        const Vec3& c = mesh.vertices.at(triangle[2]);
        if (!(a.allFinite() && b.allFinite() && c.allFinite())) {
            throw core::Error(name, "has a vertex that is not finite", "must have finite ones");
        }
        if (!core::has_area(b - a, c - a)) continue;
        triangles.push_back(triangle);
        for (const Vec3& corner : {a, b, c}) box.extend(corner);
    }
    if (triangles.empty()) {
        throw core::Error(name, "has no triangle with an area", "must have at least one");
    }
    core::TriangleMesh unit = without_unused_vertices(mesh.vertices, std::move(triangles));
    const Vec3 centre = box.center();
    const double scale = 1.0 / box.sizes().maxCoeff();
    for (Vec3& vertex : unit.vertices) vertex = scale * (vertex - centre);
    return unit;
}

core::TriangleMesh simplify_mesh(const core::TriangleMesh& mesh, double tolerance) {
    std::vector<float> positions;
    positions.reserve(3 * mesh.vertices.size());
    for (const core::Vec3& vertex : mesh.vertices) {
        for (const double coordinate : vertex) positions.push_back(static_cast<float>(coordinate));
    }
    constexpr std::size_t kStride = 3 * sizeof(float);
    const float scale = meshopt_simplifyScale(positions.data(), mesh.vertices.size(), kStride);
    std::vector<unsigned> corners;
    for (const auto& triangle : mesh.triangles) {
        corners.insert(corners.end(), triangle.begin(), triangle.end());
    }
    std::vector<unsigned> kept(corners.size());
    kept.resize(meshopt_simplify(kept.data(),
                                 corners.data(),
                                 corners.size(),
                                 positions.data(),
                                 mesh.vertices.size(),
                                 kStride,
                                 0,
                                 static_cast<float>(tolerance) / scale,
                                 0,
                                 nullptr));
    core::TriangleMesh simple;
    simple.vertices = mesh.vertices;
    for (std::size_t i = 0; i + 2 < kept.size(); i += 3) {
        simple.triangles.push_back({kept[i], kept[i + 1], kept[i + 2]});
    }
    return simple.triangles.empty() ? mesh : normalise_mesh(simple, "simplified mesh");
}

MeshLibrary::MeshLibrary(const Recipe& recipe)
    : folder_(recipe.meshes.folder),
      shapes_(recipe.meshes.shapes),
      tolerance_(tolerance_of(recipe)) {
    if (!recipe.meshes.folder.empty()) files_ = meshes_in(recipe.meshes.folder);
    for (const std::string& file : recipe.meshes.files) {
        std::error_code ignored;
        if (!fs::is_regular_file(file, ignored)) {
            throw core::Error("meshes.files: " + file, "is no file", "must be a mesh file");
        }
        files_.push_back(file);
    }
}

core::Json MeshLibrary::listing() const {
    constexpr std::uint64_t kMostBytesRead = std::uint64_t{1} << 30;
    constexpr std::uint64_t kBeginning = std::uint64_t{1} << 14;
    std::vector<std::uint64_t> sizes;
    std::uint64_t total = 0;
    for (const std::string& file : files_) {
        std::error_code ignored;
        sizes.push_back(fs::file_size(file, ignored));
        total += sizes.back();
    }
    core::Json list = core::Json::array();
    for (std::size_t i = 0; i < files_.size(); ++i) {
        const std::uint64_t read = total <= kMostBytesRead ? sizes[i] : kBeginning;
        list.push_back({name(i), sizes[i], file_checksum(files_[i], read).value_or("")});
    }
    for (std::size_t i = files_.size(); i < size(); ++i) list.push_back(name(i));
    return list;
}

std::string MeshLibrary::name(std::size_t index) const {
    if (index < files_.size()) {
        const fs::path file(files_[index]);
        const bool is_inside = !folder_.empty() && files_[index].starts_with(folder_);
        return is_inside ? file.lexically_relative(folder_).string() : file.filename().string();
    }
    return std::string(core::enum_name(shapes_[index - files_.size()]));
}

UnitMesh MeshLibrary::load(std::size_t index) const {
    UnitMesh unit;
    unit.name = name(index);
    const bool is_file = index < files_.size();
    unit.mesh = normalise_mesh(is_file ? one_mesh(renderer::load_geometry(files_[index]))
                                       : make_shape(shapes_[index - files_.size()], kCellsOfShape),
                               unit.name);
    if (tolerance_) unit.mesh = simplify_mesh(unit.mesh, *tolerance_);
    for (const Vec3& vertex : unit.mesh.vertices) {
        unit.radius = std::max(unit.radius, vertex.norm());
    }
    return unit;
}

std::shared_ptr<const UnitMesh> MeshLibrary::mesh(std::size_t index) {
    {
        const std::lock_guard lock(mutex_);
        if (broken_.contains(index)) return nullptr;
        if (const auto kept = kept_.find(index); kept != kept_.end()) {
            kept->second.last_use = ++uses_;
            return kept->second.mesh;
        }
    }
    // Two threads may read one file at once: either result is as good.
    std::shared_ptr<const UnitMesh> loaded;
    std::string reason;
    try {
        loaded = std::make_shared<const UnitMesh>(load(index));
    } catch (const core::Error& error) {
        reason = error.what();
    }
    const std::lock_guard lock(mutex_);
    if (!loaded) {
        broken_[index] = reason;
        return nullptr;
    }
    const std::size_t bytes = bytes_of(loaded->mesh);
    if (kept_.try_emplace(index, Entry{loaded, ++uses_, bytes}).second) kept_bytes_ += bytes;
    forget_oldest();
    return loaded;
}

void MeshLibrary::forget_oldest() {
    while (kept_bytes_ > kMostKeptBytes && kept_.size() > 1) {
        const auto oldest = std::min_element(kept_.begin(), kept_.end(), [](auto& a, auto& b) {
            return a.second.last_use < b.second.last_use;
        });
        kept_bytes_ -= oldest->second.bytes;
        kept_.erase(oldest);
    }
}

std::string MeshLibrary::why_broken(std::size_t index) const {
    const std::lock_guard lock(mutex_);
    const auto found = broken_.find(index);
    return found == broken_.end() ? "" : found->second;
}

}  // namespace apps
