// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/methods.h"
#include "nlos/preparation/wall_frame.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace nlos {

/// Backprojection: v(p) = sum over pairs (l, s) of H(l, s; |l - p| + |p - s|), linear in time
/// between bin centres. Adjoint of a forward model without cosines, and without falloff unless each
/// term is multiplied by what the light lost on its way. Where some bins were not observed, sums
/// are divided by the fraction of their terms that was, see divide_by_observed_fraction().
///
/// input      any scan; confocal grids whose y positions share a lattice with the voxels' take the
///            fast way (shifted additions of whole rows), all others the general one
/// settings   compensation, the factor of each term: none, r_l^2 r_s^2 (diffuse), r_l r_s (retro)
/// slabs      of the wall's rows, which the fast way copies
/// returns    sums in the histograms' unit
/// source     [Velten2012]
MethodTraits::Run backproject;
MethodTraits::Bytes backproject_bytes;

/// Magnitude of the backprojection of histograms convolved with the phasor field's virtual wave,
/// and divided by the observed fraction as in backproject(). Settings: phasor, whose wavelength_m
/// must be set. Source: [Liu2019].
MethodTraits::Run phasor_backprojection;
MethodTraits::Bytes phasor_backprojection_bytes;

/// Two multiply-adds for every histogram and voxel.
LeastWork least_backprojection_work(const MethodInput& input, const ReconstructSettings& settings);

/// Confocal measurements on a wall grid.
template <class Real>
struct ConfocalGrid {
    const WallGrid& grid;
    core::TimeAxis time_axis;
    std::span<const Real> histograms;         ///< [point of the capture][bin]
    std::vector<double> device_segments_m{};  ///< per point, part of the axis; empty: none
    Compensation compensation = Compensation::None;
};

/// Pairs of wall points in the wall's frame, in any arrangement.
template <class Real>
struct PairList {
    core::ScanPattern pattern;
    core::TimeAxis time_axis;
    std::span<const Real> histograms;             ///< [pair][bin], pairs as in core::WallScan
    std::vector<core::Vec3> illumination;         ///< [m]; confocal: the same as `sensing`
    std::vector<core::Vec3> sensing;              ///< [m]
    std::vector<double> illumination_segments_m;  ///< laser to each point, part of the axis
    std::vector<double> sensing_segments_m;       ///< each point to the detector, part of the axis
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

/// Divides the backprojected sums of a capture whose bins were not all observed by the fraction of
/// each voxel's look-ups that met an observed bin, of those within the axis. What is left are sums
/// as of the whole capture, and no trace of which points were dead or where their gates began.
///
/// Few look-ups that all meet light are weak evidence: no voxel is raised to more than twice what
/// the mean fraction, over all observed look-ups, would raise it to. A voxel that nobody looked at
/// stays 0.
///
/// input    with `observed`
/// throws   core::Failure when asked to stop
void divide_by_observed_fraction(const MethodInput& input, std::size_t num_slabs, Volume& volume);

/// Memory that this takes on top of its input [bytes]; 0 when all bins were observed.
double observed_fraction_bytes(const MethodInput& input);

/// Voxels and wall points along y seen as every n-th point of one lattice.
struct CommonLattice {
    std::size_t voxel_step = 1;
    std::size_t wall_step = 1;
};

/// The coarsest lattice of steps up to 4 that holds the grid's y positions and `y_m`, if any.
std::optional<CommonLattice> common_lattice(const WallGrid& grid, const std::vector<double>& y_m);

/// Voxel rows that one wall row serves at one |dx|: usually the two at +dx and -dx.
struct Offset {
    std::size_t distance = 0;  ///< index into the list of distinct |dx|
    std::vector<std::size_t> voxel_rows;
};

/// Pairs of wall rows and voxel rows, grouped by |dx|.
struct RowPairs {
    std::vector<double> distances_m;
    std::vector<std::vector<Offset>> of_wall_row;
};

/// Groups the rows of a grid and rows of voxels at `x_m` by how far they lie apart along x.
RowPairs pair_rows(const WallGrid& grid, const std::vector<double>& x_m);

}  // namespace nlos
