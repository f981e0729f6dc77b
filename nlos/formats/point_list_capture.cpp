// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_format.h"
#include "nlos/formats/mat_array.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

namespace nlos {
namespace {

using core::Capture;
using core::Error;
namespace fs = std::filesystem;

/// Where a point sits on the index grid: (horizontal, vertical).
using GridIndex = std::array<int, 2>;

/// The file of a variable: the folder holds one .mat per variable, named after it.
std::string file_of(const std::string& path, const std::string& variable) {
    const fs::path folder = fs::is_directory(path) ? fs::path(path) : fs::path(path).parent_path();
    return (folder / (variable + ".mat")).string();
}

bool recognise_point_list(const std::string& path) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) return fs::exists(file_of(path, "sub_Sig"), ignored);
    return container_of(path) == "matlab-v5" && ArrayReader(path).has_object("sub_Sig");
}

/// Grid indices of the illumination (C_i) or detection (C_d) point of every histogram.
std::vector<GridIndex> read_indices(const std::string& path,
                                    const std::string& variable,
                                    std::size_t count) {
    const std::string file = file_of(path, variable);
    const auto columns = read_mat_array<double>(file, variable);
    if (columns.shape != Shape{count, 3}) {
        throw Error(file + ": " + variable,
                    "has shape " + shape_text(columns.shape),
                    "must have shape " + shape_text({count, 3}) + " as sub_Sig has rows");
    }
    std::vector<GridIndex> indices(count);
    for (std::size_t i = 0; i < count; ++i) {
        if (columns.values[i] != 0.0) {
            throw Error(file + ": " + variable,
                        fmt::format("row {} has depth index {}", i, columns.values[i]),
                        "must be 0 (no normals are known for a wall that is not flat)");
        }
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const double index = columns.values[i + count * (axis + 1)];
            if (!(std::abs(index) < 1e6) || index != std::trunc(index)) {
                throw Error(file + ": " + variable,
                            fmt::format("row {} has index {}", i, index),
                            "must be whole numbers");
            }
            indices[i][axis] = static_cast<int>(index);
        }
    }
    return indices;
}

/// The different points of a list, x slowest, as a grid when they fill one.
struct PointSet {
    core::WallPoints points;
    std::map<GridIndex, std::size_t> number;
};

PointSet distinct_points(const std::vector<GridIndex>& indices, double pitch_m) {
    PointSet set;
    std::set<int> columns;
    std::set<int> rows;
    for (const GridIndex& index : indices) {
        set.number[index] = 0;
        columns.insert(index[0]);
        rows.insert(index[1]);
    }
    for (auto& [index, number] : set.number) {  // in order: horizontal first, then vertical
        number = set.points.size();
        set.points.positions.emplace_back(index[0] * pitch_m, index[1] * pitch_m, 0.0);
    }
    set.points.normals.assign(set.points.size(), core::Vec3::UnitZ());
    if (columns.size() * rows.size() == set.points.size()) {
        set.points.grid = {columns.size(), rows.size()};
    }
    return set;
}

double required(const std::optional<double>& value, const std::string& path, const char* key) {
    if (!value) {
        throw Error(path,
                    fmt::format("point lists do not hold their {}", key),
                    fmt::format("must be given as --set capture.{}=... [m]", key));
    }
    return *value;
}

/// Which pair of the scan each histogram of the file is; every pair must be there once.
std::vector<std::size_t> pair_numbers(const std::string& path,
                                      const std::vector<std::size_t>& illumination,
                                      const std::vector<std::size_t>& sensing,
                                      const core::Scan& scan) {
    std::vector<std::size_t> pairs(illumination.size());
    std::vector<bool> seen(scan.num_pairs(), false);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const bool confocal = scan.pattern == core::ScanPattern::Confocal;
        pairs[i] = (confocal ? 0 : illumination[i] * scan.sensing.size()) + sensing[i];
        if (seen[pairs[i]]) {
            throw Error(path,
                        fmt::format("row {} repeats an earlier pair of points", i),
                        "must have every pair once");
        }
        seen[pairs[i]] = true;
    }
    return pairs;
}

std::vector<std::size_t> numbers_of(const std::vector<GridIndex>& indices, const PointSet& set) {
    std::vector<std::size_t> numbers;
    for (const GridIndex& index : indices) numbers.push_back(set.number.at(index));
    return numbers;
}

/// How the listed pairs cover the points: confocal, or every illumination with every detection.
core::Scan scan_of(const std::string& path,
                   const std::vector<GridIndex>& illumination,
                   const std::vector<GridIndex>& sensing,
                   const PointSet& lit,
                   const PointSet& seen) {
    core::Scan scan;
    scan.illumination = lit.points;
    scan.sensing = seen.points;
    if (illumination == sensing) {
        scan.pattern = core::ScanPattern::Confocal;
    } else {
        scan.pattern =
            lit.points.size() == 1 ? core::ScanPattern::Single : core::ScanPattern::Exhaustive;
    }
    if (scan.num_pairs() != illumination.size()) {
        throw Error(path,
                    fmt::format("lists {} pairs of {} illumination and {} detection points",
                                illumination.size(),
                                lit.points.size(),
                                seen.points.size()),
                    "must pair every illumination with every detection point, or be confocal");
    }
    return scan;
}

Capture read_point_list(const std::string& path, const CaptureReadSettings& settings) {
    const double pitch_m = required(settings.pitch_m, path, "pitch_m");
    const double bin_width_m = required(settings.bin_width_m, path, "bin_width_m");
    const std::string signal_file = fs::is_directory(path) ? file_of(path, "sub_Sig") : path;
    const auto signal = read_mat_array<float>(signal_file, "sub_Sig");
    if (signal.shape.size() != 2) {
        throw Error(signal_file + ": sub_Sig",
                    "has shape " + shape_text(signal.shape),
                    "must have shape (pairs, bins)");
    }
    const std::size_t count = signal.shape[0];
    const auto illumination = read_indices(path, "C_i", count);
    const auto sensing = read_indices(path, "C_d", count);
    const PointSet lit = distinct_points(illumination, pitch_m);
    const PointSet seen = distinct_points(sensing, pitch_m);

    Capture capture;
    capture.scan = scan_of(path, illumination, sensing, lit, seen);
    capture.unit = core::TransientUnit::Counts;
    capture.time_axis = {0.0, bin_width_m, static_cast<int>(signal.shape[1])};
    capture.transient = core::Transient(count, capture.time_axis.num_bins);
    const auto pairs =
        pair_numbers(path, numbers_of(illumination, lit), numbers_of(sensing, seen), capture.scan);
    for (std::size_t i = 0; i < count; ++i) {
        const auto histogram = capture.transient.histogram(pairs[i]);
        for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
            histogram[bin] = signal.values[i + count * bin];
        }
    }
    capture.scene_info["original_format"] = "general-NLOS point lists .mat";
    capture.notes.push_back(fmt::format(
        "grid indices (depth, horizontal, vertical) times {} m are (z, x, y); counts", pitch_m));
    return capture;
}

}  // namespace

CaptureFormat point_list_format() {
    CaptureFormat format{"general-NLOS point lists .mat",
                         "a folder or MATLAB v5 file with sub_Sig, C_i and C_d",
                         recognise_point_list,
                         read_point_list};
    format.lacks_scale = true;
    return format;
}

}  // namespace nlos
