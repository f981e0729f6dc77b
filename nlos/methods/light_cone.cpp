// SPDX-License-Identifier: MIT
#include "nlos/methods/light_cone.h"

#include "nlos/fourier/padded_plane.h"
#include "nlos/fourier/plane_rows.h"

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

constexpr std::size_t kColumnsPerBlock = 16;

/// Histogram of path length -> g(v), the convolution's data: bins of range [r_k, r_k+1] moved to
/// bins of v = r^2, each multiplied by r^p; dr/dv is in the bins' widths.
ConservativeResampling path_length_to_squared_range(const core::TimeAxis& axis,
                                                    double segment_m,
                                                    const Cone& cone,
                                                    double power) {
    const auto num_bins = static_cast<std::size_t>(axis.num_bins);
    std::vector<double> edges(num_bins + 1);
    std::vector<double> scale(num_bins);
    double previous = 0.0;
    for (std::size_t k = 0; k <= num_bins; ++k) {
        const double range =
            std::max(0.0, 0.5 * (axis.bin_begin_m(static_cast<double>(k)) - segment_m));
        edges[k] = range * range;
        if (k > 0) scale[k - 1] = std::pow(0.5 * (previous + range), power);
        previous = range;
    }
    return {edges, cone.v_edges, scale};
}

/// Rows along v of columns [begin, end), and where they stand in a slab's spectrum.
PlaneRows spectrum_rows(FftBuffer& rows,
                        const Cone& cone,
                        std::size_t begin,
                        std::size_t end,
                        FftBuffer& spectrum,
                        const Slab& slab) {
    return {rows.complex() + slab.begin,
            Fft::row_floats(cone.length) / 2,
            end - begin,
            spectrum.complex() + begin,
            cone.plane_stride(),
            slab.size()};
}

/// Where `count` rows begin.
template <typename Float>
std::vector<Float*> starts(Float* first, std::size_t stride, std::size_t count) {
    std::vector<Float*> rows;
    for (std::size_t i = 0; i < count; ++i) rows.push_back(first + i * stride);
    return rows;
}

}  // namespace

Cone make_cone(const MethodInput& input, double bins_per_bin) {
    Cone cone;
    const auto [shortest_segment, longest_segment] = core::device_segment_range_m(input.scan);
    cone.min_segment_m = shortest_segment;
    const core::TimeAxis& axis = input.time_axis;
    cone.is_same_for_all = longest_segment - shortest_segment < 1e-6 * axis.bin_width_m;
    // With what was cut off because nobody looked there: on the transform's period and bins depends
    // the background that it leaves, and on where it begins what can be told before the gate.
    const double start_m = axis.opl_start_m - input.unobserved_before_m;
    const double begin = std::max(0.0, 0.5 * (start_m - longest_segment));
    double end = 0.5 * (axis.opl_end_m() - shortest_segment);
    // Empty bins behind the light say that nothing is there; they change nothing before.
    const double lit_end = 0.5 * (input.dark_from_m - shortest_segment);
    if (lit_end - begin >= 0.5 * kMinBins * axis.bin_width_m) end = std::min(end, lit_end);
    const double num_bins = std::ceil((end - begin) / (0.5 * axis.bin_width_m) - 1e-6);
    if (!(num_bins >= 4.0)) {
        throw core::Error("method",
                          "lct was given a time axis with fewer than 4 bins of positive range",
                          "method=bp works for any axis");
    }
    cone.v_edges = even_edges(
        begin * begin, end * end, static_cast<std::size_t>(std::ceil(bins_per_bin * num_bins)));
    cone.nx = input.wall.grid->size[0];
    cone.ny = input.wall.grid->size[1];
    cone.px = 2 * good_fft_size(cone.nx);
    cone.py = 2 * good_fft_size(cone.ny);
    cone.length = cone_period(cone, *input.wall.grid);
    return cone;
}

std::size_t cone_period(const Cone& cone, const WallGrid& grid) {
    const double farthest = std::pow(0.5 * grid.pitch_m[0] * static_cast<double>(cone.px), 2) +
                            std::pow(0.5 * grid.pitch_m[1] * static_cast<double>(cone.py), 2);
    const auto num_v = static_cast<double>(cone.num_v());
    const double reach = std::min(num_v, std::ceil(farthest / cone.v_width()) + 2.0);
    return 2 * good_fft_size(static_cast<std::size_t>(std::ceil(0.5 * (num_v + reach))));
}

ConeData::ConeData(const MethodInput& input, const Cone& cone, double power)
    : input_(input),
      cone_(cone),
      power_(power),
      common_(path_length_to_squared_range(input.time_axis, cone.min_segment_m, cone, power)) {}

std::size_t ConeData::pair_of(std::size_t column) const {
    return input_.wall.grid->point(column / cone_.ny, column % cone_.ny);
}

void ConeData::fill(std::size_t first_column, std::span<float* const> rows) const {
    std::vector<const float*> histograms;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        histograms.push_back(input_.transient.histogram(pair_of(first_column + i)).data());
    }
    if (cone_.is_same_for_all) {
        common_.apply(histograms, rows);
        return;
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const double segment_m = input_.scan.device_segments_m(pair_of(first_column + i));
        path_length_to_squared_range(input_.time_axis, segment_m, cone_, power_)
            .apply(histograms[i], rows[i]);
    }
}

core::BinRange ConeData::observed(std::size_t column) const {
    const int num_v = static_cast<int>(cone_.num_v());
    const core::TimeAxis& axis = input_.time_axis;
    const std::size_t pair = pair_of(column);
    const core::BinRange range =
        input_.observed ? (*input_.observed)[pair] : core::BinRange{0, axis.num_bins};
    const bool begins_late = range.begin > 0 || input_.unobserved_before_m > 0.0;
    // Where on the v axis a bin of the histogram begins; an end of what was measured is an end of
    // v.
    const auto edge = [&](int bin) {
        const double length_m = axis.bin_begin_m(bin) - input_.scan.device_segments_m(pair);
        return std::pow(std::max(0.0, 0.5 * length_m), 2);
    };
    const auto index = [&](auto found) { return static_cast<int>(found - cone_.v_edges.begin()); };
    const auto& edges = cone_.v_edges;
    core::BinRange seen{0, num_v};
    if (begins_late) seen.begin = index(std::ranges::lower_bound(edges, edge(range.begin)));
    if (range.end < axis.num_bins) {
        seen.end = index(std::ranges::upper_bound(edges, edge(range.end))) - 1;
    }
    return range.size() > 0 ? core::intersection(seen, {0, num_v}) : core::BinRange{};
}

ConservativeResampling squared_range_to_depth(const MethodInput& input,
                                              const Cone& cone,
                                              BinSpread spread) {
    const std::size_t nz = input.axes.z_m.size();
    std::vector<double> z_edges = even_edges(input.z_range_m[0], input.z_range_m[1], nz);
    const double per_metre = 1.0 / (z_edges[1] - z_edges[0]);
    for (double& edge : z_edges) edge *= edge;
    return {cone.v_edges, z_edges, std::vector<double>(cone.num_v(), per_metre), spread};
}

ConeKernel::ConeKernel(const Cone& cone, const WallGrid& grid)
    : qx_(cone.px / 2 + 1), qy_(cone.py / 2 + 1) {
    for (std::size_t ix = 0; ix < qx_; ++ix) {
        for (std::size_t iy = 0; iy < qy_; ++iy) {
            const double dx = static_cast<double>(ix) * grid.pitch_m[0];
            const double dy = static_cast<double>(iy) * grid.pitch_m[1];
            const double shift = (dx * dx + dy * dy) / cone.v_width();
            const bool is_inside = shift < static_cast<double>(cone.num_v() - 1);
            const double whole = std::floor(is_inside ? shift : 0.0);
            const double next = is_inside ? shift - whole : 0.0;
            const double here = is_inside ? 1.0 - next : 0.0;
            shift_.push_back(static_cast<std::uint32_t>(whole));
            here_.push_back(static_cast<float>(here));
            next_.push_back(static_cast<float>(next));
            const double copies =
                (ix == 0 || ix + 1 == qx_ ? 1.0 : 2.0) * (iy == 0 || iy + 1 == qy_ ? 1.0 : 2.0);
            squared_norm_ += copies * (here * here + next * next);
        }
    }
    for (std::size_t i = 0; i < cone.length; ++i) {
        const double angle =
            -2.0 * core::kPi * static_cast<double>(i) / static_cast<double>(cone.length);
        phases_.emplace_back(static_cast<float>(std::cos(angle)),
                             static_cast<float>(std::sin(angle)));
    }
}

ConeKernel::Spectrum::Spectrum(const ConeKernel& kernel, std::size_t k) : kernel_(kernel), k_(k) {
    for (const std::size_t shift : kernel.shift_) {
        phase_indices_.push_back(static_cast<std::uint32_t>(shift * k % kernel.phases_.size()));
    }
}

void ConeKernel::Spectrum::next(ComplexF* quadrant) {
    const std::size_t size = phase_indices_.size();
    const ComplexF* const phases = kernel_.phases_.data();
    const float* const here = kernel_.here_.data();
    const float* const next = kernel_.next_.data();
    const std::uint32_t* const shift = kernel_.shift_.data();
    std::uint32_t* const phase_indices = phase_indices_.data();
    const auto period = static_cast<std::uint32_t>(kernel_.phases_.size());
    const ComplexF step = phases[k_++ % period];
    for (std::size_t i = 0; i < size; ++i) {
        const ComplexF split{here[i] + next[i] * step.real(), next[i] * step.imag()};
        quadrant[i] = multiply(phases[phase_indices[i]], split);
    }
    for (std::size_t i = 0; i < size; ++i) {
        const std::uint32_t phase_index = phase_indices[i] + shift[i];
        phase_indices[i] =
            std::min(phase_index, phase_index - period);  // below a period, the difference is huge
    }
}

FftBuffer make_slab_spectrum(const Cone& cone, std::size_t num_slabs) {
    return FftBuffer(2 * largest_slab(cone.num_frequencies(), num_slabs) * cone.plane_stride());
}

void fill_cone_spectrum(const MethodInput& input,
                        const Cone& cone,
                        double power,
                        const Slab& slab,
                        FftBuffer& spectrum,
                        const ProgressSpan& span) {
    const std::size_t num_columns = cone.num_columns();
    const std::size_t row_floats = Fft::row_floats(cone.length);
    const Fft forward = Fft::real_to_complex(cone.length, kColumnsPerBlock);
    const ConeData data(input, cone, power);
    parallel_blocks_with_progress(
        num_columns, kColumnsPerBlock, span, [&](std::size_t begin, std::size_t end) {
            FftBuffer rows(kColumnsPerBlock * row_floats);
            FftBuffer spectra(rows.num_floats());
            data.fill(begin, starts(rows.data(), row_floats, end - begin));
            forward.run(rows, spectra);
            spectrum_rows(spectra, cone, begin, end, spectrum, slab).copy_to_planes();
        });
}

void add_spectrum_to_depth(const MethodInput& input,
                           const Cone& cone,
                           FftBuffer& spectrum,
                           const Slab& slab,
                           std::vector<float>& values,
                           const ProgressSpan& span) {
    const std::size_t num_columns = cone.num_columns();
    const std::size_t row_floats = Fft::row_floats(cone.length);
    const std::size_t nz = input.axes.z_m.size();
    const Fft inverse = Fft::complex_to_real(cone.length, kColumnsPerBlock);
    const ConservativeResampling to_depth = squared_range_to_depth(input, cone, BinSpread::Even);
    parallel_blocks_with_progress(
        num_columns, kColumnsPerBlock, span, [&](std::size_t begin, std::size_t end) {
            FftBuffer spectra(kColumnsPerBlock * row_floats);
            FftBuffer rows(spectra.num_floats());
            spectrum_rows(spectra, cone, begin, end, spectrum, slab).copy_to_rows();
            inverse.run(spectra, rows);
            std::vector<float> contributions((end - begin) * nz);
            const auto inputs = starts<const float>(rows.data(), row_floats, end - begin);
            to_depth.apply(inputs, starts(contributions.data(), nz, end - begin));
            float* voxels = values.data() + begin * nz;
            for (std::size_t i = 0; i < contributions.size(); ++i) voxels[i] += contributions[i];
        });
}

LeastWork least_cone_work(const MethodInput& input, std::size_t components) {
    const Cone cone = make_cone(input, kSquaredRangeBinsPerBin);
    LeastWork work;
    work.row_length = cone.length;
    work.rows_forward = cone.num_columns();
    work.rows_inverse = components * cone.num_columns();
    work.planes_forward = cone.num_frequencies();
    work.planes_inverse = components * cone.num_frequencies();
    work.even_planes = cone.num_frequencies();
    return work;
}

}  // namespace nlos
