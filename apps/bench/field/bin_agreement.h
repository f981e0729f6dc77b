// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/transient.h"
#include "renderer/core/settings/json_fwd.h"

#include <array>
#include <cstddef>
#include <vector>

namespace apps {

/// How well independent runs of one renderer agree with what another says is the truth.
struct BinAgreement {
    double energy_ratio = 0.0;  ///< all light of the runs over that of the truth
    double energy_z = 0.0;      ///< how many standard errors the ratio lies from 1
    int num_cells = 0;          ///< groups of bins that were compared
    double worst_z = 0.0;       ///< the largest standard score of a cell, by magnitude
    double rms_z = 0.0;         ///< root mean square of the scores; 1 by chance
};

/// Compares runs with the truth, cell by cell.
///
/// A cell is `block` times `block` wall points by as many neighbouring bins as hold
/// `least_fraction` of that block's true light: so many paths fall into it that the mean of the
/// runs is normally distributed. Its score is the mean of the runs less the truth over the standard
/// error that the runs' own spread says, Student's t turned into a normal score.
///
/// truth        one histogram per wall point of a grid, stored [x][y]
/// runs         of the same shape, from independent seeds; at least 8
/// grid         extents along x and y, multiples of `block`
/// systematic   fraction of the light that the runs may be off by for known reasons
/// returns      cells without any light in truth and runs do not count; one that only the runs
///              light has an infinite score
/// source       normal scores of Student's t: Abramowitz and Stegun 1964, 26.7.8
BinAgreement bin_agreement_of(const core::Transient& truth,
                              const std::vector<core::Transient>& runs,
                              std::array<std::size_t, 2> grid,
                              std::size_t block,
                              double least_fraction,
                              double systematic = 0.0);

/// The magnitude that the largest of so many normal scores exceeds with probability `level`.
double largest_score_by_chance(int num_scores, double level);

/// Says of the rows of a table of agreements whether they are `consistent`. They are judged
/// together, since chance may call one table in a hundred inconsistent.
///
/// rows   with `cells` and the scores `worst_z` (null: not measured), `energy_z` and `rms_z`
void judge_agreement(std::vector<core::Json>& rows);

}  // namespace apps
