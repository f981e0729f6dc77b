// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/output.h"

#include <string>

namespace apps {

/// What the field's table is made of.
struct FieldSettings {
    std::string part = "all";  ///< all, reconstruct, render or captures
    std::string peers;         ///< environment of install_peers.sh; empty: our methods alone
    std::string captures;      ///< folder with a captures.json; empty: none
    int sensing_points = 32;   ///< along either side of the wall
    double limit_s = 120.0;    ///< CPU time that one run may take
    bool quick = false;        ///< the letter alone, fewer points and samples
};

/// Our methods and installed peers side by side on the same files: reconstruction of scenes by
/// light levels, rendering by orders of bounces with the agreement of every bin, and captures of
/// the user's. Every run is a process of its own on one thread; one that fails costs its row.
///
/// folder    gets the captures, volumes and logs of all runs
/// throws    core::Error for a folder of peers or captures that is none; core::Failure when
///           interrupted
BenchResult measure_field(const FieldSettings& settings,
                          const std::string& folder,
                          const core::Progress& progress);

}  // namespace apps
