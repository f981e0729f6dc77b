// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/core/capture/instrument_response.h"

#include <cstdint>
#include <optional>
#include <string>

namespace nlos {

/// What turns radiance into detected photons per second.
struct RadiometrySettings {
    double laser_w = 1.0;
    double wavelength_nm = 532.0;
    double etendue_m2_sr = 4e-8;
    double efficiency = 0.3;
};

/// A single-photon detector and how long it looks.
struct DetectorSettings {
    std::optional<double> photons;
    std::optional<double> photons_per_point;
    std::optional<double> exposure_s;
    core::ResponseSettings response;
    double dark_counts_hz = 0.0;
    double ambient = 0.0;
    bool pile_up = false;
    double dead_time_ns = 0.0;
    double repetition_hz = 1e7;
    RadiometrySettings radiometry;
    bool expected = false;
    std::uint64_t seed = 0;
};

template <class Visitor>
void for_each_field(RadiometrySettings& s, Visitor&& visit) {
    visit("laser_w", s.laser_w, core::above(0, "mean power on the illumination point [W]"));
    visit("wavelength_nm", s.wavelength_nm, core::above(0, "wavelength in vacuum [nm]"));
    visit("etendue_m2_sr",
          s.etendue_m2_sr,
          core::above(0, "area seen on the wall times solid angle of the lens [m^2 sr]"));
    visit("efficiency",
          s.efficiency,
          core::Ranged{"detected fraction of the photons that reach the lens",
                       {.low = 0.0, .high = 1.0, .with_high = true}});
}

template <class Visitor>
void for_each_field(DetectorSettings& s, Visitor&& visit) {
    visit("photons", s.photons, core::above(0, "expected signal photons in the whole capture"));
    visit("photons_per_point",
          s.photons_per_point,
          core::above(0,
                      "expected signal photons per prepared pair, on average over all pairs that "
                      "were observed"));
    visit("exposure_s",
          s.exposure_s,
          core::above(0,
                      "time per pair [s]; alone it gives the number of photons by `radiometry`, "
                      "beside photons "
                      "it only counts pulses and dark counts; null: 1"));
    visit("response", s.response, "instrument response");
    visit(
        "dark_counts_hz", s.dark_counts_hz, core::at_least(0, "dark counts of the detector [1/s]"));
    visit("ambient", s.ambient, core::at_least(0, "expected counts of ambient light in every bin"));
    visit("pile_up", s.pile_up, "record no more than the first photon of a laser pulse");
    visit(
        "dead_time_ns", s.dead_time_ns, core::at_least(0, "blind time after every detection [ns]"));
    visit("repetition_hz", s.repetition_hz, core::above(0, "laser pulses per second [1/s]"));
    visit("radiometry", s.radiometry, "from radiance to photons, for exposure_s alone");
    visit("expected", s.expected, "write expected counts instead of random ones");
    visit("seed", s.seed, "seed of the random numbers");
}

/// Throws core::Error naming the first setting that is out of range, and unless one of `photons`,
/// `photons_per_point` and `exposure_s` says how much light there is.
void validate(const DetectorSettings& settings);

/// Why counts of a capture would differ from those of the light that it was binned from: bins that
/// are wide beside the response lose where within them light arrives, so that sharp edges come out
/// narrower than the response, in variance by up to a twelfth of a squared bin. For people.
std::optional<std::string> coarse_bins_warning(const core::Capture& capture,
                                               const DetectorSettings& settings);

/// What a detector records of a capture: counts.
///
/// Every histogram is scaled to expected photons, convolved with the response, put on ambient light
/// and dark counts, thinned by pile-up and dead time, and drawn. With pile-up the detector is armed
/// at the axis' start of every pulse and records one photon at most; with dead time alone it is
/// always armed unless blind, between two pulses too, and carries its blindness into later pulses.
/// A dead time is rounded to whole bins. Nothing is detected in bins that were not observed, nor
/// between the pulses of a pair that has such bins: its detector is gated.
/// Frames are recorded one by one, each for the whole exposure; a number of photons is then that of
/// a frame, on average.
///
/// capture    radiance, or counts to be scaled to another number of photons; not negative
/// returns    scan, observed bins and frames of `capture` with unit counts; `counts_per_radiance`
///            and the settings are recorded; variance and orders of bounces are dropped. The same
///            for any number of threads.
/// throws     core::Error for settings or captures that do not fit
/// source     first photon of a pulse [Coates1968]
core::Capture detect(const core::Capture& capture, const DetectorSettings& settings);

}  // namespace nlos
