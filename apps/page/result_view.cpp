// SPDX-License-Identifier: MIT
#include "apps/page/result_view.h"

#include "nlos/pictures/image_layout.h"
#include "nlos/pictures/map_ranges.h"
#include "nlos/preparation/wall_frame.h"
#include "renderer/core/settings/json_file.h"

#include <fmt/core.h>

namespace apps {
namespace {

using Range = std::array<double, 2>;

VolumeView volume_view(const nlos::Volume& volume) {
    VolumeView view;
    const std::array axes{&volume.axes.x_m, &volume.axes.y_m, &volume.axes.z_m};
    for (std::size_t a = 0; a < axes.size(); ++a) {
        view.size[a] = axes[a]->size();
        if (!axes[a]->empty()) view.centres_m[a] = {axes[a]->front(), axes[a]->back()};
    }
    for (const float value : volume.values) view.highest = std::max(view.highest, double{value});
    const LinearCoding coding{0.0, view.highest};
    view.codes.reserve(volume.values.size());
    for (const float value : volume.values) {
        view.codes.push_back(coding.encode<std::uint8_t>(double{value}));
    }
    return view;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
    for (double& value : values) value *= factor;
    return values;
}

std::vector<double> errors_mm(const ResultView& result) {
    std::vector<double> errors;
    for (std::size_t i = 0; result.truth && i < result.depth.depth_m.size(); ++i) {
        errors.push_back(1e3 * (result.depth.depth_m[i] - result.truth->depth_m[i]));
    }
    return errors;
}

/// What is known of every column of the wall, and how that becomes colours.
struct ColumnQuantity {
    const char* name;
    const char* unit;
    const char* colours;
    Range range;
    std::vector<double> values;  ///< stored [x][y]; empty: not known
    bool is_of_points = true;    ///< shown of the surface's points, too
};

std::vector<ColumnQuantity> quantities_of(const ResultView& result, const MapScales& scales) {
    const Range error_range{-scales.error_mm, scales.error_mm};
    const Range sigma_range{0.0, scales.sigma_mm};
    const Range fractions{0.0, 1.0};
    const std::vector<double> sigma_mm = scaled(result.sigma_m, 1e3);
    const std::vector<double> brightest(result.projection.begin(), result.projection.end());
    return {{"Depth", "m", "depth", scales.depth_m, result.depth.depth_m},
            {"Depth error", "mm", "diverging", error_range, errors_mm(result)},
            {"Maximum projection", "", "heat", fractions, brightest, false},
            {"Standard deviation of depth", "mm", "depth", sigma_range, sigma_mm},
            {"Probability of a surface", "", "share", fractions, result.probability, false}};
}

/// values   of the quantity, at columns or at points
core::Json quantity_json(const ColumnQuantity& quantity,
                         const std::vector<double>& values,
                         PageArrays& arrays) {
    return {{"name", quantity.name},
            {"unit", quantity.unit},
            {"colours", quantity.colours},
            {"range", quantity.range},
            {"values", coding_of(values).add<std::uint16_t>(arrays, values)}};
}

/// Whether the wall's frame is that of the page.
bool is_of_page(const ResultView& result, const core::Transform& frame_from_world) {
    return nlos::is_world_frame(frame_from_world * result.depth.world_from_wall);
}

/// Name, detail and maps.
core::Json maps_json(const ResultView& result,
                     const std::vector<ColumnQuantity>& quantities,
                     const core::Transform& frame_from_world,
                     PageArrays& arrays) {
    const core::DepthMap& columns = result.depth;
    core::Json maps = core::Json::array();
    for (const ColumnQuantity& quantity : quantities) {
        if (quantity.values.empty()) continue;
        maps.push_back(quantity_json(quantity, quantity.values, arrays));
        maps.back().update({{"size", {columns.x_m.size(), columns.y_m.size()}},
                            {"x_m", nlos::cell_edges(columns.x_m)},
                            {"y_m", nlos::cell_edges(columns.y_m)}});
    }
    const char* wall = is_of_page(result, frame_from_world) ? "" : ", of another wall";
    return {{"name", result.name}, {"detail", result.detail + wall}, {"maps", std::move(maps)}};
}

/// The foreground of a depth map with what is known of each point.
core::Json points_json(const core::DepthMap& depth,
                       const std::vector<ColumnQuantity>& quantities,
                       const core::Transform& frame_from_world,
                       PageArrays& arrays) {
    std::vector<core::Vec3> positions;
    std::vector<std::size_t> columns;
    for (std::size_t ix = 0; ix < depth.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < depth.y_m.size(); ++iy) {
            if (!depth.is_foreground(depth.index(ix, iy))) continue;
            columns.push_back(depth.index(ix, iy));
            positions.push_back(depth.point_world(ix, iy));
        }
    }
    if (positions.empty()) return nullptr;
    core::Json fields = core::Json::array();
    for (const ColumnQuantity& quantity : quantities) {
        if (quantity.values.empty() || !quantity.is_of_points) continue;
        std::vector<double> values;
        for (const std::size_t column : columns) values.push_back(quantity.values[column]);
        fields.push_back(quantity_json(quantity, values, arrays));
    }
    return {{"positions", add_points(arrays, positions, frame_from_world)},
            {"fields", std::move(fields)}};
}

core::Json volume_json(VolumeView volume, int halvings, PageArrays& arrays) {
    halvings = std::min(halvings, halvings_of(volume));
    for (int i = 0; i < halvings; ++i) volume = halved(volume);
    core::Json values = arrays.add(volume.codes);
    values.update({{"coding", "linear"}, {"low", 0.0}, {"high", volume.highest}});
    std::string reduced;
    const auto& [x, y, z] = volume.merged;
    if (x * y * z > 1) {
        reduced = fmt::format("{} × {} × {} voxels are one, to keep the page small", x, y, z);
    }
    return {{"size", volume.size},
            {"x_m", volume.centres_m[0]},
            {"y_m", volume.centres_m[1]},
            {"z_m", volume.centres_m[2]},
            {"values", std::move(values)},
            {"reduced", reduced}};
}

}  // namespace

ResultView result_view(const nlos::Reconstruction& result, const std::string& file) {
    ResultView view;
    view.name = result.method;
    const nlos::VolumeAxes& axes = result.volume.axes;
    view.detail = fmt::format(
        "{} × {} × {} voxels, {}", axes.x_m.size(), axes.y_m.size(), axes.z_m.size(), file);
    view.depth = result.depth;
    const std::size_t num_columns = result.depth.depth_m.size();
    if (result.surface_probability.size() == num_columns) {
        view.probability = result.surface_probability;
    }
    if (result.depth_sigma_m.size() == num_columns) view.sigma_m = result.depth_sigma_m;
    view.volume = volume_view(result.volume);
    if (view.volume.highest > 0.0) {
        view.projection = nlos::max_projection(result.volume);
        for (float& value : view.projection) value /= static_cast<float>(view.volume.highest);
    }
    return view;
}

VolumeView halved(const VolumeView& volume) {
    const auto axis = static_cast<std::size_t>(
        std::max_element(volume.size.begin(), volume.size.end()) - volume.size.begin());
    if (volume.size[axis] < 2) return volume;
    VolumeView half = volume;
    half.size[axis] = (volume.size[axis] + 1) / 2;
    half.merged[axis] *= 2;
    const auto& [first, last] = volume.centres_m[axis];
    const double pitch = (last - first) / static_cast<double>(volume.size[axis] - 1);
    half.centres_m[axis][0] = first + 0.5 * pitch;
    half.centres_m[axis][1] =
        half.centres_m[axis][0] + 2.0 * pitch * static_cast<double>(half.size[axis] - 1);
    half.codes.assign(half.size[0] * half.size[1] * half.size[2], 0);
    std::array<std::size_t, 3> voxel{};
    std::size_t source = 0;
    for (voxel[0] = 0; voxel[0] < volume.size[0]; ++voxel[0]) {
        for (voxel[1] = 0; voxel[1] < volume.size[1]; ++voxel[1]) {
            for (voxel[2] = 0; voxel[2] < volume.size[2]; ++voxel[2]) {
                std::array<std::size_t, 3> target = voxel;
                target[axis] /= 2;
                std::uint8_t& code =
                    half.codes[(target[0] * half.size[1] + target[1]) * half.size[2] + target[2]];
                code = std::max(code, volume.codes[source++]);
            }
        }
    }
    return half;
}

int halvings_of(std::size_t count) {
    constexpr std::size_t kFew = 16;
    int halvings = 0;
    for (; count > kFew; count = (count + 1) / 2) ++halvings;
    return halvings;
}

int halvings_of(const VolumeView& volume) {
    const auto& [x, y, z] = volume.size;
    return halvings_of(x) + halvings_of(y) + halvings_of(z);
}

MapScales map_scales(const std::vector<ResultView>& results,
                     const std::optional<core::DepthMap>& truth) {
    std::vector<double> depths;
    std::vector<double> sigmas;
    if (truth) depths = truth->depth_m;
    const bool truth_is_dark = !nlos::depth_range_m(depths).has_value();
    for (const ResultView& result : results) {
        if (truth_is_dark) {
            depths.insert(depths.end(), result.depth.depth_m.begin(), result.depth.depth_m.end());
        }
        sigmas.insert(sigmas.end(), result.sigma_m.begin(), result.sigma_m.end());
    }
    MapScales scales;
    if (const auto range = nlos::depth_range_m(depths)) scales.depth_m = *range;
    if (const auto limit = nlos::error_limit_m(depths)) scales.error_mm = 1e3 * *limit;
    if (const auto limit = nlos::sigma_limit_m(sigmas)) scales.sigma_mm = 1e3 * *limit;
    return scales;
}

core::Json result_json(const ResultView& result,
                       const MapScales& scales,
                       const core::Transform& frame_from_world,
                       int halvings,
                       PageArrays& arrays) {
    const std::vector<ColumnQuantity> quantities = quantities_of(result, scales);
    core::Json json = maps_json(result, quantities, frame_from_world, arrays);
    json["is_truth"] = false;
    json["points"] = points_json(result.depth, quantities, frame_from_world, arrays);
    const bool has_volume = is_of_page(result, frame_from_world) && !result.volume.codes.empty();
    json["volume"] = has_volume ? volume_json(result.volume, halvings, arrays) : core::Json();
    return json;
}

core::Json truth_json(const core::DepthMap& truth,
                      const std::string& scene,
                      const MapScales& scales,
                      const core::Transform& frame_from_world,
                      PageArrays& arrays) {
    ResultView view;
    view.name = "Truth";
    view.detail = scene;
    view.depth = truth;
    core::Json json = maps_json(view, quantities_of(view, scales), frame_from_world, arrays);
    json.update({{"is_truth", true}, {"points", nullptr}, {"volume", nullptr}});  // a mesh is shown
    return json;
}

}  // namespace apps
