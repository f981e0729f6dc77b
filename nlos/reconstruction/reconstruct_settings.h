// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruction/method.h"
#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/settings/json_fwd.h"

#include <array>
#include <optional>

namespace nlos {

inline constexpr int kMaxVoxelsPerAxis = 65536;

/// How hidden surfaces reflect: diffuse light falls off with r^4, retroreflected light with r^2.
/// Diffuse surfaces that face the wall add the cosines z / r of wall and surface, there and back:
/// z^4 / r^8, which the solver alone models. Auto: as the data say, see choose_falloff().
enum class Falloff { Diffuse, Retro, Facing, Auto };

/// The power of range by which light falls off on its way there and back.
constexpr double falloff_power(Falloff falloff) {
    switch (falloff) {
        case Falloff::Retro:
            return 2.0;
        case Falloff::Facing:
            return 8.0;
        default:
            return 4.0;
    }
}

/// What backprojection multiplies each term by, to make up for the light lost on its way.
enum class Compensation { None, Diffuse, Retro };

/// How filtered backprojection sharpens: a filter on the volume, or one on the histograms.
enum class FbpFilter { Laplacian, Phasor };

/// What happens to constant background light.
enum class Ambient { Auto, Keep, Subtract };

/// Whether a response that nobody stated is told from the histograms and taken off. Auto: where
/// these cannot be without one, see spectral_slope().
enum class BlindDeconvolution { Auto, Off, On };

/// What a reconstruction assumes about the hidden scene beyond the data. Tv: the solver, by the
/// name of its prior.
enum class Prior { None, Tv };

/// What is known of the noise of histograms.
enum class Likelihood { Auto, Poisson, Gaussian };

/// Where to reconstruct. Empty fields are chosen from the capture.
struct VolumeSettings {
    std::optional<std::array<int, 3>> voxels;
    std::optional<std::array<double, 2>> z_range_m;
};

/// Which part of the capture to use. Empty fields: all of it.
struct CropSettings {
    std::optional<std::array<double, 2>> x_range_m;    ///< of wall points, in the wall's frame
    std::optional<std::array<double, 2>> y_range_m;    ///< of wall points, in the wall's frame
    std::optional<std::array<double, 2>> opl_range_m;  ///< of bins
};

/// The virtual wave of the phasor field.
struct PhasorSettings {
    std::optional<double> wavelength_m;  ///< in path length; empty: from the pitch of wall points
    double cycles = 5.0;                 ///< in the envelope: sigma = cycles * wavelength / 6
};

/// The statistical solver: noise, and priors of few edges and few bright places, both as multiples
/// of what the noise of the data makes of a voxel.
struct SolverSettings {
    Likelihood likelihood = Likelihood::Auto;
    std::optional<double> tv;           ///< weight of total variation; empty: by the light
    std::optional<double> sparsity;     ///< weight of the sum; empty: a tenth of `tv`
    std::optional<double> spot_m;       ///< full width at half maximum of the spot on the wall;
                                        ///< empty: as the capture gives, else 0
    bool gains = false;                 ///< finds a factor of every pair, see PairGains
    std::optional<double> tolerance;    ///< empty: by the solver
    std::optional<int> max_iterations;  ///< empty: by the solver
};

/// How uncertain the set-up is, as standard deviations; empty fields: see enter_uncertainties().
/// The text `none` stands for 0 throughout.
struct SetupSettings {
    std::optional<double> time_zero_sigma_ps;
    std::optional<double> wall_scale_sigma;
    std::optional<double> spot_sigma_m;
    bool is_none = false;
};

/// How to reconstruct.
struct ReconstructSettings {
    Method method = Method::Auto;
    VolumeSettings volume;
    Falloff falloff = Falloff::Auto;
    Prior prior = Prior::None;
    Compensation compensation = Compensation::None;
    FbpFilter filter = FbpFilter::Laplacian;
    PhasorSettings phasor;
    SolverSettings solver;
    CropSettings crop;
    std::optional<double> snr;        ///< Wiener filter of lct, dlct; empty: see wiener_snr()
    core::ResponseSettings response;  ///< of the set-up, to take off; all 0: none
    double response_floor = 0.1;      ///< see ResponseDeconvolution
    Ambient ambient = Ambient::Auto;
    std::optional<double>
        noise_floor;                  ///< background per bin; empty: each pair's, see find_signal()
    std::optional<int> merge_bins;    ///< neighbouring bins added up first; empty: from the pitch
    double mask_threshold = 0.5;      ///< probability of a surface: foreground of depth and points
    std::optional<double> memory_gb;  ///< to take at most; empty: what the machine has
    BlindDeconvolution blind_deconvolution = BlindDeconvolution::Auto;
    SetupSettings setup;
};

template <class Visitor>
void for_each_field(SetupSettings& s, Visitor&& visit) {
    visit("time_zero_sigma_ps",
          s.time_zero_sigma_ps,
          core::at_least(0,
                         "standard deviation of time zero [ps]; null: 10 of measured captures, 0 "
                         "of others"));
    visit("wall_scale_sigma",
          s.wall_scale_sigma,
          core::at_least(0,
                         "standard deviation of the wall's scale, as a fraction; null: 0.003 of "
                         "measured captures, 0 of others"));
    visit("spot_sigma_m",
          s.spot_sigma_m,
          core::at_least(0,
                         "standard deviation of the laser spots along the wall's x and along y, of "
                         "scans that are not confocal [m]; null: 0.002 of measured captures, 0 of "
                         "others"));
}

/// Of an object with named fields, or the text `none`.
void read_value(const core::Json& json, const std::string& where, SetupSettings& settings);
core::Json write_value(const SetupSettings& settings);

template <class Visitor>
void for_each_field(VolumeSettings& s, Visitor&& visit) {
    visit(
        "voxels",
        s.voxels,
        core::between(
            1,
            kMaxVoxelsPerAxis,
            "number of voxels along wall x, wall y and depth; null: columns at the scan's points"));
    visit("z_range_m", s.z_range_m, "depths from the wall [m]; null: what the time axis covers");
}

template <class Visitor>
void for_each_field(CropSettings& s, Visitor&& visit) {
    visit("x_range_m", s.x_range_m, "wall points to use along wall x [m]; null: all");
    visit("y_range_m", s.y_range_m, "wall points to use along wall y [m]; null: all");
    visit("opl_range_m", s.opl_range_m, "path lengths to use [m]; null: all");
}

template <class Visitor>
void for_each_field(PhasorSettings& s, Visitor&& visit) {
    visit("wavelength_m",
          s.wavelength_m,
          core::above(
              0, "wavelength in path length [m]; null: 4 distances of wall points, confocal 6"));
    visit("cycles",
          s.cycles,
          core::between(0.5, 1000, "wavelengths in the envelope, 6 standard deviations"));
}

template <class Visitor>
void for_each_field(SolverSettings& s, Visitor&& visit) {
    visit("likelihood",
          s.likelihood,
          "noise of the histograms; auto: poisson for counts, gaussian for radiance");
    visit("tv",
          s.tv,
          core::at_least(0,
                         "weight of total variation, in standard deviations of a voxel's noise; "
                         "null: for confocal grids 0.35 of counts and 0.6 of radiance, more where "
                         "light is scarce, else 1"));
    visit("sparsity",
          s.sparsity,
          core::at_least(0,
                         "weight of the sum of all voxels, likewise; null: a tenth of solver.tv, "
                         "or reweighted where spot and response are wide"));
    visit("spot_m",
          s.spot_m,
          core::at_least(0,
                         "full width at half maximum of the spot on the wall [m]; null: as the "
                         "capture gives, else 0"));
    visit(
        "gains",
        s.gains,
        "whether a factor of every wall point (its reflectance, the detector's efficiency), known "
        "to three tenths, is found with the scene");
    visit("tolerance",
          s.tolerance,
          core::strictly_between(0,
                                 1,
                                 "relative change of the result at which iterations stop; null: "
                                 "0.015 for confocal grids (0.001 where spot and response are "
                                 "wide), times the root of the fraction of their points that were "
                                 "observed; else 0.01"));
    visit("max_iterations",
          s.max_iterations,
          core::at_least(1,
                         "iterations at most; null: 200, or 600 where spot and response are wide"));
}

template <class Visitor>
void for_each_field(ReconstructSettings& s, Visitor&& visit) {
    visit("method", s.method, "reconstruction method");
    visit("volume", s.volume, "where to reconstruct");
    visit(
        "falloff",
        s.falloff,
        "how the hidden surface reflects (lct, dlct, fk, phasor, fbp by phasor, solver); facing: "
        "diffuse, and parallel to the wall (solver); auto: as the data of confocal grids say where "
        "method=auto takes the solver for counts, or where the solver explains a response wider "
        "than the distance of wall points, else diffuse");
    visit("prior", s.prior, "assumption about the hidden scene (lct); tv: as method solver");
    visit("solver", s.solver, "the statistical solver");
    visit("compensation",
          s.compensation,
          "falloff that each term is multiplied by (bp, and fbp by laplacian)");
    visit("filter", s.filter, "how fbp sharpens");
    visit("phasor", s.phasor, "virtual wave (phasor, and fbp by phasor)");
    visit("crop", s.crop, "part of the capture to use");
    visit("snr",
          s.snr,
          core::above(0,
                      "signal to noise ratio of the Wiener filter (lct, dlct); null: from the "
                      "noise of counts, 1 "
                      "for radiance"));
    visit("response", s.response, "response of laser and detector to take off the histograms");
    visit("response_floor",
          s.response_floor,
          core::strictly_between(0,
                                 1,
                                 "ratio of noise to signal, as amplitudes: frequencies of which "
                                 "the response leaves less "
                                 "are not restored"));
    visit("blind_deconvolution",
          s.blind_deconvolution,
          "take off a response that all histograms share, told from these alone (all methods but "
          "solver): a diffusing medium, a detector's tail; auto: where no response is stated and "
          "the spectrum of the histograms falls off as no surface's does");
    visit("setup",
          s.setup,
          "how uncertain the set-up is, which depth_sigma_m counts; none: it is exact");
    visit("ambient",
          s.ambient,
          "constant background light, and bins behind the signal's end; auto: taken off counts");
    visit(
        "noise_floor",
        s.noise_floor,
        core::at_least(
            0,
            "background light and dark counts in every bin, in the histograms' unit, to take off; "
            "null: each pair's own, from the darkest quarter of the axis; with falloff=facing the "
            "solver finds a factor of it"));
    visit("merge_bins",
          s.merge_bins,
          core::at_least(1,
                         "neighbouring bins added up first; null: as many as keep a bin's range "
                         "within a quarter "
                         "of the distance of scan points"));
    visit("mask_threshold",
          s.mask_threshold,
          core::strictly_between(
              0, 1, "probability of a surface from which on a column has a depth and a point"));
    visit(
        "memory_gb",
        s.memory_gb,
        core::above(
            0,
            "memory to take at most, beside the capture's [GB]; what needs more is done in slabs, "
            "or refused; null: what is free"));
}

/// Throws core::Error naming the first setting that is out of range.
void validate(const ReconstructSettings& settings);

}  // namespace nlos

template <>
struct core::EnumNames<nlos::Compensation> {
    static constexpr auto value = names_from_zero<nlos::Compensation>("none", "diffuse", "retro");
};
template <>
struct core::EnumNames<nlos::FbpFilter> {
    static constexpr auto value = names_from_zero<nlos::FbpFilter>("laplacian", "phasor");
};
template <>
struct core::EnumNames<nlos::Falloff> {
    static constexpr auto value =
        names_from_zero<nlos::Falloff>("diffuse", "retro", "facing", "auto");
};
template <>
struct core::EnumNames<nlos::Ambient> {
    static constexpr auto value = names_from_zero<nlos::Ambient>("auto", "keep", "subtract");
};
template <>
struct core::EnumNames<nlos::BlindDeconvolution> {
    static constexpr auto value = names_from_zero<nlos::BlindDeconvolution>("auto", "off", "on");
};
template <>
struct core::EnumNames<nlos::Prior> {
    static constexpr auto value = names_from_zero<nlos::Prior>("none", "tv");
};
template <>
struct core::EnumNames<nlos::Likelihood> {
    static constexpr auto value = names_from_zero<nlos::Likelihood>("auto", "poisson", "gaussian");
};
