// SPDX-License-Identifier: MIT
// Directional light-cone transform [Young2020]: albedo and normals of the hidden surface. The light
// from a surface of normal n is taken as rho (n . d) / r^gamma, d pointing from the wall to the
// surface, which is linear in the field rho n: three convolutions, one per component, undone
// together by a Wiener filter. Surfaces whose light carries further cosines come out tilted.
//
// Settings: snr, and falloff, whose power is gamma. Slabs as in the light-cone transform. The
// volume is |rho n| per metre of depth, up to a common factor, 0 where it faces away from the wall,
// with a normal towards the wall for each column, at its brightest voxel.
#include "nlos/fourier/padded_plane.h"
#include "nlos/methods/light_cone.h"
#include "renderer/core/system/large_memory.h"

#include <cmath>

// With u = z^2, d = (x_p - x_s, y_p - y_s, z) and the light-cone transform's g(v):
//     g = K_x * f_x + K_y * f_y + K * f_z,   K_x = -dx K, K_y = -dy K, dx = x_s - x_p,
//     f_x = rho n_x / (2 sqrt u),  f_y alike,  f_z = rho n_z / 2.
// K_x is in metres where K is a number; f_x is multiplied and K_x divided by a typical depth so
// that the filter treats the components alike.

namespace nlos {
namespace {

constexpr int kNormalReach = 2;  // voxels on either side of the brightest that give the normal

/// Mean range of the data, each bin weighted by its light times range^power [m].
double typical_depth_m(const MethodInput& input, const Cone& cone, double power) {
    const ConeData data(input, cone, power);
    std::vector<float> row(cone.num_v());
    float* const first = row.data();
    double sum = 0.0;
    double moment = 0.0;
    for (std::size_t column = 0; column < cone.num_columns(); ++column) {
        data.fill(column, {&first, 1});
        for (std::size_t i = 0; i < row.size(); ++i) {
            const double light = std::max(0.0, static_cast<double>(row[i]));
            sum += light;
            moment += light * std::sqrt(0.5 * (cone.v_edges[i] + cone.v_edges[i + 1]));
        }
    }
    return sum > 0.0 ? moment / sum : std::sqrt(cone.v_edges.back());
}

/// The three components' spectra of one slab, stored [frequency][x][y] each.
struct Components {
    FftBuffer x, y, z;
};

class VectorFilter {
 public:
    VectorFilter(const Cone& cone, const WallGrid& grid, double depth_m, double snr)
        : cone_(cone),
          grid_(grid),
          kernel_(cone, grid),
          depth_m_(depth_m),
          snr_(snr),
          data_plane_({cone.nx, cone.ny}, {cone.px, cone.py}),
          kernel_plane_({cone.px, cone.py}, {cone.px, cone.py}) {}

    struct Workspace {
        PaddedPlane::Workspace data, x, y, z;
        ConeKernel::Spectrum kernel;
        FftBuffer quadrant;
    };
    /// For frequencies from k on.
    Workspace make_workspace(std::size_t k) const {
        return {data_plane_.make_workspace(),
                kernel_plane_.make_workspace(),
                kernel_plane_.make_workspace(),
                kernel_plane_.make_workspace(),
                {kernel_, k},
                FftBuffer(2 * kernel_.qx() * kernel_.qy())};
    }

    /// Turns the data at the workspace's next frequency, the n-th of `components.z`, into the three
    /// components.
    void apply(std::size_t n, Components& components, Workspace& work) const {
        fill_kernels(work);
        kernel_plane_.forward(work.x);
        kernel_plane_.forward(work.y);
        kernel_plane_.forward(work.z);
        const std::size_t offset = n * cone_.plane_stride();
        data_plane_.load(components.z.complex() + offset, work.data);
        data_plane_.forward(work.data);
        multiply_by_filters(work);
        store(work.x, components.x.complex() + offset);
        store(work.y, components.y.complex() + offset);
        store(work.z, components.z.complex() + offset);
    }

 private:
    /// K even in both offsets, K_x odd in dx, K_y odd in dy; an odd function is 0 half a period
    /// away, where both signs meet.
    void fill_kernels(Workspace& work) const {
        work.kernel.next(work.quadrant.complex());
        for (std::size_t ix = 0; ix < cone_.px; ++ix) {
            const std::size_t qx = std::min(ix, cone_.px - ix);
            const double dx = signed_offset(ix, cone_.px) * grid_.pitch_m[0] / depth_m_;
            for (std::size_t iy = 0; iy < cone_.py; ++iy) {
                const std::size_t qy = std::min(iy, cone_.py - iy);
                const double dy = signed_offset(iy, cone_.py) * grid_.pitch_m[1] / depth_m_;
                const ComplexF value = work.quadrant.complex()[qx * kernel_.qy() + qy];
                kernel_plane_.row(work.x, ix)[iy] = static_cast<float>(-dx) * value;
                kernel_plane_.row(work.y, ix)[iy] = static_cast<float>(-dy) * value;
                kernel_plane_.row(work.z, ix)[iy] = value;
            }
        }
    }

    static double signed_offset(std::size_t i, std::size_t period) {
        if (2 * i == period) return 0.0;
        return 2 * i < period ? static_cast<double>(i)
                              : static_cast<double>(i) - static_cast<double>(period);
    }

    /// conj(K_c) G / (|K_x|^2 + |K_y|^2 + |K|^2 + |K|_2^2 / snr), in place of the kernels.
    void multiply_by_filters(Workspace& work) const {
        const auto size = static_cast<double>(cone_.px * cone_.py * cone_.length);
        const auto scale = static_cast<float>(1.0 / size);
        const auto floor = static_cast<float>(kernel_.squared_norm() / snr_);
        for (std::size_t iy = 0; iy < cone_.py; ++iy) {
            const ComplexF* g = data_plane_.spectrum_row(work.data, iy);
            ComplexF* x = kernel_plane_.spectrum_row(work.x, iy);
            ComplexF* y = kernel_plane_.spectrum_row(work.y, iy);
            ComplexF* z = kernel_plane_.spectrum_row(work.z, iy);
            for (std::size_t ix = 0; ix < cone_.px; ++ix) {
                const float power = std::norm(x[ix]) + std::norm(y[ix]) + std::norm(z[ix]);
                const ComplexF factor = scale / (power + floor) * g[ix];
                x[ix] = multiply(std::conj(x[ix]), factor);
                y[ix] = multiply(std::conj(y[ix]), factor);
                z[ix] = multiply(std::conj(z[ix]), factor);
            }
        }
    }

    void store(PaddedPlane::Workspace& work, ComplexF* slab) const {
        data_plane_.inverse(work);
        data_plane_.store(work, slab);
    }

    const Cone& cone_;
    const WallGrid& grid_;
    ConeKernel kernel_;
    double depth_m_, snr_;
    PaddedPlane data_plane_, kernel_plane_;
};

/// Unit normal towards the wall from sums of rho n around the brightest voxel of a column.
///
/// One equation per frequency leaves two of three components to the filter, which takes the
/// smallest: they come out as conj(K_c), and where the light of a smooth surface is, at the wall
/// point d away that its normal points to, K_x / K = -dx / depth_m. So what the filter calls
/// n_x / n_z is (z / depth_m)^2 of the truth dx / z.
///
/// depth_m   the filter's typical depth
Eigen::Vector3f normal_at_peak(const float* albedo,
                               const std::array<const float*, 3>& field,
                               const std::vector<double>& z_m,
                               double depth_m) {
    const std::size_t num_z = z_m.size();
    const auto peak = std::max_element(albedo, albedo + num_z) - albedo;
    const auto last = static_cast<std::ptrdiff_t>(num_z) - 1;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (auto i = std::max<std::ptrdiff_t>(0, peak - kNormalReach);
         i <= std::min(last, peak + kNormalReach);
         ++i) {
        sum += Eigen::Vector3f(field[0][i], field[1][i], field[2][i]);
    }
    const auto stretch =
        static_cast<float>(std::pow(depth_m / z_m[static_cast<std::size_t>(peak)], 2));
    sum.x() *= stretch;
    sum.y() *= stretch;
    if (!(sum.z() > 0.0F)) return -Eigen::Vector3f::UnitZ();
    return -sum.normalized();
}

Volume directional_light_cone_transform(const MethodInput& input,
                                        const ReconstructSettings& settings,
                                        std::size_t num_slabs) {
    const Cone cone = make_cone(input, kSquaredRangeBinsPerBin);
    const double power = falloff_power(settings.falloff);
    const double depth_m = typical_depth_m(input, cone, power);
    const VectorFilter filter(cone, *input.wall.grid, depth_m, *settings.snr);
    // 2 z f_x z_0 / z_0 and 2 z f_z / z: both rho n, up to a common factor.
    std::vector<float> x = core::zeros(input.axes.num_voxels());
    std::vector<float> y = core::zeros(x.size());
    std::vector<float> z = core::zeros(x.size());
    Components components{make_slab_spectrum(cone, num_slabs),
                          make_slab_spectrum(cone, num_slabs),
                          make_slab_spectrum(cone, num_slabs)};
    for (const Slab& slab : split_into_slabs(cone.num_frequencies(), num_slabs)) {
        const core::Progress progress = slab.part_of(input.progress, cone.num_frequencies());
        fill_cone_spectrum(
            input, cone, power, slab, components.z, {progress, 0.0, 0.1, "time to depth"});
        parallel_blocks_with_progress(slab.size(),
                                      kSlabsPerBlock,
                                      {progress, 0.1, 0.8, "deconvolution"},
                                      [&](std::size_t begin, std::size_t end) {
                                          VectorFilter::Workspace work =
                                              filter.make_workspace(slab.begin + begin);
                                          for (std::size_t n = begin; n < end; ++n)
                                              filter.apply(n, components, work);
                                      });
        add_spectrum_to_depth(
            input, cone, components.x, slab, x, {progress, 0.8, 0.87, "to depth"});
        add_spectrum_to_depth(
            input, cone, components.y, slab, y, {progress, 0.87, 0.94, "to depth"});
        add_spectrum_to_depth(
            input, cone, components.z, slab, z, {progress, 0.94, 1.0, "to depth"});
    }

    const std::size_t num_z = input.axes.z_m.size();
    Volume volume{input.axes, core::zeros(z.size()), {}};
    volume.normals.resize(cone.num_columns());
    core::parallel_for(cone.num_columns(), [&](std::size_t column) {
        const std::size_t first = column * num_z;
        for (std::size_t iz = 0; iz < num_z; ++iz) {
            const std::size_t i = first + iz;
            x[i] /= static_cast<float>(depth_m);
            y[i] /= static_cast<float>(depth_m);
            z[i] /= static_cast<float>(input.axes.z_m[iz]);
            const float length = std::sqrt(x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
            volume.values[i] = z[i] > 0.0F ? length : 0.0F;
        }
        volume.normals[column] =
            normal_at_peak(volume.values.data() + first,
                           {x.data() + first, y.data() + first, z.data() + first},
                           input.axes.z_m,
                           depth_m);
    });
    return volume;
}

double directional_light_cone_transform_bytes(const MethodInput& input,
                                              const ReconstructSettings& /*settings*/,
                                              std::size_t num_slabs) {
    const Cone cone = make_cone(input, kSquaredRangeBinsPerBin);
    const auto columns = static_cast<double>(cone.num_columns());
    const auto padded = static_cast<double>(cone.px * complex_row_stride(cone.py));
    const double spectra =
        24.0 *
        static_cast<double>(largest_slab(cone.num_frequencies(), num_slabs) * cone.plane_stride());
    const double volumes = 16.0 * columns * static_cast<double>(input.axes.z_m.size());
    return spectra + volumes +
           (66.0 * padded + 128.0 * static_cast<double>(cone.length)) * core::thread_count();
}

/// Beside those of three components, each one's moment of every frequency's kernel.
LeastWork least_dlct_work(const MethodInput& input, const ReconstructSettings& /*settings*/) {
    LeastWork work = least_cone_work(input, 3);
    work.filled_planes = 3 * work.planes_forward;
    return work;
}

}  // namespace

const MethodTraits kDlct{.method = Method::Dlct,
                         .meaning = "directional light-cone transform: albedo and normals",
                         .captures = "confocal, planar grid; others by midpoints",
                         .run = directional_light_cone_transform,
                         .bytes = directional_light_cone_transform_bytes,
                         .errors = {{.model_fraction = 0.047,
                                     .noise_fraction = 0.48,
                                     .doubt = 5.5,
                                     .plateau = {0.0, 0.52, 5.0}},
                                    {}},
                         .needs = &kConfocalGrid,
                         .has_wiener_filter = true,
                         .least_work = least_dlct_work};

}  // namespace nlos
