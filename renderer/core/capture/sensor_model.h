// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/time_axis.h"
#include "renderer/core/settings/json_fwd.h"
#include "renderer/core/settings/settings.h"
#include "renderer/core/types.h"

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace core {

/// What a sensor's laser lights: the whole field at once, or each zone its own spot in turn.
enum class SensorIllumination { Flood, Zones };

template <>
struct EnumNames<SensorIllumination> {
    static constexpr auto value = names_from_zero<SensorIllumination>("flood", "zones");
};

/// How a sensor's laser and photon counters behave.
struct SensorDetector {
    double pulse_fwhm_ps = 0.0;
    double jitter_fwhm_ps = 0.0;
    double wavelength_nm = 940.0;
    double laser_w = 0.02;
    double repetition_hz = 2.5e7;
    double aperture_mm2 = 0.5;
    double efficiency = 0.02;
    double dark_counts_hz = 0.0;
    double dead_time_ns = 0.0;
    bool pile_up = false;
    double zone_crosstalk = 0.0;
    double cover_glass_crosstalk = 0.0;
    double frame_s = 0.0333;
    int cut_after_direct_bins = 0;

    /// Width of pulse and jitter together [ps], both taken for Gaussian.
    double response_fwhm_ps() const { return std::hypot(pulse_fwhm_ps, jitter_fwhm_ps); }
};

/// A histogram camera as its data sheet describes it.
///
/// Its zones are a grid of equal rectangles of a pinhole's image, numbered row by row from the top
/// left as the sensor sees the wall.
struct SensorModel {
    std::string name;
    std::string title;
    std::array<int, 2> zones{4, 4};             ///< columns and rows
    std::array<double, 2> fov_deg{45.0, 45.0};  ///< of all zones: horizontal and vertical
    SensorIllumination illumination = SensorIllumination::Flood;
    std::array<double, 2> emitter_m{0.0, 0.0};  ///< from the receiver: right and up
    double bin_width_s = 250e-12;
    int num_bins = 128;
    double first_bin_s = 0.0;  ///< start of bin 0 after the light has left
    SensorDetector detector;
    std::map<std::string, std::string> sources;  ///< where numbers come from, by their key

    int num_zones() const { return zones[0] * zones[1]; }
    TimeAxis time_axis() const {
        return {opl_from_seconds(first_bin_s), opl_from_seconds(bin_width_s), num_bins};
    }
};

template <class Visitor>
void for_each_field(SensorDetector& d, Visitor&& visit) {
    visit("pulse_fwhm_ps",
          d.pulse_fwhm_ps,
          at_least(0, "full width at half maximum of the laser pulse [ps]"));
    visit("jitter_fwhm_ps",
          d.jitter_fwhm_ps,
          at_least(0, "full width at half maximum of the detector's jitter [ps]"));
    visit("wavelength_nm", d.wavelength_nm, above(0, "wavelength in vacuum [nm]"));
    visit("laser_w", d.laser_w, above(0, "mean power of the laser while it measures [W]"));
    visit("repetition_hz", d.repetition_hz, above(0, "laser pulses per second [1/s]"));
    visit("aperture_mm2", d.aperture_mm2, above(0, "area of the receiving lens [mm^2]"));
    visit("efficiency",
          d.efficiency,
          Ranged{"detected fraction of the photons that reach the lens",
                 {.low = 0.0, .high = 1.0, .with_high = true}});
    visit("dark_counts_hz", d.dark_counts_hz, at_least(0, "dark counts of a zone [1/s]"));
    visit("dead_time_ns", d.dead_time_ns, at_least(0, "blind time after every detection [ns]"));
    visit("pile_up", d.pile_up, "record no more than the first photon of a laser pulse");
    visit("zone_crosstalk",
          d.zone_crosstalk,
          Ranged{"fraction of a zone's light that each of its side neighbours records instead",
                 {.low = 0.0, .with_low = true, .high = 0.25, .with_high = true}});
    visit("cover_glass_crosstalk",
          d.cover_glass_crosstalk,
          at_least(0,
                   "light that the cover glass returns at time zero, relative to the direct "
                   "return of a white wall 1 m in front"));
    visit("frame_s", d.frame_s, above(0, "time in which a zone collects light for a frame [s]"));
    visit("cut_after_direct_bins",
          d.cut_after_direct_bins,
          at_least(0,
                   "bins after the direct return that the firmware sets to zero with it and "
                   "what is before; 0: nothing is cut"));
}

template <class Visitor>
void for_each_field(SensorModel& s, Visitor&& visit) {
    visit("name", s.name, "short name");
    visit("title", s.title, "name for people");
    visit("zones", s.zones, Ranged{"columns and rows of zones", {1, true, 256, true}});
    visit("fov_deg",
          s.fov_deg,
          Ranged{"field of view of all zones, horizontal and vertical [degrees]",
                 {.low = 0.0, .high = 170.0, .with_high = true}});
    visit("illumination", s.illumination, "what the laser lights at a time");
    visit("emitter_m",
          s.emitter_m,
          Ranged{"laser from the receiver, to the right and up as the sensor sees it [m]", {}});
    visit("bin_width_s", s.bin_width_s, above(0, "width of a bin [s]"));
    visit("num_bins", s.num_bins, Ranged{"number of bins", {1, true, 1e6, true}});
    visit("first_bin_s", s.first_bin_s, Ranged{"start of bin 0 after light has left [s]", {}});
    visit("detector", s.detector, "laser and photon counters");
    visit("sources", s.sources, "by key: where its number comes from");
}

/// All but the sources, which stay with the description.
Json write_value(const SensorModel& model);

/// Throws Error naming the value that is out of range.
void validate(const SensorModel& model, const std::string& where);

/// Name and text of data/sensors/*.json, which are compiled into the program.
const std::vector<std::pair<std::string_view, std::string_view>>& shipped_sensor_texts();

/// Names of the sensors that come with the program.
std::vector<std::string> shipped_sensors();

/// A sensor of the program's own by its name, or one that a JSON file describes.
///
/// where    names the setting in messages about an unknown name
/// throws   Error naming file and key, or the known names
SensorModel read_sensor_model(const std::string& name_or_path, const std::string& where = "sensor");

}  // namespace core
