// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings.h"

#include <array>
#include <optional>

namespace nlos {

enum class Method { Auto, Lct, Bp };

/// How hidden surfaces reflect: diffuse light falls off with r^4, retroreflected light with r^2.
enum class Falloff { Diffuse, Retro };

/// What happens to constant background light.
enum class Ambient { Auto, Keep, Subtract };

/// What a reconstruction assumes about the hidden scene beyond the data.
enum class Prior { None };

/// Where to reconstruct. Empty fields are chosen from the capture.
struct VolumeSettings {
    std::optional<std::array<int, 3>> voxels;
    std::optional<std::array<double, 2>> z_range_m;
};

/// How to reconstruct; adding a method: a name in Method, a case in reconstruct(), one .cpp.
struct ReconstructSettings {
    Method method = Method::Auto;
    VolumeSettings volume;
    Falloff falloff = Falloff::Diffuse;
    Prior prior = Prior::None;
    std::optional<double> snr;  ///< Wiener filter of lct; empty: 0.1 for counts, else 1
    Ambient ambient = Ambient::Auto;
    std::optional<int> merge_bins;  ///< neighbouring bins added up first; empty: from the pitch
    double mask_threshold = 0.2;    ///< of the maximum: foreground of depth map and points
};

template <class Visitor>
void for_each_field(VolumeSettings& s, Visitor&& visit) {
    visit("voxels", s.voxels, "number of voxels along x, y, z; null: columns at the scan's points");
    visit("z_range_m", s.z_range_m, "depth range [m]; null: what the time axis covers");
}

template <class Visitor>
void for_each_field(ReconstructSettings& s, Visitor&& visit) {
    visit("method", s.method, "reconstruction method");
    visit("volume", s.volume, "where to reconstruct");
    visit("falloff", s.falloff, "how the hidden surface reflects (lct)");
    visit("prior", s.prior, "assumption about the hidden scene");
    visit("snr",
          s.snr,
          "signal to noise ratio of the Wiener filter (lct); null: 0.1 for counts, 1 for radiance");
    visit("ambient",
          s.ambient,
          "constant background light, and bins behind the signal's end; auto: taken off counts");
    visit("merge_bins",
          s.merge_bins,
          "neighbouring bins added up first; null: as many as keep a bin's range within a quarter "
          "of the distance of scan points");
    visit("mask_threshold", s.mask_threshold, "share of the maximum that counts as foreground");
}

}  // namespace nlos

template <>
struct core::EnumNames<nlos::Method> {
    static constexpr std::array<std::pair<nlos::Method, std::string_view>, 3> value{
        {{nlos::Method::Auto, "auto"}, {nlos::Method::Lct, "lct"}, {nlos::Method::Bp, "bp"}}};
};
template <>
struct core::EnumNames<nlos::Falloff> {
    static constexpr std::array<std::pair<nlos::Falloff, std::string_view>, 2> value{
        {{nlos::Falloff::Diffuse, "diffuse"}, {nlos::Falloff::Retro, "retro"}}};
};
template <>
struct core::EnumNames<nlos::Ambient> {
    static constexpr std::array<std::pair<nlos::Ambient, std::string_view>, 3> value{
        {{nlos::Ambient::Auto, "auto"},
         {nlos::Ambient::Keep, "keep"},
         {nlos::Ambient::Subtract, "subtract"}}};
};
template <>
struct core::EnumNames<nlos::Prior> {
    static constexpr std::array<std::pair<nlos::Prior, std::string_view>, 1> value{
        {{nlos::Prior::None, "none"}}};
};
