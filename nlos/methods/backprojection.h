// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/reconstruction/reconstruct_settings.h"

#include <span>
#include <vector>

namespace nlos {

/// Backprojection: v(p) = sum over pairs (l, s) of H(l, s; |l - p| + |p - s|), linear in time
/// between bin centres. Adjoint of a forward model without cosines, and without falloff unless each
/// term is multiplied by what the light lost on its way. Where some bins were not observed, sums
/// are divided by the share of their terms that was, see divide_by_observed_share().
///
/// input       any scan; confocal grids whose y positions share a lattice with the voxels' take the
///             fast way (shifted additions of whole rows), all others the general one
/// settings    compensation, the factor of each term: none, r_l^2 r_s^2 (diffuse), r_l r_s (retro)
/// num_slabs   the fast way copies this part of the wall's rows at a time
/// returns     sums in the histograms' unit
/// throws      core::Failure when asked to stop
/// source      [Velten2012]
Volume backproject(const MethodInput& input,
                   const ReconstructSettings& settings,
                   std::size_t num_slabs = 1);

/// Memory that backproject() takes on top of its input, its volume included [bytes].
double backproject_bytes(const MethodInput& input,
                         const ReconstructSettings& settings,
                         std::size_t num_slabs = 1);

/// Confocal measurements on a wall grid.
template <class Real>
struct ConfocalGrid {
    const WallGrid& grid;
    core::TimeAxis time_axis;
    std::span<const Real> histograms;     ///< [point of the capture][bin]
    std::vector<double> device_legs_m{};  ///< per point, part of the axis; empty: none
    Compensation compensation = Compensation::None;
};

/// Pairs of wall points in the wall's frame, in any arrangement.
template <class Real>
struct PairList {
    core::ScanPattern pattern;
    core::TimeAxis time_axis;
    std::span<const Real> histograms;         ///< [pair][bin], pairs as in core::Scan
    std::vector<core::Vec3> illumination;     ///< [m]; confocal: the same as `sensing`
    std::vector<core::Vec3> sensing;          ///< [m]
    std::vector<double> illumination_legs_m;  ///< laser to each point, part of the axis
    std::vector<double> sensing_legs_m;       ///< each point to the detector, part of the axis
    Compensation compensation = Compensation::None;
};

/// Adds the backprojection to `volume` [x][y][z]; Real is float or double. The y positions of
/// voxels and grid must have a common_lattice().
///
/// num_slabs   as backproject()
/// source      the lateral shift in reconstruction of confocal scans: the path length depends only
///             on depth and on the offset of voxel and wall point
template <class Real>
void backproject_confocal_grid(const ConfocalGrid<Real>& data,
                               const VolumeAxes& axes,
                               std::span<Real> volume,
                               const core::Progress& progress,
                               std::size_t num_slabs = 1);

/// Adds the backprojection to `volume` [x][y][z]; Real is float or double.
template <class Real>
void backproject_pairs(const PairList<Real>& data,
                       const VolumeAxes& axes,
                       std::span<Real> volume,
                       const core::Progress& progress);

}  // namespace nlos
