// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/fit/fit.h"

namespace apps {

inline constexpr double kMillimetre = 1e-3;  // in metres

/// The forward model against exact arcs, its energy, and how long it takes.
void bench_forward(FitBench& bench);

/// The Jacobian against automatic derivatives and against differences.
void bench_gradients(FitBench& bench);

/// Heights of a curved surface's vertices, 5 x 5 and 9 x 9 of them, from 1e6 photons.
void bench_heights(int trials, FitBench& bench);

/// Calibration from direct returns of a wall at 1 m, tilted by 30 degrees.
void bench_direct_returns(int trials, FitBench& bench);

}  // namespace apps
