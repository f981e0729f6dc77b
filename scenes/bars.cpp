// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"
#include "scenes/shapes.h"

#include <string>

namespace scenes {

GeneratedScene make_bars() {
    GeneratedScene scene{"bars", {}, {}};
    scene.geometry.objects.push_back(
        place("animal", make_animal_mesh(), {0.0, -0.03, 0.7}, diffuse(0.8)));
    for (int i = 0; i < 5; ++i) {
        scene.geometry.objects.push_back(place("bar" + std::to_string(i + 1),
                                               make_box({0.03, 0.7, 0.02}),
                                               {0.15 * (i - 2), 0.0, 0.45},
                                               diffuse(0.5)));
    }
    return scene;
}

}  // namespace scenes
