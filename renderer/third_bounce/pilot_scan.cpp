// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/pilot_scan.h"

#include "renderer/scene/coinciding_points.h"
#include "renderer/third_bounce/surface_subdivider.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

constexpr std::size_t kPilotPoints = 32;         // confocal and single
constexpr std::size_t kPilotPointsPerSide = 12;  // exhaustive
// With few bins there is less to compare per pair.
constexpr int kPilotFewBins = 16;
constexpr std::size_t kPilotPointsForFewBins = 128;
constexpr std::size_t kPilotPointsPerSideForFewBins = 16;

// `count` indices below `size`, spread evenly but not in step with the rows of a grid; all of them
// where these are few, since a single point whose shadow goes unseen then weighs much in the error.
std::vector<std::size_t> spread_indices(std::size_t size, std::size_t count) {
    constexpr double kGolden = 0.6180339887498949;
    if (size <= 2 * count) count = size;
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < std::min(size, count); ++i) {
        const double share = (static_cast<double>(i) + 0.5) * kGolden;
        indices.push_back(count >= size ? i
                                        : static_cast<std::size_t>(static_cast<double>(size) *
                                                                   (share - std::floor(share))));
    }
    std::sort(indices.begin(), indices.end());
    indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
    return indices;
}

void append(const core::WallPoints& points, std::size_t index, core::WallPoints& chosen) {
    chosen.positions.push_back(points.positions[index]);
    chosen.normals.push_back(points.normals[index]);
}

core::WallPoints subset(const core::WallPoints& points, std::size_t count) {
    core::WallPoints chosen;
    for (const std::size_t i : spread_indices(points.size(), count)) append(points, i, chosen);
    return chosen;
}

// Adds a pair whose ends coincide, if the scan has one and the pilot run has none.
void add_confocal_pair(const core::Scan& scan, core::Scan& pilot) {
    const CoincidingPoints coinciding(scan);
    if (!coinciding.any() || CoincidingPoints(pilot).any()) return;
    const auto found = std::ranges::find(coinciding.sensing, true);
    const auto sensor = static_cast<std::size_t>(found - coinciding.sensing.begin());
    append(scan.sensing, sensor, pilot.sensing);
    if (scan.pattern == core::ScanPattern::Single) return;
    for (std::size_t light = 0; light < scan.illumination.size(); ++light) {
        if (scan.illumination.positions[light] != scan.sensing.positions[sensor] ||
            scan.illumination.normals[light] != scan.sensing.normals[sensor]) {
            continue;
        }
        append(scan.illumination, light, pilot.illumination);
        return;
    }
}

}  // namespace

core::Scan pilot_scan_for(const Scene& scene, const core::Scan& scan, int num_bins) {
    const bool few_bins = num_bins < kPilotFewBins;
    if (scan.pattern == core::ScanPattern::Exhaustive) {
        return pilot_scan(
            scene, scan, few_bins ? kPilotPointsPerSideForFewBins : kPilotPointsPerSide);
    }
    return pilot_scan(scene, scan, few_bins ? kPilotPointsForFewBins : kPilotPoints);
}

core::Scan pilot_scan(const Scene& scene, const core::Scan& scan, std::size_t num_points) {
    core::Scan pilot = scan;
    pilot.sensing = subset(scan.sensing, num_points);
    if (scan.pattern == core::ScanPattern::Exhaustive) {
        pilot.illumination = subset(scan.illumination, num_points);
    }
    if (scan.pattern == core::ScanPattern::Confocal) pilot.illumination = pilot.sensing;
    const bool has_retroreflectors = std::ranges::any_of(scene.objects(), [](const Object& object) {
        return kind_of(object.material) == ElementKind::Retroreflective;
    });
    if (has_retroreflectors) add_confocal_pair(scan, pilot);
    return pilot;
}

core::TimeAxis pilot_axis(const core::TimeAxis& axis) {
    if (axis.num_bins < kPilotFewBins) return axis;
    const double first_bin = std::floor(axis.opl_start_m / axis.bin_width_m);
    return {first_bin * axis.bin_width_m, axis.bin_width_m, axis.num_bins + 1};
}

}  // namespace renderer
