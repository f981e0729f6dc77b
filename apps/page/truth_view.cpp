// SPDX-License-Identifier: MIT
#include "apps/dataset/mesh_library.h"
#include "apps/page/page_views.h"
#include "apps/scene_truth.h"
#include "renderer/scene/load_geometry.h"

#include <filesystem>

namespace apps {
namespace {

constexpr std::size_t kMaxTriangles = 60'000;  // a page turns them at once, in about a megabyte
constexpr double kSimplified = 0.002;          // of the mesh's size, by which surfaces may move

/// `scenes/letter/scene.json` is called `letter`.
std::string scene_name(const std::string& path) {
    const std::filesystem::path file(path);
    const std::string folder = file.parent_path().filename().string();
    return file.stem() == "scene" && !folder.empty() ? folder : file.filename().string();
}

core::TriangleMesh hidden_surfaces(const renderer::SceneGeometry& geometry) {
    core::TriangleMesh mesh;
    for (const renderer::Object& object : geometry.objects) {
        if (object.role == renderer::Role::Hidden) core::append_mesh(object.mesh, mesh);
    }
    return mesh.triangles.size() > kMaxTriangles ? simplify_mesh(mesh, kSimplified) : mesh;
}

}  // namespace

TruthView truth_view(const std::string& scene_path, std::vector<ResultView>& results) {
    const renderer::SceneDescription description = renderer::read_scene_description(scene_path, {});
    renderer::SceneGeometry geometry = renderer::load_geometry(description);
    TruthView view{scene_name(scene_path), hidden_surfaces(geometry), {}};
    const SceneTruth truth(description, std::move(geometry));
    for (ResultView& result : results) {
        const core::DepthMap& columns = result.depth;
        if (columns.depth_m.empty()) continue;
        result.truth = truth.depth_map(columns);
    }
    const bool has_columns = !results.empty() && results.front().truth.has_value();
    view.depth = has_columns ? *results.front().truth : truth.depth_map();
    return view;
}

}  // namespace apps
