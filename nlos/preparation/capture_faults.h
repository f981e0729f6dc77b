// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nlos {

/// Bins and points that a detector recorded wrongly: what they hold is no light of any scene.
struct CaptureFaults {
    using PairBin = std::pair<std::size_t, int>;

    std::vector<PairBin> hot_bins;
    std::vector<PairBin> saturated_bins;
    std::vector<PairBin> negative_bins;   ///< of counts, where they are few
    std::vector<std::size_t> hot_points;  ///< numbers of pairs, as are the next
    std::vector<std::size_t> saturated_points;
    std::vector<std::size_t> dead_points;

    bool empty() const { return *this == CaptureFaults{}; }
    bool operator==(const CaptureFaults&) const = default;
};

/// Finds them by what light cannot do between wall points that are near each other.
///
/// A path to a point d away is longer or shorter by at most 2 d (confocal; d otherwise), and light
/// from range r by at most ((r + d) / r)^8 brighter, falloff and cosines. So a bin is hot that is
/// 10 times brighter than that makes of any bin, within that time, of its 8 nearest points, and
/// three times as bright as anything they hold, falloff taken off or not. Strong returns light the
/// neighbours too. What chance makes of a neighbour's ambient light is no light from near the wall.
///
/// Bins are saturated that hold the largest value of all, if it is one of 4, 8, 12, ... full bits
/// or is held by three bins in a row now and then, and if more counts are that than noise leaves on
/// one number: five times as many as on one just below it. A point is saturated if half of its bins
/// are.
///
/// A point is hot if half of its bins are brighter than all that its neighbours hold, or many of
/// its bins are hot; and dead if all of its bins are 0, chance does not explain that, and three
/// quarters of its neighbours hold light. Negative counts are faults where they are fewer than one
/// in a hundred; more come from a background that was taken off.
///
/// returns   no hot and dead ones in captures of fewer than 25 pairs and where a twentieth of all
///           pairs looks like that: then it is how the scene is lit
CaptureFaults find_faults(const core::Capture& capture);

/// The capture without them, see core::leave_out_bins().
core::Capture leave_out(const CaptureFaults& faults, const core::Capture& capture);

/// What is left out, in one line; nothing where nothing is.
std::optional<std::string> describe(const CaptureFaults& faults);

}  // namespace nlos
