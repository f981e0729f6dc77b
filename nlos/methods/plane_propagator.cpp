// SPDX-License-Identifier: MIT
#include "nlos/methods/plane_propagator.h"

#include "nlos/fourier/unit_phasor.h"

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

/// exp(2 pi i f d) of given distances for one frequency of a wave after the other.
class PhaseSeries {
 public:
    PhaseSeries(const std::vector<double>& distances_m, const VirtualWave& wave)
        : values_(distances_m.size()), steps_(distances_m.size()) {
        for (std::size_t i = 0; i < values_.size(); ++i) {
            const UnitPhasor first = unit_phasor(wave.first_frequency * distances_m[i]);
            const UnitPhasor step = unit_phasor(wave.frequency_step * distances_m[i]);
            values_[i] = {first.re, first.im};
            steps_[i] = {step.re, step.im};
        }
    }

    const std::vector<ComplexF>& values() const { return values_; }
    void advance() {
        for (std::size_t i = 0; i < values_.size(); ++i) {
            values_[i] = multiply(values_[i], steps_[i]);
        }
    }

 private:
    std::vector<ComplexF> values_;
    std::vector<ComplexF> steps_;
};

void add_product(const std::vector<ComplexF>& a,
                 const std::vector<ComplexF>& b,
                 std::vector<ComplexF>& sum) {
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += multiply(a[i], b[i]);
}

}  // namespace

std::vector<core::Vec3> illumination_of(const MethodInput& input) {
    if (input.scan.pattern == core::ScanPattern::Confocal) return {};
    return in_wall_frame(input, input.scan.illumination);
}

std::size_t padded_size(const WallGrid& grid) {
    return 4 * good_fft_size(grid.size[0]) * good_fft_size(grid.size[1]);
}

PlanePropagator::PlanePropagator(const MethodInput& input, const VirtualWave& wave)
    : input_(input),
      grid_(*input.wall.grid),
      wave_(wave),
      padded_{2 * good_fft_size(grid_.size[0]), 2 * good_fft_size(grid_.size[1])},
      plane_(grid_.size, padded_),
      kernel_transform_(padded_[0] / 2 + 1, padded_[1] / 2 + 1),
      illumination_(illumination_of(input)) {}

std::vector<ComplexF> PlanePropagator::spectra(const std::vector<ComplexF>& coefficients,
                                               std::size_t num_illumination) const {
    const std::size_t num_pairs = num_illumination * num_columns();
    std::vector<ComplexF> result(num_illumination * wave_.size() * spectrum_size());
    const auto scale = 1.0F / static_cast<float>(spectrum_size());  // of the transforms
    core::parallel_blocks(
        num_illumination * wave_.size(), 4, [&](std::size_t begin, std::size_t end) {
            PaddedPlane::Workspace work = plane_.make_workspace();
            std::vector<ComplexF> slab(num_columns());
            for (std::size_t i = begin; i < end; ++i) {
                const ComplexF* values = coefficients.data() + i % wave_.size() * num_pairs +
                                         i / wave_.size() * num_columns();
                for (std::size_t column = 0; column < slab.size(); ++column) {
                    slab[column] =
                        scale * values[grid_.point(column / grid_.size[1], column % grid_.size[1])];
                }
                plane_.load(slab.data(), work);
                plane_.forward(work);
                plane_.store_spectrum(work, result.data() + i * spectrum_size());
            }
        });
    return result;
}

void PlanePropagator::add_plane(double z,
                                const std::vector<ComplexF>& spectra,
                                std::array<std::size_t, 2> illumination,
                                std::vector<ComplexF>& field) const {
    PhaseSeries kernel(kernel_distances(z), wave_);
    std::vector<PhaseSeries> arriving;
    for (std::size_t l = illumination[0]; l < illumination[1] && !is_confocal(); ++l) {
        arriving.emplace_back(illumination_distances(l, z), wave_);
    }
    std::vector<ComplexF> quadrant;
    EvenTransform::Workspace period = kernel_transform_.make_workspace();
    PaddedPlane::Workspace work = plane_.make_workspace();
    std::vector<ComplexF> sum(is_confocal() ? spectrum_size() : 0);
    std::vector<ComplexF> slab(num_columns());
    for (std::size_t f = 0; f < wave_.size(); ++f) {
        quadrant = kernel.values();
        kernel_transform_.run(quadrant.data(), period);
        for (std::size_t l = 0; l < illumination[1] - illumination[0]; ++l) {
            plane_.load_spectrum(spectra.data() + (l * wave_.size() + f) * spectrum_size(), work);
            plane_.multiply_by_quadrant(quadrant.data(), work);
            if (is_confocal()) {
                plane_.add_spectrum(work, sum.data());
                continue;
            }
            plane_.inverse(work);
            plane_.store(work, slab.data());
            add_product(slab, arriving[l].values(), field);
            arriving[l].advance();
        }
        kernel.advance();
    }
    if (!is_confocal()) return;
    plane_.load_spectrum(sum.data(), work);
    plane_.inverse(work);
    plane_.store(work, slab.data());
    for (std::size_t i = 0; i < field.size(); ++i) field[i] += slab[i];
}

std::vector<double> PlanePropagator::kernel_distances(double z) const {
    std::vector<double> distances;
    for (std::size_t ix = 0; ix <= padded_[0] / 2; ++ix) {
        for (std::size_t iy = 0; iy <= padded_[1] / 2; ++iy) {
            const double dx = static_cast<double>(ix) * grid_.pitch_m[0];
            const double dy = static_cast<double>(iy) * grid_.pitch_m[1];
            distances.push_back((is_confocal() ? 2.0 : 1.0) * std::sqrt(dx * dx + dy * dy + z * z));
        }
    }
    return distances;
}

std::vector<double> PlanePropagator::illumination_distances(std::size_t l, double z) const {
    std::vector<double> distances;
    for (const double x : input_.axes.x_m) {
        for (const double y : input_.axes.y_m) {
            distances.push_back((core::Vec3(x, y, z) - illumination_[l]).norm());
        }
    }
    return distances;
}

}  // namespace nlos
