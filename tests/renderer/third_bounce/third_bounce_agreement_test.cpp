// SPDX-License-Identifier: MIT
// The deterministic third bounce against path tracing.
#include "renderer/render.h"
#include "renderer/scene/scene_file.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using core::Vec3;
using renderer::Estimator;

// Bins that paths fill well enough for a normal distribution, each within its confidence interval.
// `bias` is the error allowed to the deterministic side, relative to the pair's largest bin.
void expect_bins_agree(const core::Capture& deterministic,
                       const core::Capture& paths,
                       double bias) {
    constexpr double kLargestRelativeSigma = 0.1;
    ASSERT_TRUE(paths.variance.has_value());
    struct Compared {
        double z;
        std::size_t pair;
        std::size_t bin;
    };
    std::vector<Compared> compared;
    for (std::size_t pair = 0; pair < paths.transient.num_pairs(); ++pair) {
        const auto a = deterministic.transient.histogram(pair);
        const auto b = paths.transient.histogram(pair);
        const auto variance = paths.variance->histogram(pair);
        const double allowed = bias * double{*std::max_element(a.begin(), a.end())};
        for (std::size_t bin = 0; bin < a.size(); ++bin) {
            const double sigma = std::sqrt(double{variance[bin]});
            if (!(sigma > 0.0) || sigma > kLargestRelativeSigma * double{b[bin]}) continue;
            const double difference = std::abs(double{a[bin]} - double{b[bin]});
            compared.push_back({std::max(0.0, difference - allowed) / sigma, pair, bin});
        }
    }
    ASSERT_GT(compared.size(), 50U);
    const double level = test_support::sidak_level(1e-3, compared.size());
    for (const auto& [z, pair, bin] : compared) {
        EXPECT_GT(test_support::normal_tail(z), level) << "pair " << pair << " bin " << bin;
    }
}

struct SceneCase {
    const char* name;
    std::vector<std::string> overrides;
    double target_error = 2e-3;
};

void PrintTo(const SceneCase& scene, std::ostream* out) {
    *out << scene.name;
}

class ThirdBounceOfScenes : public testing::TestWithParam<SceneCase> {};

TEST_P(ThirdBounceOfScenes, AgreesWithPathTracingBinByBin) {
    const std::string path =
        std::string(NLOS_SOURCE_DIR "/scenes/") + GetParam().name + "/scene.json";
    const auto description = renderer::read_scene_description(path, GetParam().overrides);
    const core::Scan scan = renderer::make_scan(description);
    const renderer::Scene scene = renderer::load_scene(description, scan);
    renderer::RenderSettings settings = description.render;
    settings.max_bounces = 3;
    settings.target_error = GetParam().target_error;
    const auto deterministic =
        renderer::render(scene, scan, description.time_axis, settings, core::Progress{});
    EXPECT_EQ(deterministic.samples_per_pair, 0U);
    ASSERT_EQ(deterministic.sources.size(), 1U);
    EXPECT_EQ(deterministic.sources[0].estimator, Estimator::ThirdBounce);

    settings.method = Estimator::Path;
    settings.target_error.reset();
    settings.variance = true;
    const auto paths =
        renderer::render(scene, scan, description.time_axis, settings, core::Progress{});
    expect_bins_agree(deterministic.capture, paths.capture, 0.5 * GetParam().target_error);
}

const std::vector<std::string> kSmall{"scan.sensing_points=[4,4]",
                                      "render.samples=100000",
                                      "time_axis.bin_width_m=0.016",
                                      "time_axis.num_bins=256"};

std::vector<std::string> small_with(const std::string& more) {
    std::vector<std::string> overrides = kSmall;
    overrides.push_back(more);
    return overrides;
}

INSTANTIATE_TEST_SUITE_P(
    Scenes,
    ThirdBounceOfScenes,
    testing::Values(SceneCase{"letter", kSmall},
                    SceneCase{"bars", kSmall},
                    SceneCase{"corner", kSmall},
                    SceneCase{"glossy", kSmall, 5e-3},
                    SceneCase{"curved", {"render.samples=25600", "time_axis.bin_width_m=0.032"}},
                    SceneCase{"bars", small_with("scan.pattern=single")},
                    SceneCase{"glossy", small_with("scan.pattern=single"), 5e-3},
                    SceneCase{"bars",
                              {"scan.pattern=exhaustive",
                               "scan.sensing_points=[3,3]",
                               "scan.illumination_points=[2,2]",
                               "render.samples=100000",
                               "time_axis.bin_width_m=0.016"}}),
    [](const auto& test) {
        return std::string(test.param.name) + "_" + std::to_string(test.index);
    });

// Path tracing alone and auto, which traces paths only for what it cannot integrate.
TEST(AutoMethod, AddsPathsForNarrowLobesAndHigherOrders) {
    const core::WallScan scan = test_support::confocal_scan({{-0.2, 0.1, 0.0}, {0.1, 0.0, 0.0}});
    renderer::SceneGeometry geometry;
    geometry.objects.push_back(test_support::parallelogram_object(
        {Vec3(-0.3, -0.2, 0.6), Vec3(0.3, 0, 0), Vec3(0, 0.4, 0), 0.8}));
    geometry.objects.push_back(test_support::parallelogram_object(
        {Vec3(0.05, -0.2, 0.6), Vec3(0.3, 0, -0.1), Vec3(0, 0.4, 0), 0.9}));
    geometry.objects[1].material.model = renderer::model_of({.metallic = true});
    geometry.objects[1].material.roughness = 0.16;
    const renderer::Scene scene(std::move(geometry), scan, renderer::RelayWall{});
    renderer::RenderSettings settings;
    settings.max_bounces = 4;
    settings.samples = 400'000;
    settings.variance = true;
    settings.by_order = true;
    settings.element_tolerance = 2e-3;
    const core::TimeAxis axis{1.0, 0.02, 60};
    const auto mixed = renderer::render(scene, scan, axis, settings, core::Progress{});
    ASSERT_EQ(mixed.sources.size(), 3U);
    settings.method = Estimator::Path;
    settings.element_tolerance.reset();
    settings.seed = 1;
    const auto paths = renderer::render(scene, scan, axis, settings, core::Progress{});
    ASSERT_EQ(paths.sources.size(), 1U);
    for (const std::size_t order : {2U, 3U}) {
        double sum_mixed = 0.0;
        double sum_paths = 0.0;
        for (const float value : mixed.capture.by_order[order].values()) sum_mixed += double{value};
        for (const float value : paths.capture.by_order[order].values()) sum_paths += double{value};
        EXPECT_NEAR(sum_mixed / sum_paths, 1.0, 0.02) << "order " << order + 1;
    }
    // Both have noise: widen the second's interval to the difference's.
    core::Capture both = paths.capture;
    for (std::size_t i = 0; i < both.variance->values().size(); ++i) {
        both.variance->values()[i] += mixed.capture.variance->values()[i];
    }
    expect_bins_agree(mixed.capture, both, 2.5e-3);
}

}  // namespace
