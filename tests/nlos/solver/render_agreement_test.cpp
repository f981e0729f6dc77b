// SPDX-License-Identifier: MIT
// The solver's operators against the renderer's third bounce of a small square parallel to the
// wall. Diffuse operators leave cosines out, which are put to them here as those of the square's
// centre.
#include "nlos/preparation/wall_frame.h"
#include "nlos/solver/cone_convolution.h"
#include "nlos/solver/confocal_problem.h"
#include "nlos/solver/pair_operator.h"
#include "renderer/render.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <numeric>

namespace nlos {
namespace {

using core::Vec3;

constexpr double kWallAlbedo = 0.8;
constexpr double kSquareAlbedo = 0.5;
const core::GaussianResponse kRenderedResponse{0.04};
const Vec3 kCenter(0.1, -0.06, 0.7);

core::Capture render_square(const core::WallScan& scan, double side_m, const core::TimeAxis& axis) {
    renderer::SceneGeometry geometry;
    geometry.objects = {
        test_support::parallelogram_object({kCenter - 0.5 * side_m * Vec3(1.0, 1.0, 0.0),
                                            side_m * Vec3::UnitX(),
                                            side_m * Vec3::UnitY(),
                                            kSquareAlbedo})};
    renderer::RelayWall wall;
    wall.albedo = kWallAlbedo;
    const renderer::Scene scene(std::move(geometry), scan, wall);
    renderer::RenderSettings settings;
    settings.method = renderer::Estimator::ThirdBounce;
    settings.target_error = 0.001;
    core::Capture capture;
    capture.scan = scan;
    capture.time_axis = axis;
    capture.transient = core::apply_filter(
        core::sample_response(kRenderedResponse, capture.time_axis.bin_width_m),
        renderer::render(scene, capture.scan, capture.time_axis, settings, {}).capture.transient);
    return capture;
}

/// What the operators leave out of the light of a pair, times the albedos and 1 / pi^3.
double factor_of_pair(Falloff falloff, const core::WallScan& scan, std::size_t pair) {
    const double constants = kWallAlbedo * kWallAlbedo * kSquareAlbedo / std::pow(core::kPi, 3);
    if (falloff == Falloff::Facing) return constants;
    const Vec3 l = scan.illumination.positions[scan.illumination_index(pair)];
    const Vec3 s = scan.sensing.positions[scan.sensing_index(pair)];
    const double cosines =
        std::pow(kCenter.z() / (kCenter - l).norm() * kCenter.z() / (kCenter - s).norm(), 2);
    return cosines * constants;
}

double relative_error(const std::vector<double>& values, const std::vector<double>& truth) {
    double squares = 0.0;
    double norm = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        squares += std::pow(values[i] - truth[i], 2);
        norm += truth[i] * truth[i];
    }
    return std::sqrt(squares / norm);
}

MethodInput input_of(const core::Capture& capture,
                     const WallFrame& wall,
                     const VolumeAxes& axes,
                     const core::Progress& progress) {
    MethodInput input{capture.scan.wall(),
                      capture.time_axis,
                      capture.transient,
                      wall,
                      axes,
                      {0.6, 0.8},
                      progress};
    input.measurement.response =
        core::sample_response(kRenderedResponse, capture.time_axis.bin_width_m);
    return input;
}

/// The operator's light of the square, absolute, over the renderer's.
double pair_operator_error(Falloff falloff, const core::WallScan& scan) {
    const double side = 0.06;
    const core::Capture capture = render_square(scan, side, {1.2, 0.004, 256});
    const WallFrame wall = derive_wall_frame(capture.scan.wall());
    const core::Progress progress;
    const VolumeAxes axes{{0.0}, {0.0}, {0.7}, wall.world_from_wall};
    PairOperator light(input_of(capture, wall, axes, progress), falloff, 0.0);
    constexpr int kSteps = 30;
    std::vector<Eigen::Vector3f> voxels;
    for (int i = 0; i < kSteps * kSteps; ++i) {
        const Vec3 position(
            (i / kSteps + 0.5) / kSteps - 0.5, (i % kSteps + 0.5) / kSteps - 0.5, 0.0);
        const Vec3 in_wall_frame =
            wall.world_from_wall.inverse(Eigen::Isometry) * Vec3(kCenter + side * position);
        voxels.push_back(in_wall_frame.cast<float>());
    }
    light.set_voxels(voxels);
    std::vector<std::size_t> pairs(capture.scan.num_pairs());
    std::iota(pairs.begin(), pairs.end(), std::size_t{0});
    std::vector<float> histograms(pairs.size() * 256);
    const auto area = static_cast<float>(side * side / (kSteps * kSteps));
    light.forward(std::vector<float>(voxels.size(), area), pairs, histograms);
    std::vector<double> values;
    for (std::size_t i = 0; i < histograms.size(); ++i) {
        values.push_back(static_cast<double>(histograms[i]) *
                         factor_of_pair(falloff, capture.scan.wall(), i / 256));
    }
    const auto rendered = capture.transient.values();
    return relative_error(values, {rendered.begin(), rendered.end()});
}

// What is left are the square's own differences of cosines, and that the renderer's bins hold light
// evenly where the operator shares it between bin centres.
TEST(OperatorsAgainstTheRenderer, PairOperatorMakesTheSameLight) {
    const std::vector<Vec3> points{
        {-0.4, 0.3, 0.0}, {-0.1, 0.0, 0.0}, {0.2, -0.3, 0.0}, {0.4, 0.1, 0.0}};
    for (const core::WallScan& scan : {test_support::confocal_scan(points),
                                       test_support::single_scan({0.0, 0.2, 0.0}, points),
                                       test_support::exhaustive_scan(points, points)}) {
        const double diffuse = pair_operator_error(Falloff::Diffuse, scan);
        const double facing = pair_operator_error(Falloff::Facing, scan);
        EXPECT_LT(diffuse, 0.03);
        EXPECT_LT(facing, diffuse);
    }
}

/// The operators' light of a square over the renderer's, up to a common factor, which the
/// convolution's unit norm leaves open. Columns 0.04 m apart show three of them as 0.12 m.
double cone_operators_error(Falloff falloff) {
    core::WallScan scan;
    scan.pattern = core::ScanPattern::Confocal;
    scan.sensing = nlos_test::wall_grid({24, 24}, {0.04, 0.04});
    scan.illumination = scan.sensing;
    const core::Capture capture = render_square(scan, 0.12, {1.2, 0.016, 64});
    const WallFrame wall = derive_wall_frame(capture.scan.wall());
    const core::Progress progress;
    const VolumeAxes axes{
        std::vector<double>(24), std::vector<double>(24), {0.7}, wall.world_from_wall};
    const MethodInput input = input_of(capture, wall, axes, progress);
    ReconstructSettings settings;
    settings.falloff = falloff;
    const ConfocalProblem problem = make_confocal_problem(input, settings, false);
    const Cone& cone = problem.cone;
    ConeConvolution convolution(cone, *wall.grid, 0.0, 1.0, 1.0);
    ConeField albedo(convolution.num_values(), 0.0F);
    const double bin = (kCenter.z() * kCenter.z() - cone.v_edges.front()) / cone.v_width() - 0.5;
    const auto before = static_cast<std::size_t>(bin);
    const auto late = static_cast<float>(bin - std::floor(bin));
    for (std::size_t column = 0; column < cone.num_columns(); ++column) {
        const Vec3& point = scan.sensing.positions[wall.grid->point(column / 24, column % 24)];
        if (std::abs(point.x() - kCenter.x()) > 0.06 || std::abs(point.y() - kCenter.y()) > 0.06) {
            continue;
        }
        float* row = albedo.data() + column / 24 * cone.num_v() * 24 + column % 24;
        row[before * 24] = 1.0F - late;
        row[(before + 1) * 24] = late;
    }
    ConeField light(albedo.size());
    convolution.forward(albedo, light);
    std::vector<double> values;
    std::vector<double> rendered;
    const auto num_bins = static_cast<std::size_t>(problem.axis.num_bins);
    std::vector<float> time(num_bins * 24);
    for (std::size_t ix = 0; ix < 24; ++ix) {
        problem.time.apply(light.data() + ix * cone.num_v() * 24, time.data(), 24);
        for (std::size_t i = 0; i < time.size(); ++i) {
            const std::size_t pair = wall.grid->point(ix, i % 24);
            values.push_back(static_cast<double>(time[i]) * factor_of_pair(falloff, scan, pair));
            rendered.push_back(static_cast<double>(problem.values[ix * time.size() + i]));
        }
    }
    const double scale = std::inner_product(values.begin(), values.end(), rendered.begin(), 0.0) /
                         std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
    for (double& value : values) value *= scale;
    return relative_error(values, rendered);
}

TEST(OperatorsAgainstTheRenderer, ConeConvolutionAndFalloffMakeTheSameLight) {
    EXPECT_LT(cone_operators_error(Falloff::Diffuse), 0.1);
    EXPECT_LT(cone_operators_error(Falloff::Facing), 0.1);
}

}  // namespace
}  // namespace nlos
