// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/outcome.h"
#include "apps/terminal.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/output_file.h"
#include "renderer/scene/load_geometry.h"

#include <algorithm>
#include <filesystem>

namespace apps {
namespace {

namespace fs = std::filesystem;

struct SceneArguments {
    std::string geometry;
    std::string scene;
    double unit_m = 0.0;  ///< 0: not given
    std::string up;       ///< empty: not given
};

Eigen::AlignedBox3d box_of_hidden(const renderer::SceneGeometry& geometry) {
    Eigen::AlignedBox3d box;
    for (const renderer::Object& object : geometry.objects) {
        if (object.role != renderer::Role::Hidden) continue;
        for (const core::Vec3& vertex : object.mesh.vertices) box.extend(vertex);
    }
    return box;
}

/// A wall twice as wide as what is hidden, as far before it (towards smaller z) as that is wide:
/// every point of the wall then sees it at less than 60 degrees.
core::Json wall_before(const Eigen::AlignedBox3d& box) {
    const core::Vec3 size = box.sizes();
    double width_m = std::max(size.x(), size.y());
    if (!(width_m > 0.0)) width_m = size.z();
    const core::Vec3 centre = box.center();
    return {{"center_m", {centre.x(), centre.y(), box.min().z() - width_m}},
            {"normal", {0.0, 0.0, 1.0}},
            {"up", {0.0, 1.0, 0.0}},
            {"size_m", {2.0 * width_m, 2.0 * width_m}}};
}

void run(const SceneArguments& arguments) {
    require_suffix(arguments.scene, {".json"});
    core::check_targets({arguments.scene}, {arguments.geometry});
    core::Json scene;
    const fs::path folder = fs::absolute(arguments.scene).lexically_normal().parent_path();
    scene["geometry"] =
        fs::absolute(arguments.geometry).lexically_normal().lexically_relative(folder).string();
    if (arguments.unit_m > 0.0) scene["geometry_unit_m"] = arguments.unit_m;
    if (!arguments.up.empty()) scene["geometry_up"] = arguments.up;
    renderer::SceneDescription description;
    core::read_value(scene, "scene", description);
    description.geometry = arguments.geometry;
    const renderer::SceneGeometry geometry = renderer::load_geometry(description);
    const Eigen::AlignedBox3d box = box_of_hidden(geometry);
    if (box.isEmpty() || !(box.sizes().maxCoeff() > 0.0)) {
        throw core::Error(arguments.geometry, "has nothing to hide", "must hold a surface");
    }
    scene["relay_wall"] = wall_before(box);
    scene["scan"] = {{"pattern", "confocal"}, {"sensing_points", {64, 64}}};
    scene["time_axis"] = "auto";
    core::write_text_file(arguments.scene, core::json_text(scene));
    for (const std::string& warning : geometry.warnings) warn(warning);
    for (const std::string& text : renderer::describe_frame(description)) print("{}\n", text);
    note_written({arguments.scene});
    outcome()["relay_wall"] = scene["relay_wall"];
    const core::Vec3 size = box.sizes();
    print(
        "wrote {}: {:.3g} x {:.3g} x {:.3g} m, behind a wall of {:.3g} m at z = {:.3g} m that "
        "looks along z\n",
        arguments.scene,
        size.x(),
        size.y(),
        size.z(),
        scene["relay_wall"]["size_m"][0].get<double>(),
        scene["relay_wall"]["center_m"][2].get<double>());
}

void declare_scene(Command& command) {
    auto& arguments = command.runs<SceneArguments>(run);
    add_file_option(
        command, "MESH", arguments.geometry, "What is hidden (.glb, .gltf, .obj, .ply, .stl)")
        ->required();
    add_output_option(command, arguments.scene, "Scene to write (.json)")->required();
    command.add_option("--unit-m", arguments.unit_m, "Metres in a unit of an OBJ, PLY or STL file")
        ->check(CLI::PositiveNumber);
    command.add_option("--up", arguments.up, "Axis of such a file that points up, as in z or -z");
}

}  // namespace

extern const CommandRow kSceneCommand{"scene",
                                      "Propose a wall, a scan and a time axis around a mesh",
                                      "nlos scene data/walk/vest.obj -o vest.json",
                                      declare_scene};

}  // namespace apps
