// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/track_settings.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/capture/sensor_footprint.h"
#include "renderer/core/capture/time_axis.h"
#include "renderer/core/types.h"

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace calib {

/// Fraction of a pulse of standard deviation `sigma_m` around 0 that falls into a bin of width
/// `width_m`, by the distance of the bin's centre, and its derivative; tabulated.
class PulseTable {
 public:
    PulseTable(double sigma_m, double width_m);

    /// Beyond this distance the fraction is 0 [m].
    double reach_m() const { return reach_m_; }

    struct Value {
        double fraction = 0.0;
        double slope = 0.0;  ///< [1/m]
    };
    Value at(double distance_m) const {
        const double position = (distance_m + reach_m_) * per_m_;
        if (!(position >= 0.0) || position >= static_cast<double>(fraction_.size() - 1)) return {};
        const auto i = static_cast<std::size_t>(position);
        const double f = position - static_cast<double>(i);
        return {fraction_[i] + f * (fraction_[i + 1] - fraction_[i]),
                slope_[i] + f * (slope_[i + 1] - slope_[i])};
    }

 private:
    double reach_m_;
    double per_m_;
    std::vector<double> fraction_;
    std::vector<double> slope_;
};

/// The fraction of its light that each zone of a grid gives to each neighbour beside it, above and
/// below.
struct ZoneCrosstalk {
    int columns = 0;
    int rows = 0;
    double fraction = 0.0;
};

/// What a target of strength 1 adds to the histograms of a sensor.
///
/// A retroreflective target sends the light that it gets from a wall point back to this point; each
/// zone records what it lights and sees itself, cos / r^2 for a point of the wall. A diffuse one
/// scatters evenly, and the histogram is that of the segments from all points lit, convolved with
/// that of the segments to the points seen, cos / r^2 each. A small body's depth widens the pulse
/// by the standard deviation of a ball's chords.
///
/// Values stand [zone][bin], bin fastest.
class TargetResponse {
 public:
    /// footprints   what zones light and see; of one frame
    /// axis         of the histograms; a target at path length l falls into the bin of l
    /// opl_origin   whether path lengths include the segments between devices and wall
    /// sigma_m      standard deviation of pulse and jitter in path length [m]
    /// crosstalk    what zones see of their neighbours
    TargetResponse(const core::SensorFootprints& footprints,
                   const core::TimeAxis& axis,
                   const TargetSettings& target,
                   core::SensorIllumination illumination,
                   core::OplOrigin opl_origin,
                   double sigma_m,
                   const ZoneCrosstalk& crosstalk = {});

    std::size_t num_zones() const { return zones_.size(); }
    std::size_t num_bins() const { return static_cast<std::size_t>(axis_.num_bins); }
    std::size_t size() const { return num_zones() * num_bins(); }

    /// Bins [begin, end) of a zone that are not 0.
    struct Window {
        int begin = 0;
        int end = 0;
    };

    /// Sets `values` of one target, which may be anywhere on the wall's hidden side.
    ///
    /// values     size() numbers
    /// gradient   by the target's position [1/m], size() numbers, or empty
    /// returns    the bins of each zone that were set; all others are left as they are
    std::vector<Window> evaluate(const core::Vec3& position_m,
                                 std::span<double> values,
                                 std::span<core::Vec3> gradient) const;

 private:
    struct Segment {
        core::Vec3 position_m;
        double weight = 0.0;
        double device_m = 0.0;
    };
    struct Zone {
        std::vector<Segment> there_and_back;  ///< retroreflective
        std::vector<Segment> lit;             ///< diffuse, where each zone lights its own spot
        std::vector<Segment> seen;            ///< diffuse
    };
    /// A segment seen from a position: length with the device's segment, weight, and their
    /// gradients.
    struct Reach {
        double opl_m = 0.0;
        double weight = 0.0;
        core::Vec3 opl_gradient;
        core::Vec3 weight_gradient;
    };
    /// Those of all segments, and their shortest and longest path.
    struct Reaches {
        std::vector<Reach> all;
        double first_m = std::numeric_limits<double>::infinity();
        double last_m = -std::numeric_limits<double>::infinity();
    };
    struct LitPulse;  ///< what all points lit send to the target, by time

    Reach reach(const Segment& segment, const core::Vec3& position_m, double segments) const;
    Reaches reaches(const std::vector<Segment>& segments,
                    const core::Vec3& position_m,
                    double ways) const;
    LitPulse lit_pulse(const std::vector<Segment>& lit, const core::Vec3& position_m) const;
    Window bins_around(double first_m, double last_m, double margin_m) const;
    Window add_retroreflective(const Zone& zone,
                               const core::Vec3& position_m,
                               std::span<double> values,
                               std::span<core::Vec3> gradient) const;
    Window add_diffuse(const Zone& zone,
                       const LitPulse& lit,
                       const core::Vec3& position_m,
                       std::span<double> values,
                       std::span<core::Vec3> gradient) const;

    void mix_zones(std::vector<Window>& windows,
                   std::span<double> values,
                   std::span<core::Vec3> gradient) const;

    core::TimeAxis axis_;
    core::Vec3 normal_;
    ZoneCrosstalk crosstalk_;
    PulseTable pulse_;
    double sigma_m_;
    std::vector<Zone> zones_;
    std::vector<Segment> flood_;  ///< diffuse, where all is lit at once
};

/// Standard deviation of pulse, jitter and body in path length [m]; at least a quarter of a bin.
double response_sigma_m(double pulse_sigma_m, double radius_m, double bin_width_m);

}  // namespace calib
