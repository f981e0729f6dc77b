// SPDX-License-Identifier: MIT
// Every surface model through every estimator, against paths: same means, or refused by name.
#include "tests/support/surface_models.h"

#include "renderer/render.h"
#include "tests/support/error_message.h"
#include "tests/support/repeated_estimates.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <cctype>

namespace {

using core::Vec3;
using renderer::Estimator;
using renderer::Material;

const core::TimeAxis kAxis{0.9, 0.1, 12};

// In the total of what is compared; single bins are tested by their own noise.
constexpr double kSharpness = 0.1;

// Grey and black; of models without a lobe those of the first roughness alone.
std::vector<Material> all_materials(const std::vector<double>& roughnesses) {
    std::vector<Material> all;
    for (const double albedo : {0.7, 0.0}) {
        for (const double roughness : roughnesses) {
            for (const Material& material :
                 test_support::materials_of_all_models(albedo, roughness)) {
                const bool is_first = roughness == roughnesses.front();
                if (is_first || renderer::traits_of(material.model).has_lobe) {
                    all.push_back(material);
                }
            }
        }
    }
    return all;
}

std::string material_name(const testing::TestParamInfo<Material>& info) {
    std::string name;
    for (const char c : info.param.name) {
        if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
    }
    return name + "_albedo" + std::to_string(std::lround(100.0 * info.param.albedo)) +
           "_roughness" + std::to_string(std::lround(100.0 * info.param.roughness));
}

// A panel of the material before the wall points, and a bright one that lights it from the side.
struct PanelScene {
    PanelScene(const Material& material, core::Scan wanted)
        : scan(std::move(wanted)), scene(geometry(material), scan, {}) {}

    static renderer::SceneGeometry geometry(const Material& material) {
        renderer::SceneGeometry geometry;
        geometry.objects = {
            test_support::parallelogram_object(
                {Vec3(-0.3, -0.25, 0.75), Vec3(0.6, 0.03, 0.02), Vec3(-0.05, 0.5, -0.04), 1.0}),
            test_support::parallelogram_object(
                {Vec3(0.35, -0.3, 0.5), Vec3(0.05, 0.6, 0.05), Vec3(0.0, 0.1, 0.3), 0.8})};
        geometry.objects[0].name = "panel";
        geometry.objects[0].material = material;
        return geometry;
    }

    test_support::Estimate estimate(Estimator method, int max_bounces, int samples) const {
        renderer::RenderSettings settings;
        settings.method = method;
        settings.max_bounces = max_bounces;
        settings.samples = samples;
        settings.element_tolerance = 1e-3;
        // What comes straight back is then about as bright as the rest, which paths would meet
        // seldom beside it.
        settings.laser_spot_m2 = 2.0;
        settings.restir.shared_walks = 64;
        return test_support::repeat(
            [&](std::uint64_t seed) {
                settings.seed = seed;
                return test_support::sums_of(
                    renderer::render(scene, scan, kAxis, settings, {}).capture.transient);
            },
            std::string(core::enum_name(method)) + std::to_string(max_bounces));
    }

    core::Scan scan;
    renderer::Scene scene;
};

class SurfaceModels : public testing::TestWithParam<Material> {
 protected:
    const PanelScene confocal{GetParam(),
                              test_support::confocal_scan({{-0.1, 0.05, 0.0}, {0.1, 0.0, 0.0}})};
};

// Their lobes may be too narrow for the third-bounce integrator.
class AnySurfaceModels : public SurfaceModels {};

TEST_P(AnySurfaceModels, ByAutoAndByPathsAreTheSame) {
    test_support::expect_same_means(confocal.estimate(Estimator::Auto, 4, 16'384),
                                    confocal.estimate(Estimator::Path, 4, 16'384),
                                    kSharpness);
}

// At the third bounce, so that nothing else makes up for what is lost there.
TEST_P(AnySurfaceModels, ByThirdBounceAreThoseOfPathsOrRefused) {
    if (!renderer::reflects(GetParam()) || renderer::is_integrable(GetParam())) {
        test_support::expect_same_means(confocal.estimate(Estimator::ThirdBounce, 3, 1),
                                        confocal.estimate(Estimator::Path, 3, 16'384),
                                        kSharpness);
        return;
    }
    const std::string message = test_support::error_message(
        [&] { static_cast<void>(confocal.estimate(Estimator::ThirdBounce, 3, 1)); });
    EXPECT_NE(message.find("panel (" + GetParam().name + ")"), std::string::npos) << message;
}

TEST_P(SurfaceModels, ByEllipsoidalAndByPathsAreTheSame) {
    test_support::expect_same_means(confocal.estimate(Estimator::Ellipsoidal, 4, 8192),
                                    confocal.estimate(Estimator::Path, 4, 16'384),
                                    kSharpness);
}

TEST_P(SurfaceModels, ByRestirAndByPathsAreTheSame) {
    test_support::expect_same_means(confocal.estimate(Estimator::Restir, 4, 1024),
                                    confocal.estimate(Estimator::Path, 4, 16'384),
                                    kSharpness);
}

TEST_P(SurfaceModels, OfCamerasByPathsAndByEllipsoidalAreTheSame) {
    core::PinholeCamera camera;
    camera.position_m = Vec3(0.1, 0.05, 0.0);
    camera.look_at_m = Vec3(0.0, 0.0, 0.75);
    camera.fov_y_deg = 80.0;
    camera.resolution = {2, 2};
    camera.light_m = Vec3(-0.2, 0.1, 0.1);
    const PanelScene image(GetParam(), test_support::image_of(camera));
    test_support::expect_same_means(image.estimate(Estimator::Path, 4, 2048),
                                    image.estimate(Estimator::Ellipsoidal, 4, 4096),
                                    kSharpness);
}

INSTANTIATE_TEST_SUITE_P(All,
                         AnySurfaceModels,
                         testing::ValuesIn(all_materials({0.7, 0.4, 0.16})),
                         material_name);
INSTANTIATE_TEST_SUITE_P(All,
                         SurfaceModels,
                         testing::ValuesIn(all_materials({0.7, 0.4})),
                         material_name);

}  // namespace
