// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/reconstruct_settings.h"

#include "renderer/core/error.h"

#include <fmt/format.h>

#include <cmath>

namespace nlos {
namespace {

void require(bool holds, const char* key, const std::string& found, const std::string& allowed) {
    if (!holds) throw core::Error(key, "found " + found, allowed);
}

void validate(const TvSettings& settings) {
    const std::array<std::pair<const char*, double>, 3> weights{
        {{"tv.weight", settings.weight.value_or(0.0)},
         {"tv.sparsity", settings.sparsity.value_or(0.0)},
         {"tv.penalty", settings.penalty}}};
    for (const auto& [key, value] : weights) {
        require(value >= 0.0, key, fmt::format("{}", value), "must not be negative");
    }
    require(settings.penalty > 0.0, "tv.penalty", "0", "must be positive");
    require(settings.iterations >= 1,
            "tv.iterations",
            fmt::format("{}", settings.iterations),
            "must be at least 1");
}

}  // namespace

void validate(const ReconstructSettings& settings) {
    if (settings.snr) {
        require(*settings.snr > 0.0 && std::isfinite(*settings.snr),
                "snr",
                fmt::format("{}", *settings.snr),
                "must be positive");
    }
    if (settings.phasor.wavelength_m) {
        require(*settings.phasor.wavelength_m > 0.0,
                "phasor.wavelength_m",
                fmt::format("{}", *settings.phasor.wavelength_m),
                "must be positive");
    }
    require(settings.phasor.cycles >= 0.5 && settings.phasor.cycles <= 1000.0,
            "phasor.cycles",
            fmt::format("{}", settings.phasor.cycles),
            "must lie between 0.5 and 1000");
    validate(settings.tv);
    require(settings.mask_threshold > 0.0 && settings.mask_threshold < 1.0,
            "mask_threshold",
            fmt::format("{}", settings.mask_threshold),
            "must lie between 0 and 1");
    if (settings.memory_gb) {
        require(*settings.memory_gb > 0.0 && std::isfinite(*settings.memory_gb),
                "memory_gb",
                fmt::format("{}", *settings.memory_gb),
                "must be positive");
    }
    require(settings.response_floor > 0.0 && settings.response_floor < 1.0,
            "response_floor",
            fmt::format("{}", settings.response_floor),
            "must lie between 0 and 1");
    if (settings.noise_floor) {
        require(*settings.noise_floor >= 0.0 && std::isfinite(*settings.noise_floor),
                "noise_floor",
                fmt::format("{}", *settings.noise_floor),
                "must not be negative");
        require(settings.ambient != Ambient::Keep,
                "noise_floor",
                fmt::format("{} with ambient=keep", *settings.noise_floor),
                "is taken off with ambient=auto or subtract");
    }
    if (settings.merge_bins) {
        require(*settings.merge_bins >= 1,
                "merge_bins",
                fmt::format("{}", *settings.merge_bins),
                "must be at least 1");
    }
    if (settings.volume.voxels) {
        for (const int count : *settings.volume.voxels) {
            require(count >= 1 && count <= kMaxVoxelsPerAxis,
                    "volume.voxels",
                    fmt::format("{}", count),
                    "each number must lie between 1 and 65536");
        }
    }
    if (settings.volume.z_range_m) {
        const auto [begin, end] = *settings.volume.z_range_m;
        require(begin >= 0.0 && end > begin && std::isfinite(end),
                "volume.z_range_m",
                fmt::format("[{}, {}]", begin, end),
                "must be two depths, ascending and not below 0");
    }
}

}  // namespace nlos
