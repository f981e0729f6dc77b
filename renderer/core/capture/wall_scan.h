// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/settings.h"
#include "renderer/core/types.h"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace core {

/// How illumination and sensing points pair up.
enum class ScanPattern { Single, Confocal, Exhaustive };

/// Where path lengths start and end: at the wall points, or at laser and detector.
enum class OplOrigin { RelayWall, Device };

template <>
struct EnumNames<ScanPattern> {
    static constexpr auto value = names_from_zero<ScanPattern>("single", "confocal", "exhaustive");
};
template <>
struct EnumNames<OplOrigin> {
    static constexpr auto value = names_from_zero<OplOrigin>("relay_wall", "device");
};

/// Points on the relay wall, either a grid of shape (X, Y) with x before y, or a plain list.
struct WallPoints {
    std::vector<Vec3> positions;  ///< [m, world]
    std::vector<Vec3> normals;    ///< unit, towards the hidden side
    std::optional<std::array<std::size_t, 2>>
        grid;  ///< (X, Y) with X * Y positions; nothing: a list

    std::size_t size() const { return positions.size(); }

    /// (X, Y) of a grid, (N) of a list.
    std::vector<std::size_t> extents() const;
};

/// Positions of what emits and records the light [m, world].
struct Devices {
    Vec3 laser;
    Vec3 detector;
};

/// A kind of scan: points on a relay wall and how they pair up.
///
/// Pairs are numbered s for single and confocal scans, l * num_sensing + s for exhaustive ones.
struct WallScan {
    ScanPattern pattern = ScanPattern::Confocal;
    WallPoints illumination;  ///< confocal: the same points as `sensing`; single: one point
    WallPoints sensing;
    OplOrigin opl_origin = OplOrigin::RelayWall;
    Vec3 laser_position = Vec3::Zero();     ///< [m, world]; counts only with OplOrigin::Device
    Vec3 detector_position = Vec3::Zero();  ///< [m, world]; counts only with OplOrigin::Device

    /// Whether bins that nobody observed are kept apart from dark ones.
    static constexpr bool has_observed_bins = true;

    std::string_view name() const { return enum_name(pattern); }

    bool is_confocal() const { return pattern == ScanPattern::Confocal; }
    bool is_exhaustive() const { return pattern == ScanPattern::Exhaustive; }

    std::size_t num_pairs() const {
        return is_exhaustive() ? illumination.size() * sensing.size() : sensing.size();
    }
    std::size_t illumination_index(std::size_t pair) const {
        if (pattern == ScanPattern::Single) return 0;
        return is_confocal() ? pair : pair / sensing.size();
    }
    std::size_t sensing_index(std::size_t pair) const { return pair % sensing.size(); }

    const Vec3& illumination_point(std::size_t pair) const {
        return illumination.positions[illumination_index(pair)];
    }
    const Vec3& sensing_point(std::size_t pair) const {
        return sensing.positions[sensing_index(pair)];
    }

    /// How the pairs stand in arrays: the extents of the sensing points, behind those of the
    /// illumination points where all pair with all.
    std::vector<std::size_t> pair_extents() const;

    /// The points that cover the wall: the sensing points, or the illumination points where there
    /// are more of these.
    const WallPoints& scanned_points() const {
        return sensing.size() >= illumination.size() ? sensing : illumination;
    }

    Devices devices() const { return {laser_position, detector_position}; }

    /// Where light paths may start and end [m, world].
    std::vector<Vec3> path_ends() const;

    /// Length of laser -> wall and wall -> detector that the axis includes for a pair [m].
    double device_segments_m(std::size_t pair) const {
        if (opl_origin == OplOrigin::RelayWall) return 0.0;
        return (illumination_point(pair) - laser_position).norm() +
               (sensing_point(pair) - detector_position).norm();
    }
};

/// The shortest and the longest device_segments_m() of a scan with at least one pair [m].
std::array<double, 2> device_segment_range_m(const WallScan& scan);

/// How far a scan's points extend along two axes: those of their grid, or x and y of the world for
/// a list. `WallScan::scanned_points` decide.
struct ScanExtent {
    std::array<Vec3, 2> axes{Vec3::UnitX(), Vec3::UnitY()};
    std::array<double, 2> middle_m{};  ///< along each axis
    std::array<double, 2> size_m{};    ///< first to last
};

/// scan   of at least one point of each kind
ScanExtent scan_extent(const WallScan& scan);

/// Throws Error unless a scan has points, each with a normal, all of them finite.
///
/// where   prefix of messages
void validate(const WallScan& scan, const std::string& where);

}  // namespace core
