// SPDX-License-Identifier: MIT
#include "renderer/mesh_file/assimp_file.h"

#include "renderer/core/error.h"
#include "renderer/core/json_file.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/sandboxed_process.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

namespace renderer {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCompleteFile = "must be a complete OBJ, PLY or STL file";

/// Assimp's message, which may hold anything, as a part of one line.
std::string part_of_a_line(const std::string& text) {
    constexpr std::size_t kLongest = 120;
    return core::printable(text.substr(0, kLongest));
}

/// The files that assimp may open: the mesh file, and material files (MTL) beside it; and which
/// materials have a colour in these, of which assimp itself keeps no record.
///
/// Pipes, devices and files elsewhere, which a mesh file could name, do not exist for it.
class MaterialFiles : public Assimp::DefaultIOSystem {
 public:
    explicit MaterialFiles(std::string mesh_path) : mesh_path_(std::move(mesh_path)) {}

    /// True for materials whose diffuse colour (Kd) a material file states.
    bool states_colour(const std::string& material) const { return coloured_.contains(material); }
    /// Names material files that are missing.
    const std::vector<std::string>& warnings() const { return warnings_; }

    bool Exists(const char* path) const override { return is_allowed(path); }

    Assimp::IOStream* Open(const char* path, const char* mode) override {
        const bool is_allowed_file = is_allowed(path);
        if (path != mesh_path_ && is_allowed_file) note_colours(path);
        if (path != mesh_path_ && !is_allowed_file) note_missing(path);
        return is_allowed_file ? DefaultIOSystem::Open(path, mode) : nullptr;
    }

 private:
    bool is_allowed(const std::string& path) const {
        const auto folder = [](const std::string& file) {
            return fs::absolute(file).lexically_normal().parent_path();
        };
        std::error_code ignored;
        return folder(path) == folder(mesh_path_) && fs::is_regular_file(path, ignored);
    }

    void note_colours(const std::string& path) {
        std::ifstream file(path);
        std::string material;
        for (std::string line; std::getline(file, line);) {
            std::istringstream words(line);
            std::string keyword;
            words >> keyword;
            if (keyword == "Kd") coloured_.insert(material);
            if (keyword != "newmtl" || !std::getline(words >> std::ws, material)) continue;
            material.erase(material.find_last_not_of(" \t\r") + 1);  // as assimp takes it
        }
    }

    /// Assimp goes on to try other names, which nobody gave.
    void note_missing(const std::string& path) {
        if (!warnings_.empty()) return;
        warnings_.push_back(part_of_a_line(fs::path(path).filename().string()) +
                            " is not beside it: materials that it would define are white");
    }

    std::string mesh_path_;
    std::set<std::string> coloured_;
    std::vector<std::string> warnings_;
};

FileMaterial read_material(const aiMaterial& source, const MaterialFiles& files) {
    FileMaterial material;
    const std::string name = source.GetName().C_Str();
    material.name = core::printable(name);
    const auto number = [&](const char* key, unsigned type, unsigned index, double otherwise) {
        ai_real value = 0;
        return source.Get(key, type, index, value) == aiReturn_SUCCESS ? static_cast<double>(value)
                                                                       : otherwise;
    };
    aiColor3D colour(1, 1, 1);
    source.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
    if (files.states_colour(name)) {  // else the library makes up a grey
        material.colour = {colour.r, colour.g, colour.b};
    }
    material.metallic = number(AI_MATKEY_METALLIC_FACTOR, 0.0);
    material.roughness = number(AI_MATKEY_ROUGHNESS_FACTOR, 1.0);
    aiColor3D emission(0, 0, 0);
    source.Get(AI_MATKEY_COLOR_EMISSIVE, emission);
    if (source.GetTextureCount(aiTextureType_DIFFUSE) > 0) {
        material.warnings.emplace_back("its texture is not modelled; the colour counts alone");
    }
    if (!emission.IsBlack()) material.warnings.emplace_back("its emission is not modelled");
    if (number(AI_MATKEY_OPACITY, 1.0) < 1.0) {
        material.warnings.emplace_back("its transparency is not modelled: it is opaque");
    }
    return material;
}

/// The triangles of a mesh; corners whose positions are equal to the last bit share a vertex.
FileMesh read_mesh(const aiMesh& source, const std::string& name) {
    FileMesh mesh;
    mesh.name = name;
    mesh.material = source.mMaterialIndex;
    std::map<std::tuple<float, float, float>, std::uint32_t> vertex_at;
    std::vector<std::uint32_t> renumbered(source.mNumVertices, ~0u);
    for (unsigned f = 0; f < source.mNumFaces; ++f) {
        const aiFace& face = source.mFaces[f];
        if (face.mNumIndices != 3) continue;
        std::array<std::uint32_t, 3>& triangle = mesh.triangles.emplace_back();
        for (std::size_t c = 0; c < 3; ++c) {
            std::uint32_t& vertex = renumbered.at(face.mIndices[c]);
            if (vertex == ~0u) {
                const aiVector3D& p = source.mVertices[face.mIndices[c]];
                const auto [place, is_new] = vertex_at.try_emplace(
                    {p.x, p.y, p.z}, static_cast<std::uint32_t>(mesh.vertices.size()));
                if (is_new) mesh.vertices.push_back({p.x, p.y, p.z});
                vertex = place->second;
            }
            triangle[c] = vertex;
        }
    }
    return mesh;
}

/// The meshes below a node, in the order of the file, with the names of their nodes.
void read_node(const aiScene& scene, const aiNode& node, AssimpFile& file) {
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
        const aiMesh& source = *scene.mMeshes[node.mMeshes[i]];
        FileMesh mesh = read_mesh(source, core::printable(node.mName.C_Str()));
        if (!mesh.triangles.empty()) file.meshes.push_back(std::move(mesh));
        if (!source.HasVertexColors(0)) continue;
        const std::string text = "the colours of its vertices are not modelled";
        if (std::find(file.warnings.begin(), file.warnings.end(), text) == file.warnings.end()) {
            file.warnings.push_back(text);
        }
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) read_node(scene, *node.mChildren[i], file);
}

/// Leaves the importer no choice but the format that the suffix names.
void keep_one_format(Assimp::Importer& importer, const std::string& suffix) {
    Assimp::BaseImporter* kept = importer.GetImporter(suffix.c_str());
    for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
        if (importer.GetImporter(i) != kept) importer.UnregisterLoader(importer.GetImporter(i));
    }
}

/// In the header of a PLY file that does not end, assimp looks for its end forever.
void require_ply_header(const std::string& path) {
    constexpr std::size_t kLongestHeader = 1 << 20;
    const std::string start = core::first_bytes(path, kLongestHeader);
    if (start.starts_with("ply") && start.find("end_header") != std::string::npos) return;
    throw core::Error(path, "is damaged: its PLY header is not complete", kCompleteFile);
}

AssimpFile read_with_library(const std::string& path, const std::string& suffix) {
    Assimp::Importer importer;
    if (suffix == ".ply") require_ply_header(path);
    keep_one_format(importer, suffix);
    auto files = std::make_unique<MaterialFiles>(path);
    MaterialFiles& material_files = *files;
    importer.SetIOHandler(files.release());  // which owns it from here on
    const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
    if (scene == nullptr || scene->mRootNode == nullptr) {
        throw core::Error(
            path, "is damaged (" + part_of_a_line(importer.GetErrorString()) + ")", kCompleteFile);
    }
    AssimpFile file;
    for (unsigned i = 0; i < scene->mNumMaterials; ++i) {
        file.materials.push_back(read_material(*scene->mMaterials[i], material_files));
    }
    file.warnings = material_files.warnings();
    read_node(*scene, *scene->mRootNode, file);
    return file;
}

core::Json to_json(const AssimpFile& file) {
    core::Json json = {{"warnings", file.warnings},
                       {"meshes", core::Json::array()},
                       {"materials", core::Json::array()}};
    for (const FileMesh& mesh : file.meshes) {
        json["meshes"].push_back({{"name", mesh.name},
                                  {"vertices", core::to_binary(mesh.vertices)},
                                  {"triangles", core::to_binary(mesh.triangles)},
                                  {"material", mesh.material}});
    }
    for (const FileMaterial& material : file.materials) {
        json["materials"].push_back({{"name", material.name},
                                     {"colour", material.colour},
                                     {"metallic", material.metallic},
                                     {"roughness", material.roughness},
                                     {"warnings", material.warnings}});
    }
    return json;
}

AssimpFile from_json(const core::Json& json) {
    AssimpFile file;
    json.at("warnings").get_to(file.warnings);
    for (const core::Json& source : json.at("meshes")) {
        FileMesh& mesh = file.meshes.emplace_back();
        source.at("name").get_to(mesh.name);
        core::from_binary(source.at("vertices"), mesh.vertices);
        core::from_binary(source.at("triangles"), mesh.triangles);
        source.at("material").get_to(mesh.material);
    }
    for (const core::Json& source : json.at("materials")) {
        FileMaterial& material = file.materials.emplace_back();
        source.at("name").get_to(material.name);
        source.at("colour").get_to(material.colour);
        source.at("metallic").get_to(material.metallic);
        source.at("roughness").get_to(material.roughness);
        source.at("warnings").get_to(material.warnings);
    }
    return file;
}

}  // namespace

AssimpFile read_with_assimp(const std::string& path, const std::string& suffix) {
    return from_json(core::run_sandboxed(
        path,
        [&] { return to_json(read_with_library(path, suffix)); },
        [&](const std::string& message) {
            return core::Error(path, "is damaged (" + part_of_a_line(message) + ")", kCompleteFile);
        }));
}

}  // namespace renderer
