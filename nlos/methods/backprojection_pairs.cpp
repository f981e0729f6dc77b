// SPDX-License-Identifier: MIT
#include "nlos/methods/backprojection.h"

#include <experimental/simd>

#include <algorithm>
#include <array>
#include <cstring>
#include <type_traits>

// Any scan. Voxels are taken in blocks: the distance of every voxel of a block to a wall point is
// computed once per point, so an exhaustive scan costs one addition and one look-up per pair.

namespace nlos {
namespace {

namespace stdx = std::experimental;

constexpr std::size_t kVoxelsPerBlock = 512;

/// Positions of one block's voxels, one array per coordinate for vector instructions.
template <class Real>
struct VoxelBlock {
    std::vector<Real> x, y, z;
    std::vector<Real> sums;

    VoxelBlock(const VolumeAxes& axes, std::size_t begin, std::size_t end) : sums(end - begin) {
        const std::size_t nz = axes.z_m.size();
        const std::size_t ny = axes.y_m.size();
        for (std::size_t i = begin; i < end; ++i) {
            x.push_back(static_cast<Real>(axes.x_m[i / (ny * nz)]));
            y.push_back(static_cast<Real>(axes.y_m[i / nz % ny]));
            z.push_back(static_cast<Real>(axes.z_m[i % nz]));
        }
    }
    std::size_t size() const { return sums.size(); }
};

/// One segment of the light's way to every voxel of a block.
template <class Real>
struct Segment {
    std::vector<Real> distances;  ///< to a wall point, plus an offset, in bins
    std::vector<Real> factors;    ///< make up for the light lost; empty: none
};

/// A wall point and what the path to it is longer by.
struct SegmentEnd {
    core::Vec3 point;
    double offset_m = 0.0;
};

template <class Real>
void fill_segment(const VoxelBlock<Real>& block,
                  const SegmentEnd& end,
                  double bin_width_m,
                  Compensation compensation,
                  Segment<Real>& segment) {
    const auto px = static_cast<Real>(end.point.x());
    const auto py = static_cast<Real>(end.point.y());
    const auto pz = static_cast<Real>(end.point.z());
    const auto per_bin = static_cast<Real>(1.0 / bin_width_m);
    const auto offset = static_cast<Real>(end.offset_m / bin_width_m);
    const std::size_t count = block.size();
    segment.distances.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Real dx = block.x[i] - px;
        const Real dy = block.y[i] - py;
        const Real dz = block.z[i] - pz;
        segment.distances[i] = std::sqrt(dx * dx + dy * dy + dz * dz) * per_bin + offset;
    }
    if (compensation == Compensation::None) return;
    segment.factors.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto distance = (segment.distances[i] - offset) * static_cast<Real>(bin_width_m);
        segment.factors[i] = compensation == Compensation::Diffuse ? distance * distance : distance;
    }
}

/// The histogram at a place between two bins.
///
/// padded   as of add_lookups()
template <class Real>
Real value_at(const Real* padded, Real position) {
    const auto bin = static_cast<int>(position);
    const Real late = position - static_cast<Real>(bin);
    return padded[bin] + late * (padded[bin + 1] - padded[bin]);
}

using FloatLanes = stdx::native_simd<float>;
using IntLanes = stdx::native_simd<int>;
using FloatVector [[gnu::vector_size(sizeof(FloatLanes))]] = float;
using IntVector [[gnu::vector_size(sizeof(FloatLanes))]] = int;
constexpr int kFloatLanes = FloatLanes::size();

/// How far behind a histogram read_neighbours() may read.
constexpr std::size_t kReadBehind = 2 * kFloatLanes;

/// FloatVector of two vectors, one behind the other.
FloatLanes pick(const FloatVector& low, const FloatVector& high, const IntVector& indices) {
#ifdef __clang__  // has this only for constant indices
    return FloatLanes([&](std::size_t lane) {
        const int i = indices[lane];
        return i < kFloatLanes ? low[i] : high[i - kFloatLanes];
    });
#else
    const FloatVector picked = __builtin_shuffle(low, high, indices);
    std::array<float, kFloatLanes> array;
    std::memcpy(array.data(), &picked, sizeof picked);
    return FloatLanes(array.data(), stdx::element_aligned);
#endif
}

/// padded[lower] and padded[lower + 1]. Voxels in a row find their values close together and in
/// order, mostly within two vectors, which one instruction searches; gathers take several times as
/// long.
std::array<FloatLanes, 2> read_neighbours(const float* padded, IntLanes lower) {
    const int first = lower[0];
    const IntLanes behind = lower - first;
    if (stdx::any_of(behind < 0 || behind > 2 * kFloatLanes - 2)) {
        return {FloatLanes([&](auto lane) { return padded[lower[lane]]; }),
                FloatLanes([&](auto lane) { return padded[lower[lane] + 1]; })};
    }
    IntVector indices;
    FloatVector low, high;
    std::memcpy(&indices, &behind, sizeof indices);
    std::memcpy(&low, padded + first, sizeof low);
    std::memcpy(&high, padded + first + kFloatLanes, sizeof high);
    return {pick(low, high, indices), pick(low, high, indices + 1)};
}

/// The leading part of add_lookups() that fills vectors.
///
/// returns   the number of voxels done
std::size_t add_rows_of_lookups(const float* padded,
                                float last,
                                const Segment<float>& out,
                                const Segment<float>& back,
                                VoxelBlock<float>& block) {
    constexpr auto kAnywhere = stdx::element_aligned;
    const bool has_factors = !out.factors.empty();
    std::size_t i = 0;
    for (; i + kFloatLanes <= block.size(); i += kFloatLanes) {
        FloatLanes position = FloatLanes(out.distances.data() + i, kAnywhere) +
                              FloatLanes(back.distances.data() + i, kAnywhere);
        position = stdx::clamp(position, FloatLanes(0.0F), FloatLanes(last));
        const auto lower = stdx::static_simd_cast<IntLanes>(position);
        const FloatLanes late = position - stdx::static_simd_cast<FloatLanes>(lower);
        const auto [here, next] = read_neighbours(padded, lower);
        FloatLanes term = here + late * (next - here);
        if (has_factors) {
            term *= FloatLanes(out.factors.data() + i, kAnywhere) *
                    FloatLanes(back.factors.data() + i, kAnywhere);
        }
        (FloatLanes(block.sums.data() + i, kAnywhere) + term)
            .copy_to(block.sums.data() + i, kAnywhere);
    }
    return i;
}

/// Adds interpolated histogram values at the sums of two segments (in bins, 1 = centre of bin 0).
///
/// padded   histogram with one zero before it, two behind it, and kReadBehind more
template <class Real>
void add_lookups(const Real* padded,
                 std::size_t num_bins,
                 const Segment<Real>& out,
                 const Segment<Real>& back,
                 VoxelBlock<Real>& block) {
    const auto last = static_cast<Real>(num_bins + 1);
    std::size_t i = 0;
    if constexpr (std::is_same_v<Real, float>) {
        constexpr bool kCanSearch = kFloatLanes >= 8;  // as of AVX2
        if (kCanSearch) i = add_rows_of_lookups(padded, last, out, back, block);
    }
    for (; i < block.size(); ++i) {
        const Real position = std::clamp(out.distances[i] + back.distances[i], Real{0}, last);
        const Real factor = out.factors.empty() ? Real{1} : out.factors[i] * back.factors[i];
        block.sums[i] += factor * value_at(padded, position);
    }
}

template <class Real>
class PairBackprojector {
 public:
    PairBackprojector(const PairList<Real>& data, const VolumeAxes& axes)
        : data_(data), axes_(axes), num_bins_(static_cast<std::size_t>(data.time_axis.num_bins)) {}

    void fill(std::size_t begin, std::size_t end, std::span<Real> volume) const {
        VoxelBlock<Real> block(axes_, begin, end);
        std::vector<Real> padded(num_bins_ + 3 + kReadBehind, Real{0});
        const bool is_confocal = data_.pattern == core::ScanPattern::Confocal;
        std::vector<Segment<Real>> out(is_confocal ? 1 : data_.illumination.size());
        for (std::size_t l = 0; l < out.size() && !is_confocal; ++l) {
            fill_illumination_segment(l, block, out[l]);
        }
        Segment<Real> back;
        const std::size_t num_sensing = data_.sensing.size();
        for (std::size_t s = 0; s < num_sensing; ++s) {
            fill_sensing_segment(s, block, back);
            if (is_confocal) {
                fill_illumination_segment(s, block, out[0]);
                add_pair(s, out[0], back, padded, block);
                continue;
            }
            for (std::size_t l = 0; l < out.size(); ++l) {
                add_pair(l * num_sensing + s, out[l], back, padded, block);
            }
        }
        for (std::size_t i = begin; i < end; ++i) volume[i] += block.sums[i - begin];
    }

 private:
    void fill_illumination_segment(std::size_t l,
                                   const VoxelBlock<Real>& block,
                                   Segment<Real>& segment) const {
        fill_segment(block,
                     {data_.illumination[l], data_.illumination_segments_m[l]},
                     data_.time_axis.bin_width_m,
                     data_.compensation,
                     segment);
    }

    /// Bin 0's centre stands half a bin behind the axis start and at 1 in a padded histogram.
    void fill_sensing_segment(std::size_t s,
                              const VoxelBlock<Real>& block,
                              Segment<Real>& segment) const {
        const double start = data_.time_axis.opl_start_m - 0.5 * data_.time_axis.bin_width_m;
        fill_segment(block,
                     {data_.sensing[s], data_.sensing_segments_m[s] - start},
                     data_.time_axis.bin_width_m,
                     data_.compensation,
                     segment);
    }

    void add_pair(std::size_t pair,
                  const Segment<Real>& out,
                  const Segment<Real>& back,
                  std::vector<Real>& padded,
                  VoxelBlock<Real>& block) const {
        std::copy_n(data_.histograms.data() + pair * num_bins_, num_bins_, padded.begin() + 1);
        add_lookups(padded.data(), num_bins_, out, back, block);
    }

    const PairList<Real>& data_;
    const VolumeAxes& axes_;
    std::size_t num_bins_;
};

}  // namespace

template <class Real>
void backproject_pairs(const PairList<Real>& data,
                       const VolumeAxes& axes,
                       std::span<Real> volume,
                       const core::Progress& progress) {
    const PairBackprojector<Real> backprojector(data, axes);
    const ProgressSpan span{progress, 0.0, 1.0, "backprojection"};
    parallel_blocks_with_progress(
        volume.size(), kVoxelsPerBlock, span, [&](std::size_t begin, std::size_t end) {
            backprojector.fill(begin, end, volume);
        });
}

template void backproject_pairs<float>(const PairList<float>&,
                                       const VolumeAxes&,
                                       std::span<float>,
                                       const core::Progress&);
template void backproject_pairs<double>(const PairList<double>&,
                                        const VolumeAxes&,
                                        std::span<double>,
                                        const core::Progress&);

}  // namespace nlos
