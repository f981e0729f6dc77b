// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

namespace nlos {

/// Of many tests, the probability that each one's null hypothesis is true although its p-value is
/// as small as it is: the fraction of true null hypotheses over the density of p-values, which
/// falls with p.
///
/// p_values   uniform where the null hypothesis holds, or larger
/// returns    as many values in [0, 1], rising with p
/// source     local false discovery rate [Efron2001], falling density [Grenander1956], fraction of
///            true null hypotheses [Storey2002]
std::vector<double> false_discovery_rates(const std::vector<double>& p_values);

/// Brightness at which a column is as likely a surface as what a method smears around one.
struct PlateauFractions {
    double edge = 0.7;     ///< of the surfaces among the column and its eight neighbours; 0: none
    double dimmest = 0.2;  ///< of all surfaces
    double power = 4.0;    ///< of the odds that the ratio to `dimmest` makes
};

/// The probability that columns hold a surface and not what a method smears around one.
///
/// Across a blurred edge brightness falls within a column or two; where a surface turns away, or is
/// dim, it falls slowly. So a column is held against the mean brightness of the surfaces around it,
/// and, less strictly, against that of all. The odds are the ratio to a fraction of the one to the
/// power of 12, and of the other to a power of its own; the probabilities of both are multiplied.
/// Means are weighted by brightness and the square of the probability itself. Fractions and powers
/// fit simulated scenes.
///
/// peaks     brightness of each column of a grid (x, y), not negative
/// weights   in [0, 1]: the probability that it is more than noise
/// num_y     number of columns along y
/// returns   as many values in [0, 1]; 0 for a peak of 0
std::vector<double> plateau_probabilities(const std::vector<double>& peaks,
                                          const std::vector<double>& weights,
                                          std::size_t num_y,
                                          const PlateauFractions& fractions);

}  // namespace nlos
