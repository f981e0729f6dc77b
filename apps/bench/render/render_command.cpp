// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/bench/render/render.h"
#include "apps/commands.h"

#include <memory>

namespace apps {
namespace {

struct BenchArguments {
    BenchOutput output;
    RenderBenchSettings settings;
};

void run(const BenchArguments& arguments) {
    run_benchmark(arguments.output, "render", [&](const core::Progress& progress) {
        return render_result(bench_render(arguments.settings, progress));
    });
}

}  // namespace

void add_bench_render_command(CLI::App& bench) {
    const auto arguments = std::make_shared<BenchArguments>();
    CLI::App* render = bench.add_subcommand("render", "Every estimator on one scene");
    add_output_options(*render, arguments->output);
    RenderBenchSettings& settings = arguments->settings;
    render->add_option("--scene", settings.scene, "Scene description")->capture_default_str();
    render->add_option("--camera-scene", settings.camera_scene, "Image to try gates on")
        ->capture_default_str();
    render
        ->add_option("--exclusion-scenes",
                     settings.exclusion_scenes,
                     "Scenes with surfaces to exclude from ellipsoidal connections")
        ->capture_default_str();
    render
        ->add_option("--agreement-scenes",
                     settings.agreement_scenes,
                     "Confocal scans on which third_bounce and path are compared bin by bin")
        ->capture_default_str();
    render->add_option("--part", settings.part, "What to measure")
        ->capture_default_str()
        ->check(CLI::IsMember(
            {"all", "curves", "third_bounce", "accuracy", "gates", "exclusion", "scaling"}));
    render->add_option("--repeats", settings.repeats, "Runs per point")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    render->add_flag("--quick", settings.quick, "Leave out what takes longest");
    render->footer(settings_footer({}, "nlos bench render -o out/bench --quick"));
    render->callback([arguments] { run(*arguments); });
}

}  // namespace apps
