// SPDX-License-Identifier: MIT
// Resampled paths against path tracing: same means whatever is reused. Neighbours share their
// noise, so the spread is taken from independent renders, not from variances of single values.
#include "renderer/core/random.h"
#include "renderer/core/system/parallel.h"
#include "renderer/restir_render.h"
#include "tests/renderer/restir/restir_fixture.h"
#include "tests/support/error_message.h"
#include "tests/support/repeated_estimates.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace restir_test {
namespace {

using core::Vec3;
using renderer::Estimator;
using test_support::Estimate;
using test_support::expect_same_means;
using test_support::Numbers;
using test_support::repeat;
using test_support::sums_of;

Estimate render_often(const renderer::Scene& scene,
                      const core::Scan& scan,
                      const core::TimeAxis& axis,
                      renderer::RenderSettings settings,
                      const std::string& name) {
    return repeat(
        [&](std::uint64_t seed) {
            settings.seed = seed;
            return sums_of(renderer::render(scene, scan, axis, settings, {}).capture.transient);
        },
        name);
}

struct Case {
    std::string name;
    std::function<void(renderer::RenderSettings&)> change;
};

const core::TimeAxis kImageHistogram{1.8, 0.3, 6};
const core::TimeAxis kImageGate{2.2, 0.6, 1};

const std::vector<Case> kCases{
    {"candidates", [](auto& s) { s.restir.reuse = renderer::Reuse::None; }},
    {"walks",
     [](auto& s) {
         s.restir.candidates = renderer::Candidates::Path;
         s.restir.walks = 32;
     }},
    {"ellipsoidal",
     [](auto& s) {
         s.restir.candidates = renderer::Candidates::Ellipsoidal;
         s.restir.walks = 16;
     }},
    {"ellipsoidal_everywhere",
     [](auto& s) {
         s.restir.candidates = renderer::Candidates::Ellipsoidal;
         s.restir.walks = 16;
         s.exclude = renderer::Exclusion::None;
     }},
    {"all",
     [](auto& s) {
         s.restir.candidates = renderer::Candidates::All;
         s.restir.walks = 8;
     }},
    {"default", [](auto&) {}},
    {"one_round", [](auto& s) { s.restir.rounds = 1; }},
    {"eight_rounds", [](auto& s) { s.restir.rounds = 8; }},
    {"naive", [](auto& s) { s.restir.reuse = renderer::Reuse::Naive; }},
    {"plane", [](auto& s) { s.restir.chart = renderer::Chart::Plane; }},
    {"barycentric", [](auto& s) { s.restir.chart = renderer::Chart::Barycentric; }},
    {"hemisphere", [](auto& s) { s.restir.chart = renderer::Chart::Hemisphere; }},
    {"midpoint", [](auto& s) { s.restir.gauge = renderer::Gauge::Midpoint; }}};

struct Setting {
    const char* name;
    core::Scan scan;
    core::TimeAxis axis;
    int max_bounces;
    bool glossy;
    int samples = 1040;  ///< path tracing takes eight times as many
};

std::vector<Setting> settings() {
    return {{"gate", wall_scan(core::ScanPattern::Confocal), kGate, 5, false},
            {"histogram", wall_scan(core::ScanPattern::Single), kHistogram, 4, true, 260},
            {"exhaustive", wall_scan(core::ScanPattern::Exhaustive), kHistogram, 3, false, 260},
            {"image_gate", image(), kImageGate, 4, true, 2080},
            {"image_histogram", image(), kImageHistogram, 3, false}};
}

class RestirOf : public testing::TestWithParam<std::size_t> {};

TEST_P(RestirOf, EveryKindOfReuseAgreesWithPathTracing) {
    const Setting setting = settings()[GetParam()];
    const renderer::Scene scene(geometry(setting.glossy), setting.scan, {});
    const Estimate paths =
        render_often(scene,
                     setting.scan,
                     setting.axis,
                     restir_settings(Estimator::Path, 8 * setting.samples, setting.max_bounces),
                     std::string("Restir.Paths.") + setting.name);
    for (const Case& kind : kCases) {
        SCOPED_TRACE(kind.name);
        renderer::RenderSettings restir =
            restir_settings(Estimator::Restir, setting.samples, setting.max_bounces);
        kind.change(restir);
        expect_same_means(render_often(scene,
                                       setting.scan,
                                       setting.axis,
                                       restir,
                                       std::string("Restir.") + setting.name + kind.name),
                          paths,
                          0.04);
    }
}

INSTANTIATE_TEST_SUITE_P(Measurements,
                         RestirOf,
                         testing::Range<std::size_t>(0, 5),
                         [](const auto& test) { return settings()[test.param].name; });

// Of a long list of points, some that lie apart.
void keep_nine(std::vector<Vec3>& points) {
    if (points.size() < 9) return;
    for (std::size_t i = 0; i < 9; ++i) points[i] = points[(2 * i + 1) * points.size() / 18];
    points.resize(9);
}

const std::vector<std::string> kScenes{
    "letter", "bars", "corner", "glossy", "animal", "curved", "box", "room", "relief", "traffic"};

class RestirOfScenes : public testing::TestWithParam<std::string> {};

TEST_P(RestirOfScenes, AgreesWithPathTracing) {
    const std::string path = NLOS_SOURCE_DIR "/scenes/" + GetParam() + "/scene.json";
    auto description = renderer::read_scene_description(path, {});
    const bool is_image = description.camera.has_value();
    if (is_image) {
        description.camera->resolution = {4, 3};
        description.time_axis = {1.4, 0.4, 8};
    } else {
        description.scan.sensing_points = {3, 3};
        keep_nine(description.scan.sensing_points_m);
        keep_nine(description.scan.sensing_normals);
        description.time_axis = {1.0, 0.15, 12};
    }
    const core::Scan scan = renderer::make_scan(description);
    const renderer::Scene scene = renderer::load_scene(description, scan);
    const int max_bounces = is_image ? 4 : 5;
    const int samples = GetParam() == "box" ? 2048 : is_image ? 1024 : 512;  // its light is rare
    const Estimate paths = render_often(scene,
                                        scan,
                                        description.time_axis,
                                        restir_settings(Estimator::Path, 4 * samples, max_bounces),
                                        "Restir.Scenes.Paths." + GetParam());
    // By turns, one of these for each scene: all of them are tried on every kind of scan above.
    const std::vector<Case> others{
        {"eight_rounds", [](auto& s) { s.restir.rounds = 8; }},
        {"plane", [](auto& s) { s.restir.chart = renderer::Chart::Plane; }},
        {"barycentric", [](auto& s) { s.restir.chart = renderer::Chart::Barycentric; }},
        {"hemisphere", [](auto& s) { s.restir.chart = renderer::Chart::Hemisphere; }},
        {"excluded", [](auto& s) { s.restir.candidates = renderer::Candidates::All; }}};
    const auto scene_number =
        static_cast<std::size_t>(std::ranges::find(kScenes, GetParam()) - kScenes.begin());
    const std::vector<Case> kinds{{"default", [](auto&) {}},
                                  others[scene_number % others.size()],
                                  {"connected", [](auto& s) {
                                       s.restir.candidates = renderer::Candidates::All;
                                       s.exclude = renderer::Exclusion::None;
                                   }}};
    for (const Case& kind : kinds) {
        SCOPED_TRACE(kind.name);
        renderer::RenderSettings restir = restir_settings(Estimator::Restir, samples, max_bounces);
        kind.change(restir);
        expect_same_means(render_often(scene,
                                       scan,
                                       description.time_axis,
                                       restir,
                                       "Restir.Scenes." + GetParam() + kind.name),
                          paths,
                          0.1);
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, RestirOfScenes, testing::ValuesIn(kScenes), [](const auto& test) {
    return test.param;
});

TEST(Restir, WiderGatesShiftedIntoNarrowOnesChangeNoMean) {
    const core::Scan scan = wall_scan(core::ScanPattern::Confocal);
    const renderer::Scene scene(geometry(false), scan, {});
    const Estimate paths = render_often(
        scene, scan, kGate, restir_settings(Estimator::Path, 8192, 4), "Restir.Shrink.Paths");
    for (const double fraction : {0.2, 0.5, 0.9}) {
        renderer::RenderSettings restir = restir_settings(Estimator::Restir, 4096, 4);
        restir.restir.walks = 8;
        restir.restir.shrink_fraction = fraction;
        expect_same_means(render_often(scene, scan, kGate, restir, "Restir.Shrink"), paths, 0.04);
    }
}

TEST(Restir, SameBitsForAnyNumberOfThreads) {
    for (const core::Scan& scan : {wall_scan(core::ScanPattern::Single), image()}) {
        const renderer::Scene scene(geometry(true), scan, {});
        std::vector<std::vector<float>> results;
        for (const int threads : {1, 7}) {
            const core::ThreadLimit limit(threads);
            const auto result = renderer::render(
                scene, scan, kHistogram, restir_settings(Estimator::Restir, 512, 4), {});
            const auto values = result.capture.transient.values();
            results.emplace_back(values.begin(), values.end());
        }
        EXPECT_EQ(results[0], results[1]);
    }
}

TEST(Restir, SettingsSayWhatIsWrong) {
    renderer::RenderSettings settings = restir_settings(Estimator::Restir, 64, 10);
    EXPECT_ERROR_WITH(renderer::validate(settings, "render"), "found 10 for method restir");
    settings = restir_settings(Estimator::Restir, 64, 3);
    settings.by_order = true;
    EXPECT_ERROR_WITH(renderer::validate(settings, "render"), "render.by_order");
    settings = restir_settings(Estimator::Restir, 64, 3);
    settings.restir.walks = 0;
    EXPECT_ERROR_WITH(renderer::validate(settings, "render"), "render.restir.walks: found 0");
    settings = restir_settings(Estimator::Restir, 64, 3);
    settings.restir.shrink_fraction = 1.0;
    EXPECT_ERROR_WITH(renderer::validate(settings, "render"),
                      "render.restir.shrink_fraction: found 1");
}

}  // namespace
}  // namespace restir_test
