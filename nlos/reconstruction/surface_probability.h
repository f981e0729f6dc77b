// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace nlos {

/// Of many tests, the probability that each one's null hypothesis is true although its p-value is
/// as small as it is: the share of true null hypotheses over the density of p-values, which falls
/// with p.
///
/// p_values   uniform where the null hypothesis holds, or larger
/// returns    as many values in [0, 1], rising with p
/// source     local false discovery rate [Efron2001], falling density [Grenander1956], share of
///            true null hypotheses [Storey2002]
std::vector<double> false_discovery_rates(const std::vector<double>& p_values);

/// The probability that columns hold a surface and not what a method smears around one.
///
/// A blurred edge crosses about half of the surface's brightness where the surface ends. So the
/// odds are the ratio of the peak to a share of the surfaces' mean brightness, to the power of 4;
/// the numbers fit simulated scenes. The mean is weighted by brightness and the square of this very
/// probability.
///
/// peaks        brightest value of each column, not negative
/// weights      in [0, 1]: the probability that it is more than noise
/// edge_share   of the mean brightness, at which the odds are even: 0.45 for methods that blur
/// returns      as many values in [0, 1], rising with the peak; 0 for a peak of 0
std::vector<double> plateau_probabilities(const std::vector<double>& peaks,
                                          const std::vector<double>& weights,
                                          double edge_share);

}  // namespace nlos
