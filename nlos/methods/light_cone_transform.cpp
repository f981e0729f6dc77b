// SPDX-License-Identifier: MIT
// Light-cone transform [OToole2018]: with v = (path length / 2)^2 a confocal scan of a plane is a
// convolution of the hidden albedo, undone by a Wiener filter in the frequency domain. Depths
// between voxel edges are kept by moving bin contents by overlap; cosines are not modelled;
// negative albedo is set to zero.
//
// Settings: falloff and snr. Slabs of frequencies; the transforms along time are repeated for each.
// The volume is the albedo per metre of depth, up to a common factor.
#include "nlos/fourier/even_transform.h"
#include "nlos/fourier/padded_plane.h"
#include "nlos/methods/light_cone.h"
#include "renderer/core/system/large_memory.h"

namespace nlos {
namespace {

/// Wiener deconvolution of one frequency along v: a lateral 2-D problem that fits in cache.
class SlabFilter {
 public:
    SlabFilter(const Cone& cone, const WallGrid& grid, double snr)
        : cone_(cone),
          kernel_(cone, grid),
          noise_over_signal_(1.0 / snr),
          plane_({cone.nx, cone.ny}, {cone.px, cone.py}),
          kernel_transform_(kernel_.qx(), kernel_.qy()) {}

    struct Workspace {
        PaddedPlane::Workspace slab;
        EvenTransform::Workspace period;
        ConeKernel::Spectrum kernel;
        std::vector<ComplexF> quadrant;
    };
    /// For frequencies from k on.
    Workspace make_workspace(std::size_t k) const {
        return {plane_.make_workspace(),
                kernel_transform_.make_workspace(),
                {kernel_, k},
                std::vector<ComplexF>(kernel_.qx() * kernel_.qy())};
    }

    /// Filters `slab` (nx, ny) in place, which is at the workspace's next frequency.
    void apply(ComplexF* slab, Workspace& work) const {
        work.kernel.next(work.quadrant.data());
        kernel_transform_.run(work.quadrant.data(), work.period);
        turn_into_wiener_filter(work.quadrant.data());
        plane_.load(slab, work.slab);
        plane_.forward(work.slab);
        plane_.multiply_by_quadrant(work.quadrant.data(), work.slab);
        plane_.inverse(work.slab);
        plane_.store(work.slab, slab);
    }

 private:
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

    const Cone& cone_;
    ConeKernel kernel_;
    double noise_over_signal_;
    PaddedPlane plane_;
    EvenTransform kernel_transform_;
};

Volume light_cone_transform(const MethodInput& input,
                            const ReconstructSettings& settings,
                            std::size_t num_slabs) {
    const Cone cone = make_cone(input, kSquaredRangeBinsPerBin);
    const double power = falloff_power(settings.falloff);
    const SlabFilter filter(cone, *input.wall.grid, *settings.snr);
    Volume volume{input.axes, core::zeros(input.axes.num_voxels()), {}};
    FftBuffer spectrum = make_slab_spectrum(cone, num_slabs);
    for (const Slab& slab : split_into_slabs(cone.num_frequencies(), num_slabs)) {
        const core::Progress progress = slab.part_of(input.progress, cone.num_frequencies());
        fill_cone_spectrum(
            input, cone, power, slab, spectrum, {progress, 0.0, 0.2, "time to depth"});
        parallel_blocks_with_progress(
            slab.size(),
            kSlabsPerBlock,
            {progress, 0.2, 0.8, "deconvolution"},
            [&](std::size_t begin, std::size_t end) {
                SlabFilter::Workspace work = filter.make_workspace(slab.begin + begin);
                for (std::size_t n = begin; n < end; ++n) {
                    filter.apply(spectrum.complex() + n * cone.plane_stride(), work);
                }
            });
        add_spectrum_to_depth(
            input, cone, spectrum, slab, volume.values, {progress, 0.8, 1.0, "to depth"});
    }
    for (float& value : volume.values) value = std::max(0.0F, value);
    return volume;
}

double light_cone_transform_bytes(const MethodInput& input,
                                  const ReconstructSettings& /*settings*/,
                                  std::size_t num_slabs) {
    const Cone cone = make_cone(input, kSquaredRangeBinsPerBin);
    const auto columns = static_cast<double>(cone.num_columns());
    const auto padded = static_cast<double>(cone.px * complex_row_stride(cone.py));
    const auto frequencies = static_cast<double>(largest_slab(cone.num_frequencies(), num_slabs));
    const double spectrum = 8.0 * frequencies * static_cast<double>(cone.plane_stride());
    const double volume = 4.0 * columns * static_cast<double>(input.axes.z_m.size());
    const double per_thread = 30.0 * padded + 128.0 * static_cast<double>(cone.length + 2);
    return spectrum + volume + per_thread * core::thread_count() + 16.0 * padded;
}

LeastWork least_lct_work(const MethodInput& input, const ReconstructSettings& /*settings*/) {
    return least_cone_work(input, 1);
}

}  // namespace

const MethodTraits kLct{.method = Method::Lct,
                        .meaning = "light-cone transform with a Wiener filter",
                        .captures = "confocal, planar grid; others by midpoints",
                        .run = light_cone_transform,
                        .bytes = light_cone_transform_bytes,
                        .errors = {{.model_fraction = 0.025,
                                    .noise_fraction = 0.34,
                                    .doubt = 16.0,
                                    .plateau = {0.0, 0.52, 5.0}},
                                   {}},
                        .needs = &kConfocalGrid,
                        .has_wiener_filter = true,
                        .gives_way_to_prior = true,
                        .least_work = least_lct_work};

}  // namespace nlos
