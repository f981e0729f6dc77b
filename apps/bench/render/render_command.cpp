// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/render/render.h"
#include "apps/commands.h"

namespace apps {
namespace {

void declare(CLI::App& command, RenderBenchSettings& settings) {
    add_setting(command, "--scene", settings.scene, "Scene description")->type_name("FILE");
    add_setting(command, "--camera-scene", settings.camera_scene, "Image to try gates on")
        ->type_name("FILE");
    add_setting(command,
                "--exclusion-scenes",
                settings.exclusion_scenes,
                "Scenes with surfaces to exclude from ellipsoidal connections")
        ->type_name("FILE");
    add_setting(command,
                "--agreement-scenes",
                settings.agreement_scenes,
                "Confocal scans on which third_bounce and path are compared bin by bin")
        ->type_name("FILE");
    add_setting(command, "--part", settings.part, "What to measure")
        ->check(
            one_of({"all", "curves", "third_bounce", "accuracy", "gates", "exclusion", "scaling"}));
    add_setting(command, "--repeats", settings.repeats, "Runs per point", {1, 1000});
    command.add_flag("--quick", settings.quick, "Leave out what takes longest");
}

}  // namespace

void add_bench_render_command(CLI::App& bench) {
    add_benchmark<RenderBenchSettings>(
        bench,
        {"render", "Every estimator on one scene", "nlos bench render -o out/bench --quick"},
        declare,
        measure_render);
}

}  // namespace apps
