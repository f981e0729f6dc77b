// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/film/time_gate.h"

#include <cstddef>
#include <optional>

namespace renderer {

/// The reservoirs of one pair: one per bin of the time axis or, with a velocity axis, one per bin
/// of that (of both, where velocities are resolved in time). The last one then holds the paths
/// outside the velocity axis; it serves the time histogram alone and is not reused.
class ReservoirBins {
 public:
    ReservoirBins() = default;
    /// shape   of the gate of a time axis with one bin
    ReservoirBins(const core::HistogramAxes& axes, GateShape shape) : axes_(axes), shape_(shape) {}

    const core::HistogramAxes& axes() const { return axes_; }

    std::size_t count() const {
        return axes_.velocity ? num_velocity_values() + 1
                              : static_cast<std::size_t>(axes_.time.num_bins);
    }
    bool is_left_out(std::size_t bin) const {
        return axes_.velocity && bin == num_velocity_values();
    }

    /// The gate of all reservoirs together.
    TimeGate lengths() const;
    /// The bin of a path; nothing when its length lies outside.
    std::optional<std::size_t> bin_of(const PathExtent& path) const;
    /// The gate of a bin; not for the one outside the velocity axis.
    PathGate gate(std::size_t bin) const;

    /// The next bin along the quantity that shifts preserve, `step` is 1 or -1; nothing at the
    /// ends.
    std::optional<std::size_t> beside(std::size_t bin, int step) const;

    /// The time and the velocity bin of a reservoir; nothing where it holds paths of several.
    std::optional<int> time_bin(std::size_t bin) const;
    std::optional<int> velocity_bin(std::size_t bin) const;

 private:
    std::size_t num_velocity_values() const {
        return static_cast<std::size_t>(axes_.velocity->num_values(axes_.time.num_bins));
    }
    /// Reservoirs of one bin of velocity.
    std::size_t stride() const {
        return axes_.velocity && axes_.velocity->with_time
                   ? static_cast<std::size_t>(axes_.time.num_bins)
                   : 1;
    }

    core::HistogramAxes axes_;
    GateShape shape_ = GateShape::Box;
};

}  // namespace renderer
