// SPDX-License-Identifier: MIT
#include "apps/dataset/item.h"

#include "nlos/formats/capture_arrays.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/stopwatch.h"
#include "renderer/render.h"
#include "renderer/scene/ground_truth.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace apps {
namespace {

using core::DepthMap;
using core::Vec3;
using nlos::Shape;
using nlos::StoredNumber;

template <class Count>
ItemArray as_counts(const std::string& name,
                    const Shape& shape,
                    StoredNumber number,
                    const std::vector<float>& values,
                    std::size_t& clipped) {
    constexpr auto kMost = static_cast<float>(std::numeric_limits<Count>::max());
    std::vector<Count> counts;
    counts.reserve(values.size());
    for (const float value : values) {
        clipped += value > kMost ? 1 : 0;
        counts.push_back(static_cast<Count>(std::min(value, kMost)));
    }
    return make_item_array<Count>(name, shape, number, counts);
}

void add_halves(const std::string& name,
                const Shape& shape,
                const std::vector<float>& values,
                std::vector<ItemArray>& arrays) {
    constexpr int kExponentOfMost = 15;  // numbers of half precision end at 65504
    const float most = *std::max_element(values.begin(), values.end());
    int exponent = 0;
    std::frexp(most, &exponent);
    const float scale = most > 0.0F ? std::ldexp(1.0F, exponent - kExponentOfMost) : 1.0F;
    std::vector<Eigen::half> halves;
    halves.reserve(values.size());
    for (const float value : values) halves.emplace_back(value / scale);
    arrays.push_back(make_item_array<Eigen::half>(name, shape, StoredNumber::Float16, halves));
    arrays.push_back(make_item_array<float>(
        name + "_scale", {}, StoredNumber::Float32, std::span<const float>(&scale, 1)));
}

/// Adds the histograms of a capture to an item, time slowest as in capture files. Counts beyond the
/// type are clipped and counted. Half precision comes with a factor, a power of two that makes the
/// most of its range: `NAME_scale`, by which values have to be multiplied.
void add_histograms(const std::string& name,
                    const core::Capture& capture,
                    HistogramStorage storage,
                    Item& item) {
    const Shape shape = nlos::histogram_shape(capture);
    std::vector<float> values(capture.transient.values().size());
    nlos::copy_rows(capture.transient, 0, shape[0], values.data());
    switch (storage) {
        case HistogramStorage::Float32:
            item.arrays.push_back(
                make_item_array<float>(name, shape, StoredNumber::Float32, values));
            return;
        case HistogramStorage::Float16:
            return add_halves(name, shape, values, item.arrays);
        case HistogramStorage::Uint8:
            item.arrays.push_back(as_counts<std::uint8_t>(
                name, shape, StoredNumber::UInt8, values, item.clipped_counts));
            return;
        case HistogramStorage::Uint16:
            item.arrays.push_back(as_counts<std::uint16_t>(
                name, shape, StoredNumber::UInt16, values, item.clipped_counts));
            return;
    }
}

/// Adds the processor time of this thread, from its construction on, to a step.
class StepClock {
 public:
    explicit StepClock(double& seconds) : seconds_(seconds) {}
    ~StepClock() { seconds_ += clock_.seconds(); }
    StepClock(const StepClock&) = delete;
    StepClock& operator=(const StepClock&) = delete;

 private:
    double& seconds_;
    core::ThreadStopwatch clock_;
};

/// One number per column of a depth map.
template <class T, class Value>
ItemArray column_array(const DepthMap& map,
                       const char* name,
                       StoredNumber number,
                       const Value& value,
                       const std::optional<nlos::Coordinates>& coordinates = std::nullopt) {
    std::vector<T> values;
    for (std::size_t i = 0; i < map.depth_m.size(); ++i) {
        values.push_back(static_cast<T>(value(i)));
    }
    return make_item_array<T>(name, {map.x_m.size(), map.y_m.size()}, number, values, coordinates);
}

ItemArray normal_array(const DepthMap& map) {
    std::vector<float> values;
    for (const Vec3& normal : map.normals) {
        for (const double coordinate : normal) values.push_back(static_cast<float>(coordinate));
    }
    return make_item_array<float>("normals",
                                  {map.x_m.size(), map.y_m.size(), 3},
                                  StoredNumber::Float32,
                                  values,
                                  nlos::kWorldDirections);
}

ItemArray pose_array(const Recipe& recipe, const ItemPlan& plan) {
    std::size_t most = 1;
    for (const core::Json& count : extremes(recipe.objects.count)) {
        most = std::max(most, static_cast<std::size_t>(std::lround(count.get<double>())));
    }
    std::vector<double> values(16 * most, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < plan.objects.size(); ++i) {
        using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
        Eigen::Map<RowMajor> pose(&values[16 * i]);
        pose = plan.objects[i].world_from_mesh.matrix();
    }
    return make_item_array<double>(
        "poses", {most, 4, 4}, StoredNumber::Float64, values, nlos::kWorldPositions);
}

ItemArray truth_array(Truth truth,
                      const Recipe& recipe,
                      const ItemPlan& plan,
                      const DepthMap& map) {
    const auto floats = [&](const char* name,
                            const std::vector<double>& values,
                            const std::optional<nlos::Coordinates>& coordinates = std::nullopt) {
        return column_array<float>(
            map,
            name,
            StoredNumber::Float32,
            [&](std::size_t i) { return values[i]; },
            coordinates);
    };
    switch (truth) {
        case Truth::Normals:
            return normal_array(map);
        case Truth::Albedo:
            return floats("albedo", map.albedo);
        case Truth::Mask:
            return column_array<std::uint8_t>(map, "mask", StoredNumber::UInt8, [&](std::size_t i) {
                return map.is_foreground(i);
            });
        case Truth::ObjectIds:
            return column_array<std::int16_t>(
                map, "object_ids", StoredNumber::Int16, [&](std::size_t i) {
                    return map.is_foreground(i) ? map.object[i] : -1;
                });
        case Truth::Poses:
            return pose_array(recipe, plan);
        default:
            return floats("depth", map.depth_m, nlos::kWallPositions);
    }
}

bool needs_depth_map(const Recipe& recipe) {
    return std::any_of(recipe.truths.begin(), recipe.truths.end(), [](Truth truth) {
        return truth != Truth::Poses && truth != Truth::CleanHistograms;
    });
}

void add_truths(const Recipe& recipe,
                const ItemPlan& plan,
                const renderer::Scene& scene,
                const core::Capture& clean,
                Item& item) {
    DepthMap map;
    if (needs_depth_map(recipe)) {
        map = renderer::trace_ground_truth(scene, plan.settings.scene);
    }
    for (const Truth truth : recipe.truths) {
        if (truth == Truth::CleanHistograms) {
            add_histograms("clean", clean, HistogramStorage::Float32, item);
        } else {
            item.arrays.push_back(truth_array(truth, recipe, plan, map));
        }
    }
}

/// Darkness cannot be scaled to a number of photons.
core::Capture record(const core::Capture& capture,
                     std::optional<nlos::DetectorSettings> detector,
                     bool is_dark) {
    if (!detector) return capture;
    if (is_dark) {
        detector->photons.reset();
        detector->photons_per_point.reset();
        if (!detector->exposure_s) detector->exposure_s = 1.0;
    }
    return nlos::detect(capture, *detector);
}

}  // namespace

void ItemProfile::add(const ItemProfile& other) {
    meshes += other.meshes;
    render += other.render;
    detector += other.detector;
    truths += other.truths;
    packing += other.packing;
}

std::string fractions_text(ItemProfile profile) {
    const double total = profile.total();
    std::string text;
    for_each_field(profile, [&](const char* name, double seconds, const char*) {
        const double fraction = total > 0.0 ? seconds / total : 0.0;
        text += fmt::format("{}{} {:.1f} %", text.empty() ? "" : ", ", name, 100.0 * fraction);
    });
    return text;
}

Item make_item(const Recipe& recipe,
               MeshLibrary& meshes,
               std::uint64_t number,
               const core::Progress& progress) {
    Item item;
    const ItemPlan plan = [&] {
        const StepClock timed(item.profile.meshes);
        return plan_item(recipe, meshes, number);
    }();
    item.parameters = plan.parameters;
    item.broken_meshes = plan.broken;
    const renderer::SceneDescription& description = plan.settings.scene;
    const core::Scan scan = renderer::make_scan(description);
    const auto [scene, result] = [&] {
        const StepClock timed(item.profile.render);
        auto set_up = std::make_unique<renderer::Scene>(
            renderer::make_scene(geometry_of(plan), description, scan));
        auto rendered = renderer::render(
            *set_up, scan, {description.time_axis, std::nullopt}, description.render, progress);
        return std::pair(std::move(set_up), std::move(rendered));
    }();
    item.interrupted = result.interrupted;
    if (item.interrupted) return item;
    item.is_dark = result.capture.transient.is_dark();
    if (result.estimated_error && !item.is_dark) {
        item.parameters["estimated_error"] = *result.estimated_error;
    }
    if (result.left_out) {
        item.parameters[core::kLeftOutOrdersKey] = core::write_value(*result.left_out);
    }
    if (result.element_tolerance) {
        item.parameters["element_tolerance"] = *result.element_tolerance;
    }
    {
        const StepClock timed(item.profile.detector);
        add_histograms("H",
                       record(result.capture, plan.settings.detector, item.is_dark),
                       recipe.storage.histograms,
                       item);
    }
    const StepClock timed(item.profile.truths);
    add_truths(recipe, plan, *scene, result.capture, item);
    return item;
}

}  // namespace apps
