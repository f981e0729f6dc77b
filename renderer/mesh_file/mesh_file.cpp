// SPDX-License-Identifier: MIT
#include "renderer/mesh_file/mesh_file.h"

#include "renderer/core/error.h"
#include "renderer/core/mesh_formats/mesh_formats.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <span>

namespace renderer {
namespace {

namespace fs = std::filesystem;
using core::Vec3;

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

Material material_of(const core::FileMaterial& source, const std::string& path) {
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
    material.model = model_of({.metallic = source.metallic > 0.0});
    material.albedo = mean_albedo(source.colour);
    material.roughness = std::clamp(source.roughness, 0.0, 1.0);
    return material;
}

/// Of each vertex the first one at the same place, to the last bit.
std::vector<std::uint32_t> first_at_same_position(const std::vector<Vec3>& vertices) {
    constexpr std::uint32_t kFree = ~0U;
    const auto hash = [](const Vec3& position) {
        constexpr std::size_t kGolden = 0x9e3779b97f4a7c15;
        std::size_t bits = 0;
        for (const double coordinate : position) {  // 0 and -0 are one place
            bits = std::rotl(bits ^ std::bit_cast<std::size_t>(coordinate + 0.0), 29) * kGolden;
        }
        return bits ^ (bits >> 32);
    };
    std::vector<std::uint32_t> slots(std::bit_ceil(2 * vertices.size() + 1), kFree);
    std::vector<std::uint32_t> first;
    first.reserve(vertices.size());
    for (const Vec3& vertex : vertices) {
        std::size_t slot = hash(vertex) & (slots.size() - 1);
        while (slots[slot] != kFree && vertices[slots[slot]] != vertex) {
            slot = (slot + 1) & (slots.size() - 1);
        }
        if (slots[slot] == kFree) slots[slot] = static_cast<std::uint32_t>(first.size());
        first.push_back(slots[slot]);
    }
    return first;
}

using Triangles = std::span<const std::array<std::uint32_t, 3>>;

/// Cuts parts out of a file's mesh. Corners at one position are one vertex of a part, in the order
/// of their first use.
class PartCutter {
 public:
    PartCutter(const std::vector<Vec3>& vertices, const core::Mat3& world_from_file)
        : vertices_(vertices),
          world_from_file_(world_from_file),
          first_(first_at_same_position(vertices)),
          number_(vertices.size(), kNone) {}

    core::TriangleMesh cut(Triangles triangles) {
        core::TriangleMesh part;
        for (std::array<std::uint32_t, 3> triangle : triangles) {
            for (std::uint32_t& corner : triangle) corner = number_in(part, first_[corner]);
            const auto& [a, b, c] = triangle;
            const Vec3& corner = part.vertices[a];
            if (core::has_area(part.vertices[b] - corner, part.vertices[c] - corner)) {
                part.triangles.push_back(triangle);
            }
        }
        for (const auto& triangle : triangles) {
            for (const std::uint32_t corner : triangle) number_[first_[corner]] = kNone;
        }
        return part;
    }

 private:
    static constexpr std::uint32_t kNone = ~0U;

    std::uint32_t number_in(core::TriangleMesh& part, std::uint32_t vertex) {
        std::uint32_t& number = number_[vertex];
        if (number == kNone) {
            number = static_cast<std::uint32_t>(part.vertices.size());
            part.vertices.push_back(world_from_file_ * vertices_[vertex]);
        }
        return number;
    }

    const std::vector<Vec3>& vertices_;
    core::Mat3 world_from_file_;
    std::vector<std::uint32_t> first_;
    std::vector<std::uint32_t> number_;  ///< in the part that is being cut
};

void add_warnings(const core::FileMesh& file, std::vector<std::string>& warnings) {
    warnings.insert(warnings.end(), file.warnings.begin(), file.warnings.end());
    for (const core::FileMaterial& material : file.materials) {
        for (const std::string& text : material.warnings) {
            warnings.push_back("material " + material.name + ": " + text);
        }
    }
}

}  // namespace

bool is_mesh_file(const std::string& path) {
    return core::mesh_format(path) != nullptr;
}

SceneGeometry load_mesh_file(const std::string& path, const MeshFrame& frame) {
    const core::FileMesh file = core::read_mesh_file(path);
    PartCutter cutter(file.mesh.vertices, frame.unit_m * world_from_axes(frame.up));
    SceneGeometry geometry;
    std::size_t begin = 0;
    for (const core::FilePart& part : file.parts) {
        Object object;
        object.name =
            part.name.empty() ? fs::path(path).stem().string() : core::printable(part.name);
        object.material = material_of(file.materials.at(part.material), path);
        object.mesh = cutter.cut(Triangles(file.mesh.triangles).subspan(begin, part.end - begin));
        begin = part.end;
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
