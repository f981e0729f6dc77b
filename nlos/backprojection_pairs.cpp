// SPDX-License-Identifier: MIT
#include "nlos/backprojection.h"

#include <algorithm>

// Any scan. Voxels are taken in blocks: the distance of every voxel of a block to a wall point is
// computed once per point, so an exhaustive scan costs one addition and one look-up per pair.

namespace nlos {
namespace {

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

/// Distances to a wall point plus `offset_m`, in bins.
template <class Real>
void fill_distances(const VoxelBlock<Real>& block,
                    const core::Vec3& point,
                    double offset_m,
                    double bin_width_m,
                    Real* distances) {
    const auto px = static_cast<Real>(point.x());
    const auto py = static_cast<Real>(point.y());
    const auto pz = static_cast<Real>(point.z());
    const auto per_bin = static_cast<Real>(1.0 / bin_width_m);
    const auto offset = static_cast<Real>(offset_m / bin_width_m);
    for (std::size_t i = 0; i < block.size(); ++i) {
        const Real dx = block.x[i] - px;
        const Real dy = block.y[i] - py;
        const Real dz = block.z[i] - pz;
        distances[i] = std::sqrt(dx * dx + dy * dy + dz * dz) * per_bin + offset;
    }
}

/// Adds interpolated histogram values at positions a + b (in bins, 1 = centre of bin 0).
///
/// padded   histogram with one zero before and two behind it
template <class Real>
void add_lookups(const Real* padded,
                 std::size_t num_bins,
                 const Real* __restrict a,
                 const Real* __restrict b,
                 VoxelBlock<Real>& block) {
    Real* __restrict sums = block.sums.data();
    const auto last = static_cast<Real>(num_bins + 1);
    const std::size_t count = block.size();
    for (std::size_t i = 0; i < count; ++i) {
        // Plain comparisons: std::min and std::max take references, which bars vector code here.
        Real position = a[i] + b[i];
        position = position > Real{0} ? position : Real{0};
        position = position < last ? position : last;
        const int bin = static_cast<int>(position);
        const Real late = position - static_cast<Real>(bin);
        sums[i] += padded[bin] + late * (padded[bin + 1] - padded[bin]);
    }
}

template <class Real>
class PairBackprojector {
 public:
    PairBackprojector(const PairList<Real>& data, const VolumeAxes& axes)
        : data_(data), axes_(axes), num_bins_(static_cast<std::size_t>(data.time_axis.num_bins)) {}

    void fill(std::size_t begin, std::size_t end, std::span<Real> volume) const {
        VoxelBlock<Real> block(axes_, begin, end);
        std::vector<Real> padded(num_bins_ + 3, Real{0});
        const std::vector<Real> illumination = illumination_distances(block);
        std::vector<Real> sensing(block.size());
        const std::size_t num_sensing = data_.sensing.size();
        for (std::size_t s = 0; s < num_sensing; ++s) {
            fill_distances(block,
                           data_.sensing[s],
                           data_.sensing_legs_m[s] - data_.time_axis.opl_start_m,
                           data_.time_axis.bin_width_m,
                           sensing.data());
            // Bin 0's centre stands half a bin behind the axis start and at 1 in `padded`.
            for (Real& distance : sensing) distance += Real{0.5};
            if (data_.pattern == core::ScanPattern::Confocal) {
                std::vector<Real> out(block.size());
                fill_distances(block,
                               data_.illumination[s],
                               data_.illumination_legs_m[s],
                               data_.time_axis.bin_width_m,
                               out.data());
                add_pair(s, out.data(), sensing.data(), padded, block);
                continue;
            }
            for (std::size_t l = 0; l < data_.illumination.size(); ++l) {
                add_pair(l * num_sensing + s,
                         illumination.data() + l * block.size(),
                         sensing.data(),
                         padded,
                         block);
            }
        }
        for (std::size_t i = begin; i < end; ++i) volume[i] += block.sums[i - begin];
    }

 private:
    std::vector<Real> illumination_distances(const VoxelBlock<Real>& block) const {
        std::vector<Real> distances;
        if (data_.pattern == core::ScanPattern::Confocal) return distances;
        distances.resize(data_.illumination.size() * block.size());
        for (std::size_t l = 0; l < data_.illumination.size(); ++l) {
            fill_distances(block,
                           data_.illumination[l],
                           data_.illumination_legs_m[l],
                           data_.time_axis.bin_width_m,
                           distances.data() + l * block.size());
        }
        return distances;
    }

    void add_pair(std::size_t pair,
                  const Real* a,
                  const Real* b,
                  std::vector<Real>& padded,
                  VoxelBlock<Real>& block) const {
        std::copy_n(data_.histograms.data() + pair * num_bins_, num_bins_, padded.begin() + 1);
        add_lookups(padded.data(), num_bins_, a, b, block);
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
