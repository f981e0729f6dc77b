// SPDX-License-Identifier: MIT
#pragma once

#include "calib/setup/setup_fit.h"

#include <cstddef>
#include <string>
#include <vector>

namespace calib {

/// What is done with points that are far off when all others fit.
enum class OutlierRule { Keep, LeaveOut };

/// The set-up that explains observations, and how far it is to be believed.
struct SetupVerdict {
    SetupFit fit;
    std::vector<std::size_t> outliers;  ///< points far off; `fit` is with or without them
    double sigma_scale = 1.0;           ///< by which the misfit exceeds the noise, at least 1
    std::vector<std::string> warnings;
};

/// Finds the set-up and asks what casts doubt on it.
///
/// Sound is what noise explains: photons counted, and light that was sorted into bins. Beyond that,
/// in this order: single points far off; what may have been read wrongly (misreadings.h); known
/// values that the rest contradicts; points that have nothing to do with the commands; and a misfit
/// that none of these explains, by which the reported errors then grow.
///
/// throws   core::Failure naming the cause where the values would mean nothing
/// source   [Huber2009] for the weights of points far off; [Wilson1931] for chance
SetupVerdict judge_setup(const SetupObservations& observations, OutlierRule rule);

}  // namespace calib

template <>
struct core::EnumNames<calib::OutlierRule> {
    static constexpr auto value = names_from_zero<calib::OutlierRule>("keep", "leave_out");
};
