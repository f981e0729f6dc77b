// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"
#include "scenes/shapes.h"

#include <cmath>

namespace scenes {
namespace {

/// Bumps on a sphere: where they sit, how far they stand out [m], and how narrow they are.
struct Bump {
    core::Vec3 direction;
    double height_m;
    double sharpness;
};

/// Distance of an animal-like smooth surface from its centre: a body with a head, two ears, feet
/// and a tail; each bump is a Gaussian of the angle to its direction.
double animal_radius_m(const core::Vec3& direction) {
    static const Bump kBumps[] = {
        {{-0.55, 0.55, -0.45}, 0.050, 6.0},   // head
        {{-0.25, 0.95, -0.10}, 0.070, 40.0},  // ears
        {{-0.60, 0.80, 0.25}, 0.065, 40.0},
        {{-0.50, -0.75, -0.60}, 0.035, 14.0},  // feet
        {{0.45, -0.80, -0.50}, 0.035, 14.0},
        {{0.95, 0.10, 0.10}, 0.035, 18.0},  // tail
    };
    double radius = 0.125;
    for (const Bump& bump : kBumps) {
        const double cosine = direction.dot(bump.direction.normalized());
        radius += bump.height_m * std::exp(bump.sharpness * (cosine - 1.0));
    }
    return radius;
}

GeneratedScene with_animal(const std::string& name) {
    GeneratedScene scene{name, {}, {}};
    scene.add("animal", make_radial_surface(4, animal_radius_m), {0.0, -0.03, 0.7}, diffuse(0.8));
    return scene;
}

}  // namespace

GeneratedScene make_animal() {
    return with_animal("animal");
}

GeneratedScene make_bars() {
    GeneratedScene scene = with_animal("bars");
    for (int i = 0; i < 5; ++i) {
        scene.add("bar" + std::to_string(i + 1),
                  make_box({0.03, 0.7, 0.02}),
                  {0.15 * (i - 2), 0.0, 0.45},
                  diffuse(0.5));
    }
    return scene;
}

}  // namespace scenes
