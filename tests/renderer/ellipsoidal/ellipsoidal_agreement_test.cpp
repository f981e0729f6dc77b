// SPDX-License-Identifier: MIT
// The ellipsoidal estimator against the others, bin by bin, on every scene of the repository.
#include "renderer/core/system/parallel.h"
#include "renderer/ellipsoidal_render.h"
#include "renderer/scene/scene_file.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace {

using core::Vec3;
using renderer::Estimator;
using renderer::Exclusion;
using renderer::RenderSettings;

// A scene of the repository with four of its wall points.
struct FewPairs {
    explicit FewPairs(const std::string& name)
        : seed(test_support::seed_of(name)),
          description(renderer::read_scene_description(
              std::string(NLOS_SOURCE_DIR) + "/scenes/" + name + "/scene.json", {})),
          scan(four_points(renderer::make_scan(description).wall())),
          scene(renderer::load_scene(description, scan)),
          axis{0.4, 0.1, 40} {}

    static core::WallScan four_points(core::WallScan scan) {
        core::WallPoints few;
        for (int i = 0; i < 4; ++i) {
            const std::size_t index =
                (2 * static_cast<std::size_t>(i) + 1) * scan.sensing.size() / 8 + 3;
            few.positions.push_back(scan.sensing.positions[index]);
            few.normals.push_back(scan.sensing.normals[index]);
        }
        scan.sensing = few;
        scan.illumination = few;
        return scan;
    }

    RenderSettings settings(Estimator method, int max_bounces, int samples) const {
        RenderSettings settings;
        settings.method = method;
        settings.max_bounces = max_bounces;
        settings.samples = samples;
        settings.variance = true;
        settings.seed = seed + static_cast<std::uint64_t>(samples);
        return settings;
    }
    core::Capture render(const RenderSettings& settings) const {
        return renderer::render(scene, scan, axis, settings, {}).capture;
    }

    std::uint64_t seed;
    renderer::SceneDescription description;
    core::WallScan scan;
    renderer::Scene scene;
    core::TimeAxis axis;
};

double variance_of(const core::Capture& capture, std::size_t i) {
    return capture.variance ? double{capture.variance->values()[i]} : 0.0;
}

// Bins that both know to 15 %, so that their noise is about normal, and the sums of all. `bias` is
// the error allowed to b, relative to its largest bin.
void expect_agreement(const core::Capture& a, const core::Capture& b, double bias = 0.0) {
    constexpr double kLargestRelativeSigma = 0.15;
    const auto values = b.transient.values();
    const double allowed = bias * double{*std::max_element(values.begin(), values.end())};
    std::vector<double> z;
    double sum = 0.0;
    double total = 0.0;
    double sum_variance = 0.0;
    for (std::size_t i = 0; i < a.transient.values().size(); ++i) {
        const double x = double{a.transient.values()[i]};
        const double y = double{b.transient.values()[i]};
        const double variance = variance_of(a, i) + variance_of(b, i);
        sum += x - y;
        total += y;
        sum_variance += variance;
        const double sigma = std::sqrt(variance);
        if (!(sigma > 0.0) || sigma > kLargestRelativeSigma * std::min(x, y)) continue;
        z.push_back(std::max(0.0, std::abs(x - y) - allowed) / sigma);
    }
    ASSERT_GT(z.size(), 3U);
    const double level = test_support::sidak_level(1e-3, z.size() + 1);
    for (const double value : z) EXPECT_GT(test_support::normal_tail(value), level) << value;
    const double z_sum = std::max(0.0, std::abs(sum) - bias * total) / std::sqrt(sum_variance);
    EXPECT_GT(test_support::normal_tail(z_sum), level) << sum / total;
}

class EllipsoidalScenes : public testing::TestWithParam<const char*> {};

TEST_P(EllipsoidalScenes, AgreeWithPathsWithAndWithoutExclusion) {
    const FewPairs few(GetParam());
    const core::Capture paths = few.render(few.settings(Estimator::Path, 5, 80'000));
    for (const Exclusion mode : {Exclusion::Mis, Exclusion::None}) {
        RenderSettings settings = few.settings(Estimator::Ellipsoidal, 5, 60'000);
        settings.exclude = mode;
        expect_agreement(few.render(settings), paths);
    }
}

TEST_P(EllipsoidalScenes, AgreeWithTheIntegratorOnTheThirdBounce) {
    const FewPairs few(GetParam());
    RenderSettings settings = few.settings(Estimator::ThirdBounce, 3, 1);
    settings.target_error = 4e-3;
    const core::Capture integrated = few.render(settings);
    expect_agreement(few.render(few.settings(Estimator::Ellipsoidal, 3, 60'000)), integrated, 4e-3);
}

INSTANTIATE_TEST_SUITE_P(All,
                         EllipsoidalScenes,
                         testing::Values("bars", "corner", "curved", "glossy", "letter"),
                         [](const auto& scene) { return std::string(scene.param); });

// A narrow gate of every shape, where most samples choose their length. Third bounces only: the
// noise of longer paths in one gate is far from normal.
TEST(EllipsoidalTracer, GatesOfAllShapesAgreeWithPaths) {
    FewPairs few("corner");
    few.axis = {2.0, 0.05, 1};
    for (const auto gate :
         {renderer::GateShape::Box, renderer::GateShape::Tent, renderer::GateShape::Gaussian}) {
        RenderSettings path = few.settings(Estimator::Path, 3, 400'000);
        path.gate = gate;
        RenderSettings ellipsoidal = few.settings(Estimator::Ellipsoidal, 3, 50'000);
        ellipsoidal.gate = gate;
        ellipsoidal.exclude = Exclusion::None;
        expect_agreement(few.render(ellipsoidal), few.render(path));
    }
}

// Eight samples come one by one: then, too, every kind of them has its part in the mean.
TEST(EllipsoidalTracer, FewSamplesHaveNoBias) {
    FewPairs few("letter");
    few.scan = renderer::make_scan(few.description).wall();
    const core::Capture integrated = few.render(few.settings(Estimator::ThirdBounce, 3, 1));
    const auto sum_of = [](const core::Capture& capture) {
        const auto values = capture.transient.values();
        return std::accumulate(values.begin(), values.end(), 0.0);
    };
    const double expected = sum_of(integrated);
    for (const int samples : {8, 16}) {
        const core::Capture sampled = few.render(few.settings(Estimator::Ellipsoidal, 3, samples));
        const auto variances = sampled.variance->values();
        const double sigma = std::sqrt(std::accumulate(variances.begin(), variances.end(), 0.0));
        const double off = std::max(0.0, std::abs(sum_of(sampled) - expected) - 2e-3 * expected);
        EXPECT_GT(test_support::normal_tail(off / sigma), 1e-4)
            << sum_of(sampled) / expected << " +- " << sigma / expected;
    }
}

// At the third bounce, dropping surfaces is the same as painting them black; what that takes from
// the signal is what the warning says.
TEST(EllipsoidalTracer, DropLosesExactlyTheSignalOfTheExcludedSurfaces) {
    const FewPairs few("corner");
    RenderSettings settings = few.settings(Estimator::Ellipsoidal, 3, 60'000);
    settings.exclude = Exclusion::Drop;
    std::vector<std::string> warnings;
    core::Progress progress;
    progress.warn = [&](const std::string& text) { warnings.push_back(text); };
    const auto dropped = renderer::render(few.scene, few.scan, few.axis, settings, progress);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("back_wall"), std::string::npos) << warnings[0];
    EXPECT_EQ(dropped.excluded.names.size(), 4U);

    renderer::SceneGeometry painted{few.scene.objects(), {}};
    for (renderer::Object& object : painted.objects) {
        if (object.ellipsoidal_exclude || object.role == renderer::Role::BackWall) {
            object.material.albedo = 0.0;
        }
    }
    const renderer::Scene black(std::move(painted), few.scan, few.description.relay_wall);
    const RenderSettings paths = few.settings(Estimator::Path, 3, 200'000);
    const auto kept = renderer::render(black, few.scan, few.axis, paths, {}).capture;
    expect_agreement(dropped.capture, kept);

    RenderSettings reuse = few.settings(Estimator::Restir, 3, 200'000);
    reuse.exclude = Exclusion::Drop;
    reuse.restir.shared_walks = 64;
    const auto reused = renderer::render(few.scene, few.scan, few.axis, reuse, progress);
    EXPECT_EQ(reused.excluded.names, dropped.excluded.names);
    EXPECT_EQ(warnings.size(), 2U);
    expect_agreement(reused.capture, kept);

    const core::Capture all = few.render(paths);
    double expected = 0.0;
    double variance = 0.0;
    for (std::size_t i = 0; i < all.transient.values().size(); ++i) {
        expected += double{all.transient.values()[i]} - double{kept.transient.values()[i]};
        variance += variance_of(all, i) + variance_of(kept, i);
    }
    const auto measured =
        renderer::measure_dropped_signal({few.scene, few.scan, few.axis, settings, {}}, 4, 32);
    const double sigma = std::hypot(measured.sigma, std::sqrt(variance));
    EXPECT_GT(test_support::normal_tail((measured.lost - expected) / sigma), 1e-4)
        << measured.lost << " +- " << measured.sigma << " expected " << expected;
    EXPECT_LT(measured.sigma, 0.2 * expected);
}

// A plane wall is not lit by the spots on it: nothing is lost, and nothing is measured or said.
TEST(EllipsoidalTracer, DropOfAPlaneWallLosesNothing) {
    const FewPairs few("bars");
    RenderSettings settings = few.settings(Estimator::Ellipsoidal, 5, 400);
    std::vector<std::string> warnings;
    core::Progress progress;
    progress.warn = [&](const std::string& text) { warnings.push_back(text); };
    settings.exclude = Exclusion::Drop;
    const auto dropped = renderer::render(few.scene, few.scan, few.axis, settings, progress);
    EXPECT_EQ(dropped.excluded.names, std::vector<std::string>{"relay_wall"});
    EXPECT_TRUE(warnings.empty()) << warnings[0];
    settings.exclude = Exclusion::Mis;
    const auto kept = few.render(settings);
    EXPECT_TRUE(std::ranges::equal(dropped.capture.transient.values(), kept.transient.values()));

    const renderer::ExcludedObjects wall{{"relay_wall"}, {}};
    EXPECT_FALSE(renderer::can_be_lit(wall, few.scene, few.scan));
    EXPECT_FALSE(renderer::can_be_lit({}, few.scene, few.scan));
    const renderer::ExcludedObjects hidden{{few.scene.objects().front().name}, {}};
    EXPECT_TRUE(renderer::can_be_lit(hidden, few.scene, few.scan));
    core::WallScan tilted = few.scan;
    tilted.illumination.normals[0] = Vec3(0.1, 0.0, 1.0).normalized();
    EXPECT_TRUE(renderer::can_be_lit(wall, few.scene, tilted));
}

// A camera inside an open box with a ball, its light beside it or a spot on the floor.
// Three walls and a ball.
std::vector<renderer::Object> walls_and_ball() {
    std::vector<renderer::Object> objects;
    for (const auto& side :
         {test_support::Parallelogram{Vec3(-1, -1, -1), Vec3(2, 0, 0), Vec3(0, 0, 2), 0.7},
          {Vec3(-1, -1, -1), Vec3(0, 2, 0), Vec3(0, 0, 2), 0.6},
          {Vec3(-1, -1, 1), Vec3(2, 0, 0), Vec3(0, 2, 0), 0.8}}) {
        objects.push_back(test_support::parallelogram_object(side));
    }
    objects.push_back(test_support::sphere_object(Vec3(0.2, -0.4, 0.2), 0.4, 2, 0.9));
    return objects;
}

void expect_images_to_agree(const std::vector<renderer::Object>& objects,
                            const std::vector<core::TimeAxis>& axes,
                            RenderSettings settings) {
    for (const bool spot : {false, true}) {
        core::PinholeCamera camera;
        camera.position_m = Vec3(0.3, 0.2, -2.0);
        camera.look_at_m = Vec3(0, -0.2, 0);
        camera.resolution = {2, 2};
        if (spot) camera.light_spot_m = Vec3(-0.5, -1.0, 0.3);
        const core::Scan scan = core::ImageScan{camera};
        const renderer::Scene scene({objects, {}}, scan, {});
        settings.max_bounces = 4;
        settings.variance = true;
        for (const core::TimeAxis& axis : axes) {
            settings.method = Estimator::Path;
            settings.samples = 150'000;
            const auto paths = renderer::render(scene, scan, axis, settings, {}).capture;
            settings.method = Estimator::Ellipsoidal;
            settings.samples = 20'000;
            ++settings.seed;
            expect_agreement(renderer::render(scene, scan, axis, settings, {}).capture, paths);
        }
    }
}

// Also a gate that no first vertex reaches, so that connections do all the work, and one that
// crosses pixels.
TEST(EllipsoidalTracer, ImagesAgreeWithPaths) {
    RenderSettings settings;
    settings.seed = test_support::seed_of("ImagesAgreeWithPaths");
    expect_images_to_agree(
        walls_and_ball(), {{2.0, 0.25, 28}, {7.0, 0.03, 1}, {5.0, 0.5, 1}}, settings);
}

// Connections that look where a glossy vertex mirrors what it sees.
TEST(EllipsoidalTracer, ImagesOfGlossySurfacesAgreeWithPaths) {
    std::vector<renderer::Object> objects = walls_and_ball();
    for (const auto& [index, roughness] : {std::pair{std::size_t{0}, 0.5}, {std::size_t{3}, 0.3}}) {
        objects[index].material.model = renderer::model_of({.metallic = true});
        objects[index].material.roughness = roughness;
    }
    RenderSettings settings;
    settings.seed = test_support::seed_of("ImagesOfGlossySurfaces");
    expect_images_to_agree(objects, {{2.0, 0.25, 28}, {5.0, 0.5, 1}}, settings);
}

TEST(EllipsoidalTracer, SameBitsForAnyNumberOfThreads) {
    const FewPairs few("glossy");
    const RenderSettings settings = few.settings(Estimator::Ellipsoidal, 5, 400);
    std::vector<std::vector<float>> results;
    for (const int threads : {1, 7}) {
        const core::ThreadLimit limit(threads);
        const core::Capture capture = few.render(settings);
        const auto values = capture.transient.values();
        results.emplace_back(values.begin(), values.end());
    }
    EXPECT_EQ(results[0], results[1]);
}

}  // namespace
