// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/checks/scatter_cells.h"

namespace nlos {

/// What scatters light evenly from anywhere before the wall, fitted to a sample under a geometry.
///
/// Cells in polar coordinates around the middle of the points, each not negative, are fitted by
/// expectation maximisation [Shepp1982] over ordered subsets [Hudson1994] with a free gain per
/// histogram, so that angles, materials and gains of pixels matter little. The first fit has coarse
/// cells, and each refinement halves the heaviest of them; the others stay, since scenes that fill
/// a room light up many. A fit costs some 4e6 terms for 196 pairs of 48 bins, and four times as
/// much refined to the end.
class ScatterFit {
 public:
    static constexpr int kRefinements = 2;

    /// sample        must outlive the fit
    /// refinements   to begin with
    ScatterFit(const HistogramSample& sample, PathGeometry geometry, int refinements = 0);

    void refine();

    /// The fraction of the sample's structure that is left over: squares in units of the variance
    /// that Poisson noise and a model right to a tenth have, without the noise that counts have,
    /// over what the mean histogram, scaled to each pair, leaves. 0 is a perfect explanation, and
    /// above 1 the geometry explains less than no geometry does; 1 where all lengths would lie
    /// behind the wall.
    double unexplained() const { return unexplained_; }

 private:
    /// Fits the cells' light, and what it leaves over if no cells follow these.
    void fit(bool is_last);

    const HistogramSample* sample_;
    PathGeometry geometry_;
    ScatterCells cells_;
    double unexplained_ = 1.0;
};

/// What no hidden scene explains of a sample under a geometry: that of a fit refined to the end.
double unexplained_fraction(const HistogramSample& sample, const PathGeometry& geometry);

/// Whether histograms differ from each other beyond noise; else all geometries explain them alike.
bool has_structure(const HistogramSample& sample);

}  // namespace nlos
