// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"
#include "scenes/shapes.h"

namespace scenes {
namespace {

/// An F, 0.4 m wide and 0.6 m high, that reads correctly for an eye at the relay wall looking along
/// +z with y up: to that eye, right is -x. The arms share their vertices with the stem, so that no
/// ray slips through between them.
core::TriangleMesh make_f() {
    const double left = -0.20;
    const double stem = -0.08;
    const double heights[] = {-0.30, -0.04, 0.08, 0.18, 0.30};
    core::TriangleMesh mesh;
    const auto add_vertex = [&](double right, double up) {
        mesh.vertices.emplace_back(-right, up, 0.0);
        return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    };
    const auto add_quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    };
    std::uint32_t stem_left[5];
    std::uint32_t stem_right[5];
    for (int i = 0; i < 5; ++i) {
        stem_left[i] = add_vertex(left, heights[i]);
        stem_right[i] = add_vertex(stem, heights[i]);
    }
    for (int i = 0; i < 4; ++i) {
        add_quad(stem_left[i], stem_right[i], stem_right[i + 1], stem_left[i + 1]);
    }
    const auto add_arm = [&](int row, double end) {
        const std::uint32_t lower = add_vertex(end, heights[row]);
        const std::uint32_t upper = add_vertex(end, heights[row + 1]);
        add_quad(stem_right[row], lower, upper, stem_right[row + 1]);
    };
    add_arm(3, 0.20);
    add_arm(1, 0.12);
    return mesh;
}

}  // namespace

GeneratedScene make_letter() {
    GeneratedScene scene{"letter", {}, {}};
    scene.add("letter", make_f(), {0.0, 0.0, 0.7}, diffuse(0.9));
    return scene;
}

}  // namespace scenes
