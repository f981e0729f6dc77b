// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/film/time_gate.h"

#include <cstddef>
#include <optional>

namespace renderer {

/// The reservoirs of one pair: one per bin of the time axis or, with a velocity axis, one per bin
/// of that (of both, where velocities are resolved in time). A last one then takes the paths that
/// the velocity axis leaves out; it serves the time histogram alone and is not reused.
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

    /// All lengths that any of them admits.
    TimeGate lengths() const;
    /// The one that admits a path; nothing when its length lies outside.
    std::optional<std::size_t> bin_of(const PathExtent& path) const;
    /// What one of them admits; not for the one that is left out.
    PathGate gate(std::size_t bin) const;

    /// The bin beside another one along what a shift keeps, `step` is 1 or -1; nothing at the ends.
    std::optional<std::size_t> beside(std::size_t bin, int step) const;

    /// Bins of time and velocity that one belongs to; nothing where it holds paths of several.
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
