// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/observed_bins.h"
#include "renderer/core/capture/pinhole_camera.h"
#include "renderer/core/capture/time_axis.h"
#include "renderer/core/capture/transient.h"
#include "renderer/core/capture/velocity_axis.h"
#include "renderer/core/settings.h"
#include "renderer/core/types.h"

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace core {

struct SensorSetup;

/// How illumination and sensing points pair up.
enum class ScanPattern { Single, Confocal, Exhaustive };

/// Where path lengths start and end: at the wall points, or at laser and detector.
enum class OplOrigin { RelayWall, Device };

/// What the numbers of a histogram are.
enum class TransientUnit { Radiance, Counts };

template <>
struct EnumNames<ScanPattern> {
    static constexpr auto value = names_from_zero<ScanPattern>("single", "confocal", "exhaustive");
};
template <>
struct EnumNames<OplOrigin> {
    static constexpr auto value = names_from_zero<OplOrigin>("relay_wall", "device");
};
template <>
struct EnumNames<TransientUnit> {
    static constexpr auto value = names_from_zero<TransientUnit>("radiance", "counts");
};

/// Points on the relay wall, either a grid of shape (X, Y) with x before y, or a plain list.
struct WallPoints {
    std::vector<Vec3> positions;  ///< [m, world]
    std::vector<Vec3> normals;    ///< unit, towards the hidden side
    std::optional<std::array<std::size_t, 2>>
        grid;  ///< (X, Y) with X * Y positions; nothing: a list

    std::size_t size() const { return positions.size(); }
};

/// What is measured: relay-wall points and how they pair up, or the pixels of a camera.
///
/// Pairs are numbered s for single and confocal scans, l * num_sensing + s for exhaustive ones, and
/// as PinholeCamera says for an image.
struct Scan {
    ScanPattern pattern = ScanPattern::Confocal;
    WallPoints illumination;  ///< confocal: the same points as `sensing`; single: one point
    WallPoints sensing;
    OplOrigin opl_origin = OplOrigin::RelayWall;
    Vec3 laser_position = Vec3::Zero();     ///< [m, world]; counts only with OplOrigin::Device
    Vec3 detector_position = Vec3::Zero();  ///< [m, world]; counts only with OplOrigin::Device

    /// When set, its pixels and its light are what is measured; both lists of points are empty,
    /// `pattern` is Single, and the devices are the camera and its light.
    std::optional<PinholeCamera> camera;

    /// When set, its zones are what is measured: `pattern` is Confocal, and the points are those
    /// that the middles of the zones look at.
    std::shared_ptr<const SensorSetup> sensor;

    std::size_t num_pairs() const {
        if (camera) return camera->num_pixels();
        return pattern == ScanPattern::Exhaustive ? illumination.size() * sensing.size()
                                                  : sensing.size();
    }
    std::size_t illumination_index(std::size_t pair) const {
        if (pattern == ScanPattern::Single) return 0;
        return pattern == ScanPattern::Confocal ? pair : pair / sensing.size();
    }
    std::size_t sensing_index(std::size_t pair) const { return pair % sensing.size(); }

    /// The points that cover the wall: the sensing points, or the illumination points where there
    /// are more of these.
    const WallPoints& scanned_points() const {
        return sensing.size() >= illumination.size() ? sensing : illumination;
    }

    /// Length of laser -> wall and wall -> detector that the axis includes for a pair [m]; 0 for
    /// images, where these are ordinary parts of a path.
    double device_legs_m(std::size_t pair) const {
        if (camera || opl_origin == OplOrigin::RelayWall) return 0.0;
        return (illumination.positions[illumination_index(pair)] - laser_position).norm() +
               (sensing.positions[sensing_index(pair)] - detector_position).norm();
    }
};

/// The shortest and the longest device_legs_m() of a scan with at least one pair [m].
std::array<double, 2> device_leg_range_m(const Scan& scan);

/// Frames of a gate and of objects that move on from one to the next.
struct FrameSequence {
    std::vector<Transient> frames;  ///< the last one is the capture's own transient
    double gate_step_m = 0.0;       ///< by which the time axis moved per frame
    double frame_s = 0.0;           ///< in which objects moved on per frame
};

/// What a detector recorded, or a renderer computed: transients and where they belong.
struct Capture {
    Scan scan;
    TimeAxis time_axis;
    Transient transient;                ///< (num_pairs, num_bins)
    ObservedBins observed;              ///< of every frame and order; all bins hold 0 elsewhere
    std::optional<Transient> variance;  ///< of each value of `transient`, when known
    TransientUnit unit = TransientUnit::Radiance;
    std::optional<double> counts_per_radiance;  ///< when counts stem from known radiance
    std::vector<int> orders;          ///< bounce orders of `by_order`; empty when not resolved
    std::vector<Transient> by_order;  ///< one per entry of `orders`; they sum to `transient`
    std::optional<VelocityHistogram> velocity;  ///< the same light by path velocity
    std::optional<FrameSequence> sequence;      ///< whose last frame the rest is about

    Json scene_info = Json::object();  ///< free dictionary: settings echo, version, seed, ...
    std::vector<std::string> notes;    ///< what the reader assumed or changed; shown by `nlos info`

    /// The bins in which the detector could record this pair.
    BinRange observed_range(std::size_t pair) const {
        return core::observed_range(observed, pair, time_axis.num_bins);
    }
    /// What a pair's histogram holds in these bins.
    std::span<const float> observed_values(std::size_t pair) const {
        const BinRange range = observed_range(pair);
        return transient.histogram(pair).subspan(static_cast<std::size_t>(range.begin),
                                                 static_cast<std::size_t>(range.size()));
    }
};

/// Visits all histograms by path length: what they are called, their values, and how many time axes
/// follow one another in each.
template <class AnyCapture, class Visit>
void for_each_transient(AnyCapture& capture, Visit&& visit) {
    visit("H", capture.transient, 1);
    if (capture.variance) visit("variance", *capture.variance, 1);
    for (auto& order : capture.by_order) visit("H_by_order", order, 1);
    if (capture.sequence) {
        for (auto& frame : capture.sequence->frames) visit("frames", frame, 1);
    }
    if (!capture.velocity || !capture.velocity->axis.with_time) return;
    const int num_velocities = capture.velocity->axis.num_bins;
    visit("velocity", capture.velocity->values, num_velocities);
    if (capture.velocity->variance) {
        visit("velocity_variance", *capture.velocity->variance, num_velocities);
    }
}

/// How far a scan's points extend along two axes: those of their grid, or x and y of the world for
/// a list. `Scan::scanned_points` decide.
struct ScanExtent {
    std::array<Vec3, 2> axes{Vec3::UnitX(), Vec3::UnitY()};
    std::array<double, 2> middle_m{};  ///< along each axis
    std::array<double, 2> size_m{};    ///< first to last
};

/// scan   of at least one point of each kind; no image of a camera
ScanExtent scan_extent(const Scan& scan);

/// Throws Error unless a scan has points, each with a normal, all of them finite, or a camera.
///
/// where   prefix of messages
void validate(const Scan& scan, const std::string& where);

/// Throws Error unless points, pairs, bins and normals agree, every value is finite, and bins that
/// were not observed hold 0.
///
/// where   prefix of messages, usually the file's name
void validate(const Capture& capture, const std::string& where);

/// Declares that bins outside a range were not observed: sets them to 0 in all histograms and
/// intersects the range with what is said already. Histograms of velocity alone stay as they are.
///
/// Images keep no ranges: their bins outside hold 0, which is taken for darkness.
///
/// range    of all pairs, or one per pair, within the axis
/// throws   Error for a range that is not
void restrict_observed(Capture& capture, const BinRange& range);
void restrict_observed(Capture& capture, const std::vector<BinRange>& ranges);

}  // namespace core
