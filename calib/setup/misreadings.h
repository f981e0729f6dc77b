// SPDX-License-Identifier: MIT
#pragma once

#include "calib/setup/setup_observations.h"

#include <string>
#include <vector>

namespace calib {

/// A usual way of reading what a set-up's files hold wrongly, and the observations without it.
struct Misreading {
    std::string looks;  ///< "the commands look like degrees"
    std::string help;   ///< the setting, "command_unit=deg"
    SetupObservations corrected;
};

/// All that may be wrong with these observations, the likeliest first: time reversed, units of
/// commands, axis and known values, axes of the galvo exchanged or mirrored, points in another
/// order.
std::vector<Misreading> misreadings(const SetupObservations& observations);

}  // namespace calib
