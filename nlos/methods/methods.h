// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/preparation/prepared_capture.h"
#include "nlos/reconstruction/reconstruct_settings.h"

#include <cstddef>
#include <optional>
#include <string>

namespace nlos {

/// A reconstruction method.
///
/// settings    with what the method takes from them filled in
/// num_slabs   of its work, done one after another: the result is the same up to rounding, memory
///             shrinks, and a part of the work is repeated for each
/// throws      core::Failure when asked to stop
using RunMethod = Volume(const MethodInput& input,
                         const ReconstructSettings& settings,
                         std::size_t num_slabs);

/// Memory that a method takes on top of its input, its volume included [bytes].
using MethodBytes = double(const MethodInput& input,
                           const ReconstructSettings& settings,
                           std::size_t num_slabs);

/// Light-cone transform: with v = (path length / 2)^2 a confocal scan of a plane is a convolution
/// of the hidden albedo, undone by a Wiener filter in the frequency domain.
///
/// Depths between voxel edges are kept by moving bin contents by overlap; cosines are not modelled;
/// negative albedo is set to zero.
///
/// input      confocal scan with input.wall.grid; x and y of input.axes at the grid's points
/// settings   falloff and snr, which must be set
/// slabs      of frequencies; the transforms along time are repeated for each
/// returns    albedo per metre of depth, up to a common factor
/// source     [OToole2018]
RunMethod light_cone_transform;
MethodBytes light_cone_transform_bytes;

/// Directional light-cone transform: albedo and normals of the hidden surface. The light from a
/// surface of normal n is taken as rho (n . d) / r^gamma, d pointing from the wall to the surface,
/// which is linear in the field rho n: three convolutions, one per component, undone together by a
/// Wiener filter. Surfaces whose light carries further cosines come out tilted.
///
/// input      as light_cone_transform()
/// settings   snr, which must be set, and falloff, whose power is gamma
/// slabs      as light_cone_transform()
/// returns    |rho n| per metre of depth, up to a common factor, 0 where it faces away from the
///            wall; a normal towards the wall for each column, at its brightest voxel
/// source     [Young2020]
RunMethod directional_light_cone_transform;
MethodBytes directional_light_cone_transform_bytes;

/// f-k migration: a confocal scan of a plane is the wave field, at the plane, of a wave that starts
/// everywhere on the hidden surface at once and travels with one metre of range per metre. Its
/// spectrum is moved from (kx, ky, f) to (kx, ky, kz) with f^2 = kx^2 + ky^2 + kz^2, which gives
/// the field at the start.
///
/// That wave, of amplitude f at the start, is d/dr (r M) at range r, M being the mean of f over the
/// sphere of that radius. What is measured is the sum of f / r^4 over the sphere on diffuse
/// surfaces and of f / r^2 on retroreflecting ones: times r^3 or r, and derived along range, it is
/// the wave. [Lindell2019] takes the root of what is measured for it. But light of several surfaces
/// adds up, its root does not, so that they blur each other's depths; and without the derivative a
/// haze of low frequencies lies about them.
///
/// input      as light_cone_transform()
/// settings   falloff
/// slabs      of |kx|; each repeats the lateral transforms
/// returns    the field up to a common factor, 0 where it is negative. Its magnitude, often shown
///            instead, is an envelope along z: wider, and its peaks lie farther from the surface
/// source     [Lindell2019]
RunMethod fk_migration;
MethodBytes fk_migration_bytes;

/// Backprojection: v(p) = sum over pairs (l, s) of H(l, s; |l - p| + |p - s|), linear in time
/// between bin centres. Adjoint of a forward model without cosines, and without falloff unless each
/// term is multiplied by what the light lost on its way. Where some bins were not observed, sums
/// are divided by the share of their terms that was, see divide_by_observed_share().
///
/// input      any scan; confocal grids whose y positions share a lattice with the voxels' take the
///            fast way (shifted additions of whole rows), all others the general one
/// settings   compensation, the factor of each term: none, r_l^2 r_s^2 (diffuse), r_l r_s (retro)
/// slabs      of the wall's rows, which the fast way copies
/// returns    sums in the histograms' unit
/// source     [Velten2012]
RunMethod backproject;
MethodBytes backproject_bytes;

/// Backprojection sharpened by the negative Laplacian of a Gaussian of 1 voxel, cut to 5 voxels
/// along each axis. Linear in the histograms; surfaces are positive with negative surroundings.
///
/// settings   compensation
/// slabs      as backproject()
/// source     [Velten2012]
RunMethod laplacian_backprojection;
MethodBytes laplacian_backprojection_bytes;

/// Magnitude of the backprojection of histograms convolved with the phasor field's virtual wave,
/// and divided by the observed share as in backproject().
///
/// settings   phasor; its wavelength_m must be set
/// slabs      as backproject()
/// source     [Liu2019]
RunMethod phasor_backprojection;
MethodBytes phasor_backprojection_bytes;

/// Phasor field: the relay wall as the lens of a camera for a virtual wave that illuminates the
/// hidden scene from the illumination points. The field at a voxel is
///
///     sum over pairs of (H * wave)(|l - p| + |p - s|),
///
/// the wave focused at the moment it reaches the voxel. On planar sensing grids it is propagated
/// frequency by frequency with the Rayleigh-Sommerfeld kernel by FFT from plane to plane, a group
/// of planes at a time: how many frequencies that takes grows with the span of their path lengths.
/// Amplitude factors of the propagation are left out.
///
/// input      any scan
/// settings   phasor; its wavelength_m must be set
/// slabs      of the frequencies that are propagated
/// returns    magnitude of the field
/// source     [Liu2019], [Liu2020]
RunMethod phasor_field;
MethodBytes phasor_field_bytes;

/// How much phasor_field() transforms laterally on a planar grid, per illumination point.
struct PhasorTransforms {
    std::size_t wall = 0;              ///< frequencies at the wall
    std::size_t planes = 0;            ///< frequencies at planes of voxels
    std::size_t most_frequencies = 0;  ///< that serve one plane
};

PhasorTransforms phasor_transforms(const MethodInput& input, const PhasorSettings& settings);

/// A method and why it was taken.
struct MethodChoice {
    Method method = Method::Bp;
    std::string reason;
};

/// Chooses the method for `auto`, or checks that the one set can serve. Single and exhaustive
/// measurements are converted in place when a confocal method was asked for.
///
/// throws   core::Error when the method set cannot serve; names one that can
MethodChoice choose_method(const ReconstructSettings& settings, PreparedCapture& prepared);

/// What a method that works by transforms makes of bins that were not observed, for people; nothing
/// for other methods, which leave them out.
///
/// settings   whose method is chosen
/// num_bins   of a histogram
std::optional<std::string> unobserved_warning(const ReconstructSettings& settings,
                                              const core::ObservedBins& observed,
                                              int num_bins);

/// Says of a scan of few pairs of points that it tells distances rather than directions; nothing of
/// others.
std::optional<std::string> few_pairs_warning(const core::WallScan& scan);

}  // namespace nlos
