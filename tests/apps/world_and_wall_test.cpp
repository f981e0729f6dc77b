// SPDX-License-Identifier: MIT
// A wall that stands elsewhere and looks elsewhere: places in the world stay there, and what is in
// the wall's frame says so.
#include "nlos/formats/volume_file.h"
#include "renderer/core/mesh_formats/mesh_formats.h"
#include "renderer/core/settings/settings_json.h"
#include "tests/support/command_line.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using core::Vec3;
using test_support::CommandLine;
using test_support::file_bytes;

constexpr double kLetterDepth_m = 0.7;
constexpr const char* kTurnedFrame =
    "wall's frame: from (2, 0.5, -1) m of the world, wall x along ";

class WorldAndWall : public CommandLine {
 protected:
    static core::Transform pose() {
        return Eigen::Translation3d(2.0, 0.5, -1.0) *
               Eigen::AngleAxisd(kRoll_deg / core::kDegreesPerRadian, Vec3::UnitZ()) *
               Eigen::AngleAxisd(kTurn_deg / core::kDegreesPerRadian, Vec3::UnitY());
    }

    /// The letter and its wall, turned and moved as one.
    std::string turned_scene() const {
        const core::Transform world_from_wall = pose();
        const Vec3 normal = world_from_wall.linear().col(2);
        const Vec3 up = world_from_wall.linear().col(1);
        const core::Json wall = {
            {"center_m", core::write_value(Vec3(world_from_wall.translation()))},
            {"normal", core::write_value(normal)},
            {"up", core::write_value(up)}};
        const core::Json letter = {{"mesh", "scene.glb"},
                                   {"rotation_deg", {0.0, kTurn_deg, kRoll_deg}},
                                   {"translation_m", wall["center_m"]}};
        return make_scene(
            "turned.json",
            {{"geometry", nullptr}, {"relay_wall", wall}, {"objects", {{"letter", letter}}}});
    }

    /// Renders and reconstructs a scene; its volume, beside which lie points and a capture.
    std::string reconstruct(const std::string& scene) const {
        EXPECT_EQ(run("render " + scene + " -o " + file("c.h5")).status, 0);
        const std::string arguments = "reconstruct " + file("c.h5") + " --method lct -o " +
                                      file("v.h5") + " --ply " + file("v.ply");
        EXPECT_EQ(run(arguments).status, 0);
        return file("v.h5");
    }

    void expect_said(const std::string& path, const std::vector<std::string>& lines) const {
        const std::string said = run("info " + path).out;
        for (const std::string& line : lines) {
            EXPECT_NE(said.find("\n" + line), std::string::npos) << line << "\n" << said;
        }
    }

 private:
    static constexpr double kTurn_deg = 40.0;
    static constexpr double kRoll_deg = 20.0;
};

TEST_F(WorldAndWall, PointsAreInTheWorldAndAxesInTheWallsFrame) {
    const nlos::Reconstruction result = nlos::read_volume(reconstruct(turned_scene()));
    const core::Transform& world_from_wall = result.volume.axes.world_from_wall;
    EXPECT_TRUE(world_from_wall.isApprox(pose(), 1e-6)) << world_from_wall.matrix();
    const core::TriangleMesh ply = core::read_mesh_file(file("v.ply")).mesh;
    ASSERT_EQ(ply.vertices.size(), result.points.positions.size());
    std::size_t found = 0;
    for (std::size_t ix = 0; ix < result.depth.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < result.depth.y_m.size(); ++iy) {
            const double depth_m = result.depth.depth_m[result.depth.index(ix, iy)];
            if (std::isnan(depth_m)) continue;
            EXPECT_NEAR(depth_m, kLetterDepth_m, 0.05);
            const Vec3 place(result.depth.x_m[ix], result.depth.y_m[iy], depth_m);
            ASSERT_LT(found, ply.vertices.size());
            EXPECT_LT((result.points.positions[found] - pose() * place).norm(), 1e-5);
            EXPECT_LT((ply.vertices[found] - pose() * place).norm(), 1e-5);
            ++found;
        }
    }
    EXPECT_EQ(found, result.points.positions.size());
    EXPECT_GT(found, 20U);
}

TEST_F(WorldAndWall, InfoSaysWhichFrameItMeans) {
    const std::string scene = turned_scene();
    const std::string volume = reconstruct(scene);
    expect_said(scene, {kTurnedFrame});
    expect_said(file("c.h5"), {kTurnedFrame});
    expect_said(volume,
                {"wall x: 16 voxels, ",
                 "wall y: 16 voxels, ",
                 "depth from the wall: ",
                 kTurnedFrame,
                 "surface points: "});
    const std::string usual = make_scene("scene.json", core::Json::object());
    expect_said(usual, {"wall's frame: the world's\n"});
    expect_said(reconstruct(usual), {"wall x: 16 voxels, ", "wall's frame: the world's\n"});
}

TEST_F(WorldAndWall, PagesKnowTheWayFromTheWallToTheWorld) {
    for (const bool is_turned : {true, false}) {
        const std::string scene =
            is_turned ? turned_scene() : make_scene("scene.json", core::Json::object());
        const std::string folder = file(is_turned ? "turned" : "usual");
        fs::create_directory(folder);
        fs::copy_file(reconstruct(scene), folder + "/v.h5");
        ASSERT_EQ(run("report " + folder + " -o " + file("page.html")).status, 0);
        const std::string page = file_bytes(file("page.html"));
        EXPECT_EQ(page.find("\"world_from_wall\":[[0.7") != std::string::npos, is_turned);
        EXPECT_NE(page.find(is_turned ? "from (2, 0.5, -1) m of the world" : "the world&#39;s"),
                  std::string::npos);
    }
}

}  // namespace
