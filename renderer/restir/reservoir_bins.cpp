// SPDX-License-Identifier: MIT
#include "renderer/restir/reservoir_bins.h"

namespace renderer {

TimeGate ReservoirBins::lengths() const {
    if (axes_.time.num_bins == 1) return TimeGate::of_bin(axes_.time, 0, shape_);
    return {
        axes_.time.opl_start_m, axes_.time.opl_end_m() - axes_.time.opl_start_m, GateShape::Box};
}

std::optional<std::size_t> ReservoirBins::bin_of(const PathExtent& path) const {
    // A shaped gate reaches beyond its bin.
    const auto time = axes_.time.num_bins == 1 ? 0 : axes_.time.bin_of(path.opl_m);
    if (!time) return std::nullopt;
    if (!axes_.velocity) return static_cast<std::size_t>(*time);
    const auto velocity = axes_.velocity->bin_of(path.velocity_m_per_s);
    if (!velocity) return num_velocity_values();
    const std::size_t first = static_cast<std::size_t>(*velocity) * stride();
    return first + (axes_.velocity->with_time ? static_cast<std::size_t>(*time) : 0);
}

PathGate ReservoirBins::gate(std::size_t bin) const {
    if (!axes_.velocity) {
        return {TimeGate::of_bin(axes_.time, static_cast<int>(bin), shape_), std::nullopt};
    }
    const VelocityGate velocity{*axes_.velocity, static_cast<int>(bin / stride())};
    if (!axes_.velocity->with_time) return {lengths(), velocity};
    return {TimeGate::of_bin(axes_.time, static_cast<int>(bin % stride()), shape_), velocity};
}

std::optional<std::size_t> ReservoirBins::beside(std::size_t bin, int step) const {
    const std::size_t last = axes_.velocity ? num_velocity_values() : count();
    if (step < 0) return bin >= stride() ? std::optional(bin - stride()) : std::nullopt;
    return bin + stride() < last ? std::optional(bin + stride()) : std::nullopt;
}

std::optional<int> ReservoirBins::time_bin(std::size_t bin) const {
    if (axes_.time.num_bins == 1) return 0;
    if (!axes_.velocity) return static_cast<int>(bin);
    if (!axes_.velocity->with_time || is_left_out(bin)) return std::nullopt;
    return static_cast<int>(bin % stride());
}

std::optional<int> ReservoirBins::velocity_bin(std::size_t bin) const {
    if (!axes_.velocity || is_left_out(bin)) return std::nullopt;
    return static_cast<int>(bin / stride());
}

}  // namespace renderer
