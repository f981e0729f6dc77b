// SPDX-License-Identifier: MIT
#include "nlos/formats/exr_attributes.h"

#include "nlos/formats/capture_format.h"
#include "renderer/core/error.h"
#include "renderer/core/settings/json_file.h"

#include <algorithm>
#include <cmath>

namespace nlos {

using core::Capture;
using core::Vec3;

namespace {

constexpr const char* kUnit = "nlosUnit";
constexpr const char* kScale = "nlosCountsPerRadiance";
constexpr const char* kStart = "nlosOplStartM";
constexpr const char* kBinWidth = "nlosBinWidthM";

bool is_whole_number(float value) {
    return value >= 0.0F && value <= 1e7F && value == std::trunc(value);
}

}  // namespace

void put_measurement(const char* format, const Capture& capture, ExrTable& table) {
    table.texts[kExrFormatKey] = format;
    table.texts[kUnit] = enum_name(capture.unit);
    table.texts["nlosSceneInfo"] =
        capture.scene_info->dump(-1, ' ', false, core::Json::error_handler_t::replace);
    table.numbers[kStart] = capture.time_axis.opl_start_m;
    table.numbers[kBinWidth] = capture.time_axis.bin_width_m;
    if (capture.counts_per_radiance) table.numbers[kScale] = *capture.counts_per_radiance;
}

void ExrAttributes::read_measurement(int num_bins, Capture& capture) const {
    capture.time_axis = {number(kStart), number(kBinWidth), num_bins};
    capture.unit = choice<core::TransientUnit>(kUnit);
    if (table_.numbers.contains(kScale)) capture.counts_per_radiance = number(kScale);
}

std::vector<Vec3> ExrAttributes::vectors(const std::string& name) const {
    constexpr const char* kWanted = "3 floats per point";
    const std::vector<float>& values = find(table_.lists, name, kWanted);
    if (values.empty() || values.size() % 3 != 0) throw_missing(name, kWanted);
    return to_points(values);
}

Vec3 ExrAttributes::vector(const std::string& name) const {
    const std::vector<Vec3> found = vectors(name);
    if (found.size() != 1) throw_missing(name, "3 floats");
    return found[0];
}

core::WallPoints ExrAttributes::points(const std::string& device) const {
    core::WallPoints points;
    points.positions = vectors("nlos" + device + "PointsM");
    points.normals = vectors("nlos" + device + "Normals");
    for (Vec3& normal : points.normals) {
        if (normal.norm() > 0.0) normal.normalize();  // floats leave them slightly off
    }
    const auto grid = table_.lists.find("nlos" + device + "Grid");
    if (grid == table_.lists.end()) return points;
    const auto is_count = [](float value) { return value >= 1.0F && is_whole_number(value); };
    if (grid->second.size() != 2 || !std::ranges::all_of(grid->second, is_count)) {
        throw_missing(grid->first, "2 whole numbers");
    }
    points.grid = {static_cast<std::size_t>(grid->second[0]),
                   static_cast<std::size_t>(grid->second[1])};
    return points;
}

core::ObservedBins ExrAttributes::observed_bins(std::size_t num_pairs) const {
    const auto bins = table_.lists.find(kExrObservedBins);
    if (bins == table_.lists.end()) return std::nullopt;
    if (bins->second.size() != 2 * num_pairs ||
        !std::ranges::all_of(bins->second, is_whole_number)) {
        throw_missing(kExrObservedBins, "2 whole numbers per pair");
    }
    std::vector<core::BinRange> observed;
    for (std::size_t i = 0; i < bins->second.size(); i += 2) {
        observed.push_back(
            {static_cast<int>(bins->second[i]), static_cast<int>(bins->second[i + 1])});
    }
    return observed;
}

void ExrAttributes::throw_missing(const std::string& name, const std::string& wanted) const {
    throw core::Error(path_ + ": " + name, "is missing or of another kind", "must be " + wanted);
}

}  // namespace nlos
