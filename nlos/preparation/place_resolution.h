// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/prepared_capture.h"

#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// How well a scan's path lengths tell from where in the hidden scene light came.
///
/// A step e at a place p changes the length of the path l -> p -> s by g e, g the sum of the unit
/// vectors from l and from s to p. The direction told worst is the one in which the root of the
/// mean square of g e over all pairs is smallest, and two places are told apart along it that
/// change lengths by what bins tell. Of one wall point, of a row of points around that row, and of
/// points very near each other it is wide: they tell distances rather than directions.
class PlaceResolution {
 public:
    /// told_m   by which lengths must differ, a bin
    PlaceResolution(const core::WallScan& scan, double told_m);

    /// How far apart places around this one must be to be told apart in any direction [m, world];
    /// infinite where no distance is enough.
    double at(const core::Vec3& place) const;

 private:
    std::vector<core::Vec3> illumination_, sensing_;  ///< of some pairs
    double told_m_;
};

/// How well a capture's light is told apart at its middle range, before the middle of the wall
/// points, by lengths that differ by a bin; nothing in the dark.
std::optional<LightResolution> resolve_light(const PreparedCapture& prepared);

/// Why `prepared.light` is told apart over no less than all of the points' extent, for people;
/// nothing where it is, and in the dark.
std::optional<std::string> why_no_directions(const PreparedCapture& prepared);

}  // namespace nlos
