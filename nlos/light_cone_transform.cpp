// SPDX-License-Identifier: MIT
#include "nlos/light_cone_transform.h"

#include "nlos/conservative_resampling.h"
#include "nlos/fft.h"

#include <cmath>
#include <limits>
#include <vector>

namespace nlos {
namespace {

constexpr std::size_t kColumnsPerBlock = 16;
constexpr std::size_t kSlabsPerBlock = 8;

// Even bins of v = r^2 are 1 / (2 r) wide in r: as many as there are range bins would be coarser
// than those in the near half of the volume and pull depths there towards the wall.
constexpr std::size_t kSquaredRangeBinsPerBin = 2;

// std::complex multiplication checks for infinities unless told otherwise; these are finite.
ComplexF multiply(ComplexF a, ComplexF b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// Even bins of squared range, and the padded sizes of the transforms.
struct Cone {
    std::vector<double> v_edges;  ///< squared range [m^2]
    std::size_t nx = 0, ny = 0;   ///< wall points
    std::size_t px = 0, py = 0;   ///< padded to at least twice
    std::size_t length = 0;       ///< padded number of v bins
    bool is_same_for_all = true;  ///< device legs are the same for every pair
    double min_leg_m = 0.0, max_leg_m = 0.0;

    std::size_t num_v() const { return v_edges.size() - 1; }
    double v_width() const { return v_edges[1] - v_edges[0]; }
    std::size_t num_frequencies() const { return length / 2 + 1; }

    /// Distance of padded rows: not a power of two, which would crowd a column into few cache sets.
    std::size_t slab_stride() const { return py + 8; }
};

Cone make_cone(const MethodInput& input) {
    Cone cone;
    cone.min_leg_m = std::numeric_limits<double>::max();
    cone.max_leg_m = 0.0;
    for (std::size_t pair = 0; pair < input.scan.num_pairs(); ++pair) {
        const double leg = input.scan.device_legs_m(pair);
        cone.min_leg_m = std::min(cone.min_leg_m, leg);
        cone.max_leg_m = std::max(cone.max_leg_m, leg);
    }
    const core::TimeAxis& axis = input.time_axis;
    cone.is_same_for_all = cone.max_leg_m - cone.min_leg_m < 1e-6 * axis.bin_width_m;
    const double begin = std::max(0.0, 0.5 * (axis.opl_start_m - cone.max_leg_m));
    const double end = 0.5 * (axis.opl_end_m() - cone.min_leg_m);
    const double num_bins = std::ceil((end - begin) / (0.5 * axis.bin_width_m) - 1e-6);
    if (!(num_bins >= 4.0)) {
        throw core::Error("method",
                          "lct was given a time axis with fewer than 4 bins of positive range",
                          "method=bp works for any axis");
    }
    cone.v_edges = even_edges(
        begin * begin, end * end, kSquaredRangeBinsPerBin * static_cast<std::size_t>(num_bins));
    cone.nx = input.wall.grid->size[0];
    cone.ny = input.wall.grid->size[1];
    cone.px = 2 * good_fft_size(cone.nx);
    cone.py = 2 * good_fft_size(cone.ny);
    cone.length = 2 * good_fft_size(cone.num_v());
    return cone;
}

/// Histogram of path length -> g(v), the convolution's data: bins of range [r_k, r_k+1] moved to
/// bins of v = r^2, each multiplied by r^p; dr/dv is in the bins' widths.
ConservativeResampling path_length_to_squared_range(const core::TimeAxis& axis,
                                                    double leg_m,
                                                    const Cone& cone,
                                                    double power) {
    const auto num_bins = static_cast<std::size_t>(axis.num_bins);
    std::vector<double> edges(num_bins + 1);
    std::vector<double> scale(num_bins);
    double previous = 0.0;
    for (std::size_t k = 0; k <= num_bins; ++k) {
        const double range =
            std::max(0.0, 0.5 * (axis.bin_begin_m(static_cast<double>(k)) - leg_m));
        edges[k] = range * range;
        if (k > 0) scale[k - 1] = std::pow(0.5 * (previous + range), power);
        previous = range;
    }
    return {edges, cone.v_edges, scale};
}

/// f(u) -> rho(z): contents of the bins of u = z^2 moved to bins of z, per metre; this is
/// rho = 2 z f(z^2).
ConservativeResampling squared_range_to_depth(const MethodInput& input, const Cone& cone) {
    const std::size_t nz = input.axes.z_m.size();
    std::vector<double> z_edges = even_edges(input.z_range_m[0], input.z_range_m[1], nz);
    const double per_metre = 1.0 / (z_edges[1] - z_edges[0]);
    for (double& edge : z_edges) edge *= edge;
    return {cone.v_edges, z_edges, std::vector<double>(cone.num_v(), per_metre)};
}

/// The light cone delta(v - dx^2 - dy^2), split linearly between two v bins so that each (dx, dy)
/// sums to 1, one frequency along v at a time. It is even in dx and dy: a quadrant says it all.
class ConeKernel {
 public:
    ConeKernel(const Cone& cone, const WallGrid& grid)
        : qx_(cone.px / 2 + 1), qy_(cone.py / 2 + 1), length_(cone.length) {
        for (std::size_t ix = 0; ix < qx_; ++ix) {
            for (std::size_t iy = 0; iy < qy_; ++iy) {
                const double dx = static_cast<double>(ix) * grid.pitch_m[0];
                const double dy = static_cast<double>(iy) * grid.pitch_m[1];
                const double shift = (dx * dx + dy * dy) / cone.v_width();
                const bool is_inside = shift < static_cast<double>(cone.num_v() - 1);
                const double whole = std::floor(is_inside ? shift : 0.0);
                const double next = is_inside ? shift - whole : 0.0;
                const double here = is_inside ? 1.0 - next : 0.0;
                entries_.push_back({static_cast<std::size_t>(whole),
                                    static_cast<float>(here),
                                    static_cast<float>(next)});
                const double copies =
                    (ix == 0 || ix + 1 == qx_ ? 1.0 : 2.0) * (iy == 0 || iy + 1 == qy_ ? 1.0 : 2.0);
                squared_norm_ += copies * (here * here + next * next);
            }
        }
        for (std::size_t i = 0; i < length_; ++i) {
            const double angle =
                -2.0 * core::kPi * static_cast<double>(i) / static_cast<double>(length_);
            phases_.emplace_back(static_cast<float>(std::cos(angle)),
                                 static_cast<float>(std::sin(angle)));
        }
    }

    std::size_t qx() const { return qx_; }
    std::size_t qy() const { return qy_; }
    double squared_norm() const { return squared_norm_; }

    /// Writes the quadrant's transform along v at frequency k.
    void fill(std::size_t k, ComplexF* quadrant) const {
        const ComplexF step = phases_[k % length_];
        for (std::size_t i = 0; i < entries_.size(); ++i) {
            const Entry& e = entries_[i];
            const ComplexF split{e.here + e.next * step.real(), e.next * step.imag()};
            quadrant[i] = multiply(phases_[(e.shift * k) % length_], split);
        }
    }

 private:
    struct Entry {
        std::size_t shift;
        float here, next;
    };
    std::size_t qx_, qy_, length_;
    double squared_norm_ = 0.0;
    std::vector<Entry> entries_;
    std::vector<ComplexF> phases_;
};

/// Wiener deconvolution of one frequency along v: a lateral 2-D problem that fits in cache. Only
/// rows that hold data are transformed along y.
class SlabFilter {
 public:
    SlabFilter(const Cone& cone, const WallGrid& grid, double snr)
        : cone_(cone),
          kernel_(cone, grid),
          noise_over_signal_(1.0 / snr),
          rows_forward_(Fft::complex_batch({cone.py, cone.nx, 1, cone.slab_stride()}, kForward)),
          rows_inverse_(Fft::complex_batch({cone.py, cone.nx, 1, cone.slab_stride()}, kInverse)),
          columns_forward_(Fft::complex_batch({cone.px, cone.py, cone.slab_stride(), 1}, kForward)),
          columns_inverse_(Fft::complex_batch({cone.px, cone.py, cone.slab_stride(), 1}, kInverse)),
          kernel_transform_(Fft::even_2d(kernel_.qx(), kernel_.qy())) {}

    struct Workspace {
        FftBuffer slab;
        FftBuffer quadrant;
    };
    Workspace make_workspace() const {
        return {FftBuffer(2 * cone_.px * cone_.slab_stride()),
                FftBuffer(2 * kernel_.qx() * kernel_.qy())};
    }

    /// Filters frequency k in place.
    ///
    /// slab   (nx, ny)
    void apply(std::size_t k, ComplexF* slab, Workspace& work) const {
        kernel_.fill(k, work.quadrant.complex());
        kernel_transform_.run(work.quadrant);
        turn_into_wiener_filter(work.quadrant.complex());

        ComplexF* padded = work.slab.complex();
        const std::size_t stride = cone_.slab_stride();
        std::fill_n(padded, cone_.px * stride, ComplexF{});
        for (std::size_t ix = 0; ix < cone_.nx; ++ix) {
            std::copy_n(slab + ix * cone_.ny, cone_.ny, padded + ix * stride);
        }
        rows_forward_.run(work.slab);
        columns_forward_.run(work.slab);
        multiply_by_quadrant(work.quadrant.complex(), padded);
        columns_inverse_.run(work.slab);
        rows_inverse_.run(work.slab);
        for (std::size_t ix = 0; ix < cone_.nx; ++ix) {
            std::copy_n(padded + ix * stride, cone_.ny, slab + ix * cone_.ny);
        }
    }

 private:
    static constexpr Fft::Direction kForward = Fft::Direction::Forward;
    static constexpr Fft::Direction kInverse = Fft::Direction::Inverse;

    /// With the kernel K = |K| k, k of unit norm: conj(k) / (|k|^2 + 1/snr) / |K|, and the
    /// transforms' normalisation.
    void turn_into_wiener_filter(ComplexF* quadrant) const {
        const double norm = kernel_.squared_norm();
        const auto size = static_cast<double>(cone_.px * cone_.py * cone_.length);
        const auto scale = static_cast<float>(1.0 / (norm * size));
        const auto per_norm = static_cast<float>(1.0 / norm);
        const auto floor = static_cast<float>(noise_over_signal_);
        for (std::size_t i = 0; i < kernel_.qx() * kernel_.qy(); ++i) {
            const float re = quadrant[i].real();
            const float im = quadrant[i].imag();
            const float factor = scale / ((re * re + im * im) * per_norm + floor);
            quadrant[i] = {re * factor, -im * factor};
        }
    }

    void multiply_by_quadrant(const ComplexF* quadrant, ComplexF* padded) const {
        for (std::size_t ix = 0; ix < cone_.px; ++ix) {
            const ComplexF* filter = quadrant + std::min(ix, cone_.px - ix) * kernel_.qy();
            ComplexF* row = padded + ix * cone_.slab_stride();
            for (std::size_t iy = 0; iy < kernel_.qy(); ++iy) {
                row[iy] = multiply(row[iy], filter[iy]);
            }
            for (std::size_t iy = kernel_.qy(); iy < cone_.py; ++iy) {
                row[iy] = multiply(row[iy], filter[cone_.py - iy]);
            }
        }
    }

    const Cone& cone_;
    ConeKernel kernel_;
    double noise_over_signal_;
    Fft rows_forward_, rows_inverse_, columns_forward_, columns_inverse_, kernel_transform_;
};

/// Data of all wall points along v, transformed: stored [frequency][x][y].
void transform_columns(const MethodInput& input, const Cone& cone, double power, FftBuffer& out) {
    const std::size_t num_columns = cone.nx * cone.ny;
    const std::size_t row_floats = cone.length + 2;
    const Fft forward = Fft::real_to_complex(cone.length, kColumnsPerBlock);
    const ConservativeResampling common =
        path_length_to_squared_range(input.time_axis, cone.min_leg_m, cone, power);
    const ProgressSpan span{input.progress, 0.0, 0.2, "time to depth"};
    parallel_blocks_with_progress(
        num_columns, kColumnsPerBlock, span, [&](std::size_t begin, std::size_t end) {
            FftBuffer rows(kColumnsPerBlock * row_floats);
            for (std::size_t column = begin; column < end; ++column) {
                const std::size_t pair = input.wall.grid->point(column / cone.ny, column % cone.ny);
                const float* histogram = input.transient.histogram(pair).data();
                float* row = rows.data() + (column - begin) * row_floats;
                if (cone.is_same_for_all) {
                    common.apply(histogram, row);
                } else {
                    path_length_to_squared_range(
                        input.time_axis, input.scan.device_legs_m(pair), cone, power)
                        .apply(histogram, row);
                }
            }
            forward.run(rows);
            for (std::size_t k = 0; k < cone.num_frequencies(); ++k) {
                for (std::size_t column = begin; column < end; ++column) {
                    out.complex()[k * num_columns + column] =
                        rows.complex()[(column - begin) * (row_floats / 2) + k];
                }
            }
        });
}

/// Back from frequencies along v to voxels along z.
Volume fill_volume(const MethodInput& input, const Cone& cone, FftBuffer& spectrum) {
    const std::size_t num_columns = cone.nx * cone.ny;
    const std::size_t row_floats = cone.length + 2;
    const std::size_t nz = input.axes.z_m.size();
    const Fft inverse = Fft::complex_to_real(cone.length, kColumnsPerBlock);
    const ConservativeResampling to_depth = squared_range_to_depth(input, cone);
    Volume volume{input.axes, std::vector<float>(num_columns * nz), {}};
    const ProgressSpan span{input.progress, 0.8, 1.0, "to depth"};
    parallel_blocks_with_progress(
        num_columns, kColumnsPerBlock, span, [&](std::size_t begin, std::size_t end) {
            FftBuffer rows(kColumnsPerBlock * row_floats);
            for (std::size_t k = 0; k < cone.num_frequencies(); ++k) {
                for (std::size_t column = begin; column < end; ++column) {
                    rows.complex()[(column - begin) * (row_floats / 2) + k] =
                        spectrum.complex()[k * num_columns + column];
                }
            }
            inverse.run(rows);
            for (std::size_t column = begin; column < end; ++column) {
                float* voxels = volume.values.data() + column * nz;
                to_depth.apply(rows.data() + (column - begin) * row_floats, voxels);
                for (std::size_t iz = 0; iz < nz; ++iz) voxels[iz] = std::max(0.0F, voxels[iz]);
            }
        });
    return volume;
}

}  // namespace

Volume light_cone_transform(const MethodInput& input, Falloff falloff, double snr) {
    const Cone cone = make_cone(input);
    const double power = falloff == Falloff::Diffuse ? 4.0 : 2.0;
    const std::size_t num_columns = cone.nx * cone.ny;

    FftBuffer spectrum(2 * cone.num_frequencies() * num_columns);
    transform_columns(input, cone, power, spectrum);

    const SlabFilter filter(cone, *input.wall.grid, snr);
    const ProgressSpan span{input.progress, 0.2, 0.8, "deconvolution"};
    parallel_blocks_with_progress(
        cone.num_frequencies(), kSlabsPerBlock, span, [&](std::size_t begin, std::size_t end) {
            SlabFilter::Workspace work = filter.make_workspace();
            for (std::size_t k = begin; k < end; ++k) {
                filter.apply(k, spectrum.complex() + k * num_columns, work);
            }
        });
    return fill_volume(input, cone, spectrum);
}

double light_cone_transform_bytes(const MethodInput& input) {
    const Cone cone = make_cone(input);
    const auto columns = static_cast<double>(cone.nx * cone.ny);
    const auto padded = static_cast<double>(cone.px * cone.slab_stride());
    const double spectrum = 8.0 * static_cast<double>(cone.num_frequencies()) * columns;
    const double volume = 4.0 * columns * static_cast<double>(input.axes.z_m.size());
    const double per_thread =
        12.0 * padded + 4.0 * static_cast<double>(kColumnsPerBlock * (cone.length + 2));
    return spectrum + volume + per_thread * core::thread_count() + 16.0 * padded;
}

}  // namespace nlos
