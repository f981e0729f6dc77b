// SPDX-License-Identifier: MIT
// The fits of README and demo: true errors against reported ones.
#include "apps/commands/fit_job.h"
#include "apps/commands/render_job.h"
#include "nlos/detector/detector.h"
#include "nlos/formats/capture_file.h"
#include "renderer/gltf/gltf.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>

namespace apps {
namespace {

const std::string kLetter = NLOS_SOURCE_DIR "/scenes/letter";

struct TrueLetter {
    core::Vec3 position_m;
    double albedo;
};

TrueLetter true_letter() {
    for (const renderer::Object& object : renderer::load_gltf(kLetter + "/scene.glb").objects) {
        if (object.name != "letter") continue;
        return {object.world_from_node.translation(), object.material.albedo};
    }
    throw core::Error("scene.glb", "has no letter", "must have one");
}

// Reported errors cover true ones, and do not cover everything.
void expect_errors_to_hold(const std::string& capture_path,
                           const std::vector<std::string>& overrides) {
    constexpr double kMostSigmas = 4.0;  // of seven parameters in five fits: 0.2 % by chance
    const test_support::TemporaryFolder folder;
    const calib::FitResult fit =
        fit_to_file({capture_path, kLetter + "/model.json", overrides, folder.file("fit.json")});
    ASSERT_TRUE(fit.converged);
    ASSERT_EQ(fit.objects.size(), 1U);
    const calib::FittedObject& found = fit.objects[0];
    const TrueLetter truth = true_letter();
    for (int axis = 0; axis < 3; ++axis) {
        const double sigma = found.position_sigma_m[axis];
        EXPECT_LT(std::abs(found.position_m[axis] - truth.position_m[axis]), kMostSigmas * sigma)
            << "axis " << axis << ": " << found.position_m[axis] << " +- " << sigma;
        EXPECT_LT(sigma, 0.02) << "axis " << axis;
    }
    const auto [albedo, sigma] = found.numbers["albedo"];
    EXPECT_LT(std::abs(albedo - truth.albedo), kMostSigmas * sigma) << albedo << " +- " << sigma;
    EXPECT_LT(sigma, 0.2);
}

TEST(DocumentedFits, OfTheSmallCaptureKnowTheirErrors) {
    expect_errors_to_hold(NLOS_SOURCE_DIR "/data/letter.h5", {});
}

TEST(DocumentedFits, OfNoiseFreeRadianceKnowTheirErrors) {
    const test_support::TemporaryFolder folder;
    for (const char* target_error : {"0.002", "0.05"}) {
        const std::string capture = folder.file("capture.h5");
        render_to_file(
            kLetter + "/scene.json",
            {"scan.sensing_points=[16,16]", std::string("render.target_error=") + target_error},
            capture);
        expect_errors_to_hold(capture, {});
    }
}

TEST(DocumentedFits, OfPathsWithTheirNoiseKnowTheirErrors) {
    const test_support::TemporaryFolder folder;
    render_to_file(kLetter + "/scene.json",
                   {"scan.sensing_points=[16,16]", "render.method=path", "render.samples=1024"},
                   folder.file("capture.h5"));
    expect_errors_to_hold(folder.file("capture.h5"), {});
}

TEST(DocumentedFits, OfCountsKnowTheirErrors) {
    const test_support::TemporaryFolder folder;
    nlos::DetectorSettings detector;
    detector.photons = 1e5;
    detector.response.jitter_fwhm_ps = 200.0;
    const auto render = render_to_file(
        kLetter + "/scene.json", {"scan.sensing_points=[16,16]"}, folder.file("capture.h5"));
    nlos::write_capture(folder.file("counts.h5"), nlos::detect(render.capture, detector));
    expect_errors_to_hold(folder.file("counts.h5"), {"response=capture"});
}

}  // namespace
}  // namespace apps
