// SPDX-License-Identifier: MIT
#include "renderer/estimators.h"

#include "renderer/core/capture/sensor_footprint.h"
#include "renderer/frame_sequence.h"
#include "renderer/render.h"
#include "tests/renderer/doppler_scenes.h"
#include "tests/support/repeated_estimates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

namespace {

using core::Vec3;
using renderer::Estimator;
using test_support::Estimate;

constexpr double kTarget = 0.01;   // relative L2 error, where one is asked for
constexpr double kAllowed = 0.01;  // of the largest number, that repeats need not show

/// Something to render, and how the settings ask for it.
struct Task {
    std::string name;
    renderer::SceneDescription description;
    core::Scan scan;
    std::shared_ptr<const renderer::Scene> scene;
};

Task task_of(const std::string& name, const core::Scan& scan) {
    Task task{name, {}, scan, {}};
    task.description.time_axis = {{1.2, 0.2, 10}};
    task.description.render.samples = 1024;
    task.description.render.restir.shared_walks = 64;
    task.scene = std::make_shared<const renderer::Scene>(doppler_test::moving_scene(scan));
    return task;
}

Task gate_task(renderer::GateShape shape) {
    Task task = task_of("gate " + std::string(core::enum_name(shape)),
                        doppler_test::four_points(core::ScanPattern::Confocal));
    task.description.time_axis = {{1.7, 0.3, 1}};
    task.description.render.gate = shape;
    return task;
}

Task sensor_task() {
    core::SensorSetup setup;
    setup.model.zones = {2, 2};
    setup.model.fov_deg = {30.0, 40.0};
    setup.pose = {Vec3(-0.35, 0.15, 0.8), Vec3(0.3, -0.1, -1.0), Vec3(0.1, 1.0, 0.0)};
    setup.subsamples = 1;
    setup.wall.size_m = {2.0, 2.0};
    Task task = task_of("sensor", core::scan_of_zones(setup));
    task.description.time_axis = {{2.4, 0.3, 10}};
    task.scene = std::make_shared<const renderer::Scene>(
        renderer::SceneGeometry{test_support::facing_surfaces(), {}}, task.scan, setup.wall);
    return task;
}

std::vector<Task> all_tasks() {
    const core::Scan list = doppler_test::four_points(core::ScanPattern::Confocal);
    core::WallScan grid = list.wall();
    grid.sensing.grid = {2, 2};
    grid.illumination.grid = {2, 2};
    std::vector<Task> tasks{
        task_of("list", list),
        task_of("grid", grid),
        task_of("single", doppler_test::four_points(core::ScanPattern::Single)),
        task_of("exhaustive",
                test_support::exhaustive_scan({{-0.3, -0.2, 0}, {0.1, 0.3, 0}},
                                              {{0.2, 0.1, 0}, {-0.1, -0.3, 0}})),
        task_of("image", doppler_test::nine_pixels()),
        sensor_task(),
        gate_task(renderer::GateShape::Box),
        gate_task(renderer::GateShape::Tent),
        gate_task(renderer::GateShape::Gaussian)};
    const auto add = [&](const std::string& name, auto change) {
        Task task = task_of(name, list);
        change(task.description);
        tasks.push_back(std::move(task));
    };
    add("velocities", [](auto& d) { d.velocity_axis = core::VelocityAxis{-16.0, 4.0, 8, false}; });
    add("four bounces", [](auto& d) { d.render.max_bounces = 4; });
    add("narrow gate", [](auto& d) {
        d.time_axis = {{1.72, 0.04, 1}};
        d.render.max_bounces = 4;
    });
    add("narrow axis", [](auto& d) {
        d.time_axis = {{1.72, 0.02, 3}};
        d.render.max_bounces = 4;
    });
    add("by_order", [](auto& d) { d.render.by_order = true; });
    add("variance", [](auto& d) { d.render.variance = true; });
    add("target_error", [](auto& d) { d.render.target_error = kTarget; });
    add("frames", [](auto& d) { d.frames = renderer::FrameSettings{2, 0.05, 0.0}; });
    add("frames to an error", [](auto& d) {
        d.frames = renderer::FrameSettings{2, 0.05, 0.0};
        d.render.target_error = kTarget;
    });
    Task glossy = task_of("narrow lobes", list);
    std::vector<renderer::Object> objects = test_support::facing_surfaces();
    objects[0].material.model = renderer::model_of({.metallic = true});
    objects[0].material.roughness = 0.15;
    glossy.scene = std::make_shared<const renderer::Scene>(
        renderer::SceneGeometry{objects, {}}, list, renderer::RelayWall{});
    tasks.push_back(glossy);
    glossy.name = "narrow lobes in a narrow gate";
    glossy.description.time_axis = {{1.72, 0.04, 1}};
    glossy.description.render.max_bounces = 4;
    tasks.push_back(glossy);
    return tasks;
}

core::Capture render(const Task& task, Estimator method, std::uint64_t seed) {
    renderer::SceneDescription description = task.description;
    description.render.method = method;
    description.render.seed = seed;
    if (renderer::traits_of(method).integrates && !description.render.target_error) {
        description.render.element_tolerance = 1e-3;
    }
    renderer::validate(description.render, "render");
    if (description.frames) {
        return renderer::render_frames(task.scene,
                                       task.scan,
                                       description,
                                       renderer::make_frame_renderer(task.scan, description.render),
                                       {})
            .capture;
    }
    return renderer::render(*task.scene,
                            task.scan,
                            {description.time_axis, description.velocity_axis},
                            description.render,
                            {})
        .capture;
}

std::string name_of(Estimator method) {
    return std::string(core::enum_name(method));
}

/// Expects what was asked for beside the transient.
void expect_extras(const Task& task, const core::Capture& capture) {
    const renderer::RenderSettings& asked = task.description.render;
    EXPECT_EQ(capture.by_order.size(),
              asked.by_order ? static_cast<std::size_t>(asked.max_bounces) : 0U);
    EXPECT_EQ(capture.velocity.has_value(), task.description.velocity_axis.has_value());
    EXPECT_EQ(capture.sequence.has_value(), task.description.frames.has_value());
    if (capture.sequence) {
        EXPECT_EQ(capture.sequence->frames.size(),
                  static_cast<std::size_t>(task.description.frames->count));
    }
}

class Estimators : public testing::TestWithParam<Task> {};

// Each either agrees with path, or says which setting stands against it and who can.
TEST_P(Estimators, RenderTheSameOrNameOneThatCan) {
    const Task& task = GetParam();
    std::vector<std::string> able;
    std::map<std::string, std::string> refusals;
    const auto estimate_of = [&](Estimator method) {
        return test_support::repeat(
            [&](std::uint64_t seed) {
                return test_support::sums_of(render(task, method, seed).transient);
            },
            "Estimators." + task.name + "." + name_of(method));
    };
    const Estimate paths = estimate_of(Estimator::Path);
    for (std::size_t i = 0; i < renderer::kEstimators.size(); ++i) {
        const auto method = static_cast<Estimator>(i);
        SCOPED_TRACE(name_of(method));
        try {
            expect_extras(task, render(task, method, 1));
        } catch (const core::Error& error) {
            refusals[name_of(method)] = error.what();
            continue;
        }
        able.push_back(name_of(method));
        if (method == Estimator::Path) continue;
        Estimate estimate = estimate_of(method);
        const double largest = *std::max_element(paths.mean.begin(), std::prev(paths.mean.end()));
        for (double& error : estimate.squared_error) error += std::pow(kAllowed * largest, 2);
        test_support::expect_same_means(estimate, paths, 0.1);
    }
    for (const auto& [method, text] : refusals) {
        EXPECT_NE(text.find(method), std::string::npos) << text;
        EXPECT_NE(text.find("must be"), std::string::npos) << text;
        for (const std::string& other : able) {
            EXPECT_NE(text.find(other), std::string::npos) << text << ": " << other << " can";
        }
        for (const auto& [other, own_text] : refusals) {
            const std::string allowed = text.substr(text.find("must be"));
            EXPECT_EQ(allowed.find(other), std::string::npos) << text << ": so " << own_text;
        }
    }
}

// Paths by `auto` are made to fit the axis where that costs less.
TEST(Auto, ConnectsByLengthWhereTheAxisIsNarrow) {
    for (Task& task : all_tasks()) {
        if (task.description.render.max_bounces != 4 || task.name == "four bounces") continue;
        for (const bool narrow : {true, false}) {
            task.description.time_axis = {narrow ? core::TimeAxis{1.74, 0.002, 1}
                                                 : core::TimeAxis{1.0, 0.02, 100}};
            const auto result = renderer::render(*task.scene,
                                                 task.scan,
                                                 {task.description.time_axis, {}},
                                                 task.description.render,
                                                 {});
            const auto expected = narrow ? Estimator::Ellipsoidal : Estimator::Path;
            const bool has_lobes = task.name.starts_with("narrow lobes");
            ASSERT_EQ(result.sources.size(), has_lobes ? 3U : 2U);
            EXPECT_EQ(result.sources.front().estimator, Estimator::ThirdBounce) << task.name;
            // Lobes in a narrow gate cost both about as much.
            if (!narrow || !has_lobes) {
                EXPECT_EQ(result.sources.back().estimator, expected) << task.name;
            }
            EXPECT_EQ(result.sources.back().first_order, 4) << task.name;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Tasks, Estimators, testing::ValuesIn(all_tasks()), [](const auto& task) {
    std::string name = task.param.name;
    std::erase_if(name, [](char c) { return !std::isalnum(c); });
    return name;
});

TEST(EstimatorList, NamesEveryEstimatorOnce) {
    for (std::size_t i = 0; i < renderer::kEstimators.size(); ++i) {
        const auto method = static_cast<Estimator>(i);
        EXPECT_EQ(core::enum_name(method), renderer::traits_of(method).name);
        EXPECT_NE(renderer::method_of(method).run, nullptr);
    }
}

}  // namespace
