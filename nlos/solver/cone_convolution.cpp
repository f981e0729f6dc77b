// SPDX-License-Identifier: MIT
#include "nlos/solver/cone_convolution.h"

#include "nlos/fourier/even_transform.h"
#include "renderer/core/system/parallel.h"

#include <cmath>

namespace nlos {
namespace {

constexpr std::size_t kRowsPerBatch = 32;  // wall points whose rows are transformed together

/// |grad|^2 of forward differences along one axis, per frequency.
std::vector<float> difference_power(std::size_t period) {
    std::vector<float> power(period);
    for (std::size_t k = 0; k < period; ++k) {
        const double angle = 2.0 * core::kPi * static_cast<double>(k) / static_cast<double>(period);
        power[k] = static_cast<float>(2.0 - 2.0 * std::cos(angle));
    }
    return power;
}

/// Transform of a normal distribution over wall points, at frequency k of a period.
double spot_factor(std::size_t k, std::size_t period, double fwhm_m, double pitch_m) {
    const double sigma = fwhm_m / std::sqrt(8.0 * std::log(2.0)) / pitch_m;
    const double angle = 2.0 * core::kPi * static_cast<double>(k) / static_cast<double>(period);
    return std::exp(-0.5 * std::pow(sigma * angle, 2));
}

}  // namespace

ConeConvolution::ConeConvolution(
    const Cone& cone, const WallGrid& grid, double spot_m, double mu, double nu, bool is_confined)
    : cone_(cone),
      mu_(static_cast<float>(mu)),
      nu_(static_cast<float>(nu)),
      is_confined_(is_confined),
      plane_({cone.nx, cone.ny}, {cone.px, cone.py}),
      forward_(Fft::real_to_complex(cone.length, kRowsPerBatch)),
      inverse_(Fft::complex_to_real(cone.length, kRowsPerBatch)),
      qx_(cone.px / 2 + 1),
      qy_(cone.py / 2 + 1),
      gradient_power_{
          difference_power(cone.px), difference_power(cone.py), difference_power(cone.length)} {
    const ConeKernel kernel(cone, grid);
    const EvenTransform transform(qx_, qy_);
    const double scale = 1.0 / std::sqrt(kernel.squared_norm());
    kernel_.resize(cone.num_frequencies() * qx_ * qy_);
    std::vector<float> factor(qx_ * qy_);
    for (std::size_t iy = 0; iy < qy_; ++iy) {
        for (std::size_t ix = 0; ix < qx_; ++ix) {
            factor[iy * qx_ + ix] =
                static_cast<float>(scale * spot_factor(ix, cone.px, spot_m, grid.pitch_m[0]) *
                                   spot_factor(iy, cone.py, spot_m, grid.pitch_m[1]));
        }
    }
    core::parallel_blocks(
        cone.num_frequencies(), kSlabsPerBlock, [&](std::size_t begin, std::size_t end) {
            EvenTransform::Workspace work = transform.make_workspace();
            ConeKernel::Spectrum spectrum(kernel, begin);
            for (std::size_t k = begin; k < end; ++k) {
                ComplexF* own = kernel_.data() + k * qx_ * qy_;
                spectrum.next(own);
                transform.run(own, work);
                for (std::size_t i = 0; i < qx_ * qy_; ++i) own[i] *= factor[i];
            }
        });
    first_.resize(cone.num_frequencies() * cone.plane_stride());
}

PlaneRows ConeConvolution::rows_of(FftBuffer& rows,
                                   std::size_t count,
                                   Planes& planes,
                                   std::size_t first_column) const {
    return {rows.complex(),
            Fft::row_floats(cone_.length) / 2,
            count,
            planes.data() + first_column,
            cone_.plane_stride(),
            cone_.num_frequencies()};
}

void ConeConvolution::to_frequencies(const ConeField& field, Planes& planes) const {
    const std::size_t row_floats = Fft::row_floats(cone_.length);
    const std::size_t num_v = cone_.num_v();
    core::parallel_for(cone_.nx, [&](std::size_t ix) {
        FftBuffer rows(kRowsPerBatch * row_floats);
        FftBuffer spectra(rows.num_floats());
        const float* plane = field.data() + ix * num_v * cone_.ny;
        for (std::size_t first = 0; first < cone_.ny; first += kRowsPerBatch) {
            const std::size_t lanes = std::min(kRowsPerBatch, cone_.ny - first);
            std::fill_n(rows.data(), rows.num_floats(), 0.0F);
            for (std::size_t v = 0; v < num_v; ++v) {
                for (std::size_t lane = 0; lane < lanes; ++lane) {
                    rows.data()[lane * row_floats + v] = plane[v * cone_.ny + first + lane];
                }
            }
            forward_.run(rows, spectra);
            rows_of(spectra, lanes, planes, ix * cone_.ny + first).copy_to_planes();
        }
    });
}

void ConeConvolution::from_frequencies(Planes& planes, ConeField& field) const {
    const std::size_t row_floats = Fft::row_floats(cone_.length);
    const std::size_t num_v = cone_.num_v();
    const float scale = 1.0F / static_cast<float>(cone_.px * cone_.py * cone_.length);
    core::parallel_for(cone_.nx, [&](std::size_t ix) {
        FftBuffer rows(kRowsPerBatch * row_floats);
        FftBuffer spectra(rows.num_floats());
        float* plane = field.data() + ix * num_v * cone_.ny;
        for (std::size_t first = 0; first < cone_.ny; first += kRowsPerBatch) {
            const std::size_t lanes = std::min(kRowsPerBatch, cone_.ny - first);
            rows_of(spectra, lanes, planes, ix * cone_.ny + first).copy_to_rows();
            inverse_.run(spectra, rows);
            for (std::size_t v = 0; v < num_v; ++v) {
                for (std::size_t lane = 0; lane < lanes; ++lane) {
                    plane[v * cone_.ny + first + lane] = scale * rows.data()[lane * row_floats + v];
                }
            }
        }
    });
}

void ConeConvolution::convolve(const ConeField& field, ConeField& result, bool is_adjoint) {
    to_frequencies(field, first_);
    core::parallel_blocks(
        cone_.num_frequencies(), kSlabsPerBlock, [&](std::size_t begin, std::size_t end) {
            PaddedPlane::Workspace work = plane_.make_workspace();
            std::vector<ComplexF> quadrant(qx_ * qy_);
            for (std::size_t k = begin; k < end; ++k) {
                std::copy_n(kernel_.data() + k * qx_ * qy_, qx_ * qy_, quadrant.begin());
                if (is_adjoint) {
                    for (ComplexF& value : quadrant) value = std::conj(value);
                }
                ComplexF* values = first_.data() + k * cone_.plane_stride();
                plane_.load(values, work);
                plane_.forward(work);
                plane_.multiply_by_quadrant(quadrant.data(), work);
                plane_.inverse(work);
                plane_.store(work, values);
            }
        });
    from_frequencies(first_, result);
}

void ConeConvolution::forward(const ConeField& field, ConeField& result) {
    convolve(field, result, false);
}

void ConeConvolution::adjoint(const ConeField& field, ConeField& result) {
    convolve(field, result, true);
}

void ConeConvolution::solve_plane(std::size_t k,
                                  PaddedPlane::Workspace& difference,
                                  PaddedPlane::Workspace& right) {
    const ComplexF* kernel = kernel_.data() + k * qx_ * qy_;
    ComplexF* solution = solution_.data() + k * cone_.px * cone_.py;
    const ComplexF* outside = is_confined_ ? outside_.data() + k * cone_.px * cone_.py : nullptr;
    for (std::size_t iy = 0; iy < cone_.py; ++iy) {
        const ComplexF* quadrant = kernel + std::min(iy, cone_.py - iy) * qx_;
        const float base = nu_ + mu_ * (gradient_power_[1][iy] + gradient_power_[2][k]);
        ComplexF* d = plane_.spectrum_row(difference, iy);
        ComplexF* b = plane_.spectrum_row(right, iy);
        ComplexF* f = solution + iy * cone_.px;
        for (std::size_t ix = 0; is_confined_ && ix < cone_.px; ++ix) {
            b[ix] -= nu_ * outside[iy * cone_.px + ix];
        }
        for (std::size_t ix = 0; ix < cone_.px; ++ix) {
            const ComplexF h = quadrant[std::min(ix, cone_.px - ix)];
            const float power = h.real() * h.real() + h.imag() * h.imag();
            const float weight = 1.0F / (power + base + mu_ * gradient_power_[0][ix]);
            f[ix] = weight * (power * f[ix] + multiply(std::conj(h), d[ix]) + b[ix]);
            d[ix] = multiply(h, f[ix]);
            b[ix] = f[ix];
        }
    }
}

void ConeConvolution::sum_outside(std::size_t k,
                                  const ComplexF* inside,
                                  PaddedPlane::Workspace& work) {
    plane_.load(inside, work);
    plane_.forward(work);
    const float scale = 1.0F / static_cast<float>(cone_.px * cone_.py);
    for (std::size_t iy = 0; iy < cone_.py; ++iy) {
        const std::size_t first = (k * cone_.py + iy) * cone_.px;
        const ComplexF* row = plane_.spectrum_row(work, iy);
        for (std::size_t ix = 0; ix < cone_.px; ++ix) {
            outside_[first + ix] += solution_[first + ix] - scale * row[ix];
        }
    }
}

void ConeConvolution::solve(ConeField& difference, ConeField& right) {
    if (solution_.empty()) {
        second_.resize(first_.size());
        solution_.resize(cone_.num_frequencies() * cone_.px * cone_.py);
        if (is_confined_) outside_.resize(solution_.size());
    }
    to_frequencies(difference, first_);
    to_frequencies(right, second_);
    core::parallel_blocks(
        cone_.num_frequencies(), kSlabsPerBlock, [&](std::size_t begin, std::size_t end) {
            PaddedPlane::Workspace a = plane_.make_workspace();
            PaddedPlane::Workspace b = plane_.make_workspace();
            for (std::size_t k = begin; k < end; ++k) {
                ComplexF* difference_plane = first_.data() + k * cone_.plane_stride();
                ComplexF* right_plane = second_.data() + k * cone_.plane_stride();
                plane_.load(difference_plane, a);
                plane_.load(right_plane, b);
                plane_.forward(a);
                plane_.forward(b);
                solve_plane(k, a, b);
                plane_.inverse(a);
                plane_.inverse(b);
                plane_.store(a, difference_plane);
                plane_.store(b, right_plane);
                if (is_confined_) sum_outside(k, right_plane, b);
            }
        });
    from_frequencies(first_, difference);
    from_frequencies(second_, right);
}

double ConeConvolution::bytes(const Cone& cone, double num_fields, bool is_confined) {
    const double frequencies = static_cast<double>(cone.num_frequencies());
    const double columns = static_cast<double>(cone.num_columns());
    const double padded = static_cast<double>(cone.px * cone.py);
    const double quadrant = static_cast<double>((cone.px / 2 + 1) * (cone.py / 2 + 1));
    return 8.0 * frequencies *
               ((is_confined ? 2.0 : 1.0) * padded + quadrant +
                2.0 * static_cast<double>(cone.plane_stride())) +
           4.0 * num_fields * columns * static_cast<double>(cone.num_v());
}

}  // namespace nlos
