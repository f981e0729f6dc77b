// SPDX-License-Identifier: MIT
#include "nlos/preparation/checks/capture_correction.h"

#include "nlos/preparation/wall_frame.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nlos {
namespace {

using core::Vec3;

constexpr double kMirrorTolerance = 1e-3;  // of the wall's extent
constexpr double kFlatTolerance = 0.01;    // of the wall's extent
constexpr double kMostWalls = 30.0;        // away, and the inverse
constexpr double kLeastBin_m = 3e-5;       // 0.1 ps: nothing that counts photons is faster
constexpr double kMostBin_m = 1.0;

constexpr double kC = core::kSpeedOfLight;
constexpr std::array kLengthFactors{2.0, 0.5, kC * 1e-9, 1e9 / kC};
constexpr std::array kWallUnits{1e-3, 1e-2, 0.0254, 1e3};  // mm, cm, inches and km for metres
constexpr std::array kFarFactors{
    1e-3, 1e3, 1e-6, 1e6, 1e-9, 1e9, 1e-12, 1e12, kC, 1.0 / kC, kC * 1e-12, 1e12 / kC};

/// The point whose histogram each point's place in the file holds, of a grid.
std::size_t moved_point(const core::WallPoints& points,
                        const CaptureCorrection& correction,
                        std::size_t stored) {
    if (!points.grid) return stored;
    const auto [nx, ny] = *points.grid;
    std::size_t x = correction.swap_xy ? stored % nx : stored / ny;
    std::size_t y = correction.swap_xy ? stored / nx : stored % ny;
    if (correction.flip_x) x = nx - 1 - x;
    if (correction.flip_y) y = ny - 1 - y;
    return x * ny + y;
}

/// A list of points after the wall's size has been corrected.
std::vector<Vec3> corrected_points(const core::WallPoints& points,
                                   const core::ScanExtent& extent,
                                   double wall_factor) {
    std::vector<Vec3> positions = points.positions;
    if (positions.size() < 2 || wall_factor == 1.0) return positions;
    for (Vec3& position : positions) {
        for (int i = 0; i < 2; ++i) {
            const double offset = extent.axes[i].dot(position) - extent.middle_m[i];
            position += (wall_factor - 1.0) * offset * extent.axes[i];
        }
    }
    return positions;
}

/// Half the length in the middle of the sample, device segments taken off.
double middle_range_m(const HistogramSample& sample, const PathGeometry& geometry) {
    double segments_m = 0.0;
    for (const double segments : geometry.segments_m) segments_m += segments;
    segments_m /= static_cast<double>(geometry.segments_m.size());
    return 0.5 * (geometry.opl_start_m +
                  0.5 * geometry.bin_width_m * static_cast<double>(sample.num_bins) - segments_m);
}

/// Largest distance between a sampled point and the first one.
double extent_of(const PathGeometry& geometry) {
    double extent = 0.0;
    for (const auto* points : {&geometry.sensing, &geometry.illumination}) {
        for (const Vec3& position : *points) {
            extent = std::max(extent, (position - geometry.sensing.front()).norm());
        }
    }
    return extent;
}

bool knows_devices(const core::WallScan& scan) {
    return scan.opl_origin == core::OplOrigin::Device || !scan.laser_position.isZero() ||
           !scan.detector_position.isZero();
}

void add_lengths(const core::Capture& capture,
                 const HistogramSample& sample,
                 std::vector<CaptureCorrection>& list) {
    const core::TimeAxis& axis = capture.time_axis;
    const bool starts_late = std::abs(axis.opl_start_m) > 2.0 * axis.bin_width_m;
    const auto add = [&](double factor) {
        for (const bool keeps_start : {false, true}) {
            if (keeps_start && !starts_late) continue;
            CaptureCorrection correction;
            correction.length_factor = factor;
            correction.keeps_start = keeps_start;
            const double bin_m = factor * axis.bin_width_m;
            if (bin_m < kLeastBin_m || bin_m > kMostBin_m) continue;
            if (is_in_proportion(capture, sample, correction)) list.push_back(correction);
        }
    };
    for (const double factor : kLengthFactors) add(factor);
    if (is_in_proportion(capture, sample, {})) return;
    for (const double factor : kFarFactors) add(factor);
}

}  // namespace

bool is_scale_free(const core::WallScan& scan) {
    if (scan.opl_origin == core::OplOrigin::Device || scan.pattern == core::ScanPattern::Single) {
        return false;
    }
    const core::ScanExtent extent = core::scan_extent(scan);
    const Vec3 normal = extent.axes[0].cross(extent.axes[1]);
    const double tolerance = kFlatTolerance * std::max(extent.size_m[0], extent.size_m[1]);
    const double first = normal.dot(scan.sensing.positions.front());
    for (const core::WallPoints* points : {&scan.sensing, &scan.illumination}) {
        for (const Vec3& position : points->positions) {
            if (std::abs(normal.dot(position) - first) > tolerance) return false;
        }
    }
    return true;
}

PathGeometry corrected_geometry(const core::Capture& capture,
                                const HistogramSample& sample,
                                const CaptureCorrection& correction) {
    const core::TimeAxis& axis = capture.time_axis;
    core::WallScan scan = capture.scan.wall();
    const core::ScanExtent extent = core::scan_extent(scan);
    for (core::WallPoints* points : {&scan.sensing, &scan.illumination}) {
        points->positions = corrected_points(*points, extent, correction.wall_factor);
    }
    if (correction.origin) scan.opl_origin = *correction.origin;

    PathGeometry geometry;
    const core::Transform wall_from_world = derive_wall_frame(scan).world_from_wall.inverse();
    const double bin_m = correction.length_factor * axis.bin_width_m;
    const double start_m =
        (correction.keeps_start ? 1.0 : correction.length_factor) * axis.opl_start_m +
        correction.shift_m;
    geometry.bin_width_m = sample.merged_bins * bin_m;
    geometry.opl_start_m = start_m + sample.first_bin * bin_m;
    if (correction.flip_t) {
        geometry.opl_start_m = start_m + (axis.num_bins - sample.first_bin) * bin_m;
        geometry.bin_width_m = -geometry.bin_width_m;
    }
    for (const std::size_t stored : sample.pairs) {
        std::size_t lit = scan.illumination_index(stored);
        const std::size_t sensed =
            moved_point(scan.sensing, correction, scan.sensing_index(stored));
        if (scan.pattern == core::ScanPattern::Confocal) lit = sensed;
        if (scan.pattern == core::ScanPattern::Exhaustive) {
            lit = moved_point(scan.illumination, correction, lit);
        }
        const bool is_exhaustive = scan.pattern == core::ScanPattern::Exhaustive;
        const std::size_t pair = is_exhaustive ? lit * scan.sensing.size() + sensed : sensed;
        geometry.illumination.push_back(wall_from_world * scan.illumination.positions[lit]);
        geometry.sensing.push_back(wall_from_world * scan.sensing.positions[sensed]);
        geometry.segments_m.push_back(scan.device_segments_m(pair));
    }
    return geometry;
}

bool is_mirror_image(const core::Capture& capture,
                     const HistogramSample& sample,
                     const CaptureCorrection& correction) {
    const PathGeometry own = corrected_geometry(capture, sample, {});
    const PathGeometry moved = corrected_geometry(capture, sample, correction);
    const double tolerance = kMirrorTolerance * extent_of(own);
    const auto differ = [&](double a, double b) { return std::abs(a - b) > tolerance; };
    for (std::size_t a = 0; a < sample.pairs.size(); ++a) {
        if (differ(own.segments_m[a], moved.segments_m[a])) return false;
        for (std::size_t b = 0; b <= a; ++b) {
            const auto apart = [&](const PathGeometry& g) {
                return std::array{(g.sensing[a] - g.sensing[b]).norm(),
                                  (g.illumination[a] - g.illumination[b]).norm(),
                                  (g.illumination[a] - g.sensing[b]).norm(),
                                  (g.sensing[a] - g.illumination[b]).norm()};
            };
            if (!std::ranges::equal(
                    apart(own), apart(moved), [&](double x, double y) { return !differ(x, y); })) {
                return false;
            }
        }
    }
    return true;
}

bool is_in_proportion(const core::Capture& capture,
                      const HistogramSample& sample,
                      const CaptureCorrection& correction) {
    const PathGeometry geometry = corrected_geometry(capture, sample, correction);
    const double walls = middle_range_m(sample, geometry) / extent_of(geometry);
    return walls > 1.0 / kMostWalls && walls < kMostWalls;
}

std::vector<CaptureCorrection> possible_corrections(const core::Capture& capture,
                                                    const HistogramSample& sample) {
    const core::WallScan& scan = capture.scan.wall();
    std::vector<CaptureCorrection> list;
    add_lengths(capture, sample, list);
    if (knows_devices(scan)) {
        list.emplace_back().origin = scan.opl_origin == core::OplOrigin::Device
                                         ? core::OplOrigin::RelayWall
                                         : core::OplOrigin::Device;
    }
    if (!is_in_proportion(capture, sample, {})) {
        for (const double factor : kWallUnits) {
            CaptureCorrection correction;
            correction.wall_factor = factor;
            if (is_in_proportion(capture, sample, correction)) list.push_back(correction);
        }
        return list;
    }
    if (!is_scale_free(scan)) {
        for (const double factor : {2.0, 0.5}) {
            list.emplace_back().wall_factor = factor;
        }
    }
    list.emplace_back().flip_t = true;
    if (!scan.sensing.grid) return list;
    for (auto axis :
         {&CaptureCorrection::swap_xy, &CaptureCorrection::flip_x, &CaptureCorrection::flip_y}) {
        CaptureCorrection correction;
        correction.*axis = true;
        if (!is_mirror_image(capture, sample, correction)) list.push_back(correction);
    }
    return list;
}

}  // namespace nlos
