// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/field/reconstruction_table.h"
#include "apps/bench/field/rendering_table.h"

namespace apps {

/// A figure in which a peer does better than we do.
struct Loss {
    std::string task{};
    std::string figure{};
    std::string program{};
    std::string method{};
    double theirs = 0.0;
    std::optional<double> ours_alike{};  ///< of our method of the same name
    std::string our_best{};              ///< our best method for this figure
    std::optional<double> ours_best{};
};
NLOS_FIGURES(Loss, task, figure, program, method, theirs, ours_alike, our_best, ours_best);

/// Where a peer beats our method of the same name by more than 2 %, or the best of ours by
/// anything.
std::vector<Loss> find_losses(const std::vector<ReconstructionSummary>& summaries);

/// Where a peer takes less for 1 % than the fastest of ours.
std::vector<Loss> find_losses(const std::vector<RenderingSummary>& summaries);

}  // namespace apps
