// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/fourier/even_transform.h"
#include "nlos/fourier/padded_plane.h"
#include "nlos/methods/method_input.h"
#include "nlos/methods/virtual_wave.h"

#include <array>
#include <cstddef>
#include <vector>

namespace nlos {

/// Illumination points in the wall's frame; confocal scans have none of their own.
std::vector<core::Vec3> illumination_of(const MethodInput& input);

/// Values of one frequency's lateral transform, padded by zeros to twice the grid.
std::size_t padded_size(const WallGrid& grid);

/// Propagation of a wave, or of a part of one, from a wall with a grid to planes of voxels whose
/// columns are the grid's points.
class PlanePropagator {
 public:
    /// Both must outlive the propagator.
    PlanePropagator(const MethodInput& input, const VirtualWave& wave);

    std::size_t num_columns() const { return grid_.size[0] * grid_.size[1]; }

    /// Transforms coefficients [frequency][pair of the capture] of one or more illumination points
    /// laterally, into [illumination][frequency][ky][kx].
    std::vector<ComplexF> spectra(const std::vector<ComplexF>& coefficients,
                                  std::size_t num_illumination) const;

    /// Adds the field at depth z from some illumination points to `field` [x][y].
    ///
    /// spectra        of spectra(), of these illumination points
    /// illumination   the first of them, and the one after the last
    void add_plane(double z,
                   const std::vector<ComplexF>& spectra,
                   std::array<std::size_t, 2> illumination,
                   std::vector<ComplexF>& field) const;

 private:
    bool is_confocal() const { return input_.scan.pattern == core::ScanPattern::Confocal; }
    std::size_t spectrum_size() const { return padded_[0] * padded_[1]; }

    /// From a wall point to a voxel, for all lateral offsets; confocal light goes there and back.
    std::vector<double> kernel_distances(double z) const;
    std::vector<double> illumination_distances(std::size_t l, double z) const;

    const MethodInput& input_;
    const WallGrid& grid_;
    const VirtualWave& wave_;
    std::array<std::size_t, 2> padded_;
    PaddedPlane plane_;
    EvenTransform kernel_transform_;
    std::vector<core::Vec3> illumination_;
};

}  // namespace nlos
