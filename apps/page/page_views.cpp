// SPDX-License-Identifier: MIT
#include "apps/page/page_views.h"

#include "apps/dataset/mesh_library.h"
#include "apps/scene_truth.h"
#include "nlos/canvas/colour_map.h"
#include "nlos/preparation/wall_frame.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/scene/load_geometry.h"

#include <fmt/core.h>

#include <filesystem>

namespace apps {

/// The scripts of the views, and the libraries that they stand on, compiled in.
extern const char* const kViewerScripts;

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

/// The wall that everything on the page is placed by.
struct PageWall {
    core::Transform frame_from_world = core::Transform::Identity();
    core::Json footprint;  ///< null where it is not known
};

PageWall page_wall(const PageViews& views) {
    PageWall wall;
    const bool has_points = views.scan.has_value();
    if (!views.results.empty()) {
        wall.frame_from_world = views.results.front().depth.world_from_wall.inverse();
    } else if (has_points) {
        wall.frame_from_world = nlos::derive_wall_frame(*views.scan).world_from_wall.inverse();
    } else if (views.truth) {
        wall.frame_from_world = views.truth->depth.world_from_wall.inverse();
    }
    Eigen::AlignedBox3d box;
    if (has_points) {
        const nlos::WallFrame scanned = nlos::derive_wall_frame(*views.scan);
        for (const double x : {scanned.min_m[0], scanned.max_m[0]}) {
            for (const double y : {scanned.min_m[1], scanned.max_m[1]}) {
                box.extend(wall.frame_from_world *
                           (scanned.world_from_wall * core::Vec3(x, y, 0.0)));
            }
        }
    } else if (!views.results.empty() && !views.results.front().depth.x_m.empty()) {
        const core::DepthMap& depth = views.results.front().depth;
        box.extend(core::Vec3(depth.x_m.front(), depth.y_m.front(), 0.0));
        box.extend(core::Vec3(depth.x_m.back(), depth.y_m.back(), 0.0));
    }
    if (!box.isEmpty()) {
        wall.footprint = {{"x_m", {box.min().x(), box.max().x()}},
                          {"y_m", {box.min().y(), box.max().y()}}};
    }
    return wall;
}

core::Json mesh_json(const TruthView& truth, const PageWall& wall, PageArrays& arrays) {
    std::vector<std::uint32_t> corners;
    for (const auto& triangle : truth.mesh.triangles) {
        corners.insert(corners.end(), triangle.begin(), triangle.end());
    }
    return {{"name", truth.name},
            {"positions", add_points(arrays, truth.mesh.vertices, wall.frame_from_world)},
            {"triangles", arrays.add(corners)}};
}

std::string hex_text(const nlos::Colour& colour) {
    return fmt::format("{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
}

/// The colours of maps, under the names that quantities state, and of results beside each other.
core::Json colours_json() {
    core::Json json;
    for (const auto& [name, map] : {std::pair{"depth", nlos::ColourMap::Viridis},
                                    {"heat", nlos::ColourMap::Inferno},
                                    {"share", nlos::ColourMap::Cividis},
                                    {"diverging", nlos::ColourMap::Diverging}}) {
        std::string table;
        for (const nlos::Colour& colour : nlos::colours_of(map)) table += hex_text(colour);
        json["maps"][name] = table;
    }
    for (const nlos::Colour& colour : nlos::kSeriesColours) {
        json["series"].push_back("#" + hex_text(colour));
    }
    return json;
}

/// The first three rows of a transform.
core::Json rows_of(const core::Transform& transform) {
    core::Json rows = core::Json::array();
    for (int i = 0; i < 3; ++i) {
        const Eigen::RowVector4d row = transform.matrix().row(i);
        rows.push_back(std::vector<double>(row.begin(), row.end()));
    }
    return rows;
}

core::Json views_json(const PageViews& views, const ViewDetail& detail, PageArrays& arrays) {
    const PageWall wall = page_wall(views);
    core::Json json{{"version", 1},
                    {"wall", wall.footprint},
                    {"colours", colours_json()},
                    {"results", core::Json::array()},
                    {"best", 0},
                    {"animations", core::Json::array()}};
    if (!nlos::is_world_frame(wall.frame_from_world)) {
        json["world_from_wall"] = rows_of(wall.frame_from_world.inverse(Eigen::Isometry));
    }
    if (views.scan) {
        const auto add = [&](const core::WallPoints& points) {
            return add_points(arrays, points.positions, wall.frame_from_world);
        };
        json["sensing"] = add(views.scan->sensing);
        if (!views.scan->is_confocal()) {
            json["illumination"] = add(views.scan->illumination);
        }
    }
    std::optional<core::DepthMap> true_depth;
    if (views.truth) true_depth = views.truth->depth;
    const MapScales scales = map_scales(views.results, true_depth);
    if (views.truth) {
        json["truth"] = mesh_json(*views.truth, wall, arrays);
        json["results"].push_back(
            truth_json(*true_depth, views.truth->name, scales, wall.frame_from_world, arrays));
    }
    for (std::size_t i = 0; i < views.results.size(); ++i) {
        if (!detail.shows_result(views, i)) continue;
        if (i == views.best) json["best"] = json["results"].size();
        json["results"].push_back(
            result_json(views.results[i], scales, wall.frame_from_world, detail.halvings, arrays));
    }
    for (std::size_t i = 0; i < std::min(detail.most, views.animations.size()); ++i) {
        json["animations"].push_back(
            animation_json(views.animations[i], wall.frame_from_world, detail.halvings, arrays));
    }
    return json;
}

/// JSON that no browser takes for the end of the script element around it.
std::string script_json(const core::Json& json) {
    std::string text;
    for (const char c : json.dump(-1, ' ', false, core::Json::error_handler_t::replace)) {
        if (c == '<') {
            text += "\\u003c";
        } else {
            text += c;
        }
    }
    return text;
}

std::string data_html(const PageViews& views, const ViewDetail& detail) {
    PageArrays arrays;
    const core::Json json = views_json(views, detail, arrays);
    return "<script type=\"application/json\" id=\"nlos-data\">" + script_json(json) +
           "</script>\n" + arrays.html();
}

/// So often can a view be halved.
int halvings_of(const PageViews& views) {
    int most = 0;
    for (const ResultView& result : views.results) {
        most = std::max(most, halvings_of(result.volume));
    }
    for (const AnimationView& animation : views.animations) {
        most = std::max(most, halvings_of(animation));
    }
    return most;
}

/// Takes detail away. returns   whether there was any
///
/// ratio   of what the data take to what they may take
bool reduce(ViewDetail& detail, int most_halvings, double ratio) {
    if (detail.halvings < most_halvings) {
        const int needed = std::max(1, static_cast<int>(std::log2(ratio)));
        detail.halvings = std::min(most_halvings, detail.halvings + needed);
        return true;
    }
    if (detail.most == 0) return false;
    const auto share = static_cast<std::size_t>(static_cast<double>(detail.most) / ratio);
    detail.most = std::min(detail.most - 1, share);
    return true;
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
        const core::TrueSurface surface = truth.surface(columns);
        result.truth = core::nearest_surfaces(surface, columns);
        if (&result == &results.front()) view.depth = surface.main;
    }
    if (view.depth.depth_m.empty()) view.depth = truth.depth_map();
    return view;
}

bool ViewDetail::shows_result(const PageViews& views, std::size_t index) const {
    if (most == 0) return false;
    return index == views.best || index < (views.best < most ? most : most - 1);
}

std::string FittedViews::html() const {
    return data.empty() ? "" : data + kViewerScripts;
}

FittedViews fit_views(const PageViews& views, double limit_bytes) {
    FittedViews fitted;
    if (views.empty()) return fitted;
    fitted.detail.most = std::max(views.results.size(), views.animations.size());
    limit_bytes = std::max(1.0, limit_bytes);
    const int most_halvings = halvings_of(views);
    for (;;) {
        fitted.data = data_html(views, fitted.detail);
        const auto bytes = static_cast<double>(fitted.data.size());
        if (fitted.whole_bytes == 0.0) fitted.whole_bytes = bytes;
        if (bytes <= limit_bytes) return fitted;
        if (!reduce(fitted.detail, most_halvings, bytes / limit_bytes)) break;
    }
    fitted.data.clear();
    fitted.detail.has_views = false;
    return fitted;
}

}  // namespace apps
