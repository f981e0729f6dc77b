// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/fourier/padded_plane.h"
#include "nlos/fourier/plane_rows.h"
#include "nlos/methods/light_cone.h"

#include <array>
#include <span>
#include <vector>

namespace nlos {

/// A field over wall points and bins of squared range, stored [x][v][y].
using ConeField = std::vector<float>;

/// The light-cone convolution K of unit norm on the wall's footprint, blurred along the wall by the
/// laser's spot, its exact adjoint, and the linear systems of a solver:
///
///     (K'K + mu grad'grad + nu) f = K'c + b
///
/// for fields f that may reach beyond the footprint, with differences between neighbouring voxels
/// and b = 0 out there; or b = -nu times the sum of all earlier f out there, which drives f to 0
/// beside the footprint. All are diagonal after a Fourier transform over the padded period.
class ConeConvolution {
 public:
    /// spot_m        full width at half maximum of the illuminated and observed spot [m]
    /// mu, nu        see above
    /// is_confined   whether f is driven to 0 beside the footprint
    ConeConvolution(const Cone& cone,
                    const WallGrid& grid,
                    double spot_m,
                    double mu,
                    double nu,
                    bool is_confined = false);

    std::size_t num_values() const { return cone_.num_columns() * cone_.num_v(); }

    void forward(const ConeField& field, ConeField& result);
    void adjoint(const ConeField& field, ConeField& result);

    /// One solution of the system after another. c is given as its difference, inside the
    /// footprint, from K times the last solution, with which it agrees outside: there nothing was
    /// measured. Starts from f = 0.
    ///
    /// difference   in: c - K f of the last solution; out: K f of the new one
    /// right        in: b; out: f inside the footprint
    void solve(ConeField& difference, ConeField& right);

    /// Bytes that it takes, with `num_fields` more fields over the footprint.
    static double bytes(const Cone& cone, double num_fields, bool is_confined);

 private:
    using Planes = std::vector<ComplexF>;  ///< [frequency along v][x][y]

    /// Rows along v of some columns, and where they stand in planes.
    PlaneRows rows_of(FftBuffer& rows,
                      std::size_t count,
                      Planes& planes,
                      std::size_t first_column) const;
    void to_frequencies(const ConeField& field, Planes& planes) const;
    void from_frequencies(Planes& planes, ConeField& field) const;
    void convolve(const ConeField& field, ConeField& result, bool is_adjoint);
    void solve_plane(std::size_t k, PaddedPlane::Workspace& a, PaddedPlane::Workspace& b);
    /// Adds the solution beside the footprint to outside_; `inside` has its values on it.
    void sum_outside(std::size_t k, const ComplexF* inside, PaddedPlane::Workspace& work);

    Cone cone_;
    float mu_, nu_;
    bool is_confined_;
    PaddedPlane plane_;
    Fft forward_, inverse_;
    std::size_t qx_, qy_;
    std::vector<ComplexF> kernel_;  ///< quadrants, [frequency along v][ky][kx]
    std::array<std::vector<float>, 3> gradient_power_;
    Planes first_, second_;
    Planes solution_;  ///< the last one's spectrum, [frequency along v][ky][kx], padded
    Planes outside_;   ///< likewise, of the sum of all solutions beside the footprint
};

}  // namespace nlos
