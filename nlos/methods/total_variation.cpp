// SPDX-License-Identifier: MIT
#include "nlos/methods/total_variation.h"

#include "nlos/fourier/padded_plane.h"
#include "nlos/methods/light_cone.h"

#include <cmath>

// All fields live on the padded period (px, py, length), x slowest, where convolution and
// differences are diagonal after a Fourier transform. What reaches the wall outside the scan was
// not measured and must be left free: taken as dark it would drive light into the volume's corners.
// So there are three splits, c = K f, d = grad f and w = f, with scaled multipliers p, u and q and
// penalties 1 and mu:
//     f <- (K'K + mu (grad'grad + 1))^-1 (K'(c - p) + mu (grad'(d - u) + w - q))
//     c <- (g + K f + p) / 2 where measured, else K f + p,     p <- p + K f - c
//     d <- shrink(grad f + u, tv / mu),                        u <- u + grad f - d
//     w <- max(0, f + q - l1 / mu) inside the footprint, else 0,   q <- q + f - w.

namespace nlos {
namespace {

// v bins per range bin; twice as many, as the plain transform has them, would double the work of
// every iteration.
constexpr std::size_t kIteratedBinsPerBin = 1;

constexpr double kSparsityShare = 0.1;  // of the weight, unless set

/// Real fields on the padded period and their transform, in one buffer of rows of length + 2.
struct Period {
    std::size_t px, py, length;

    explicit Period(const Cone& cone) : px(cone.px), py(cone.py), length(cone.length) {}
    std::size_t row_floats() const { return length + 2; }
    std::size_t num_rows() const { return px * py; }
    std::size_t num_floats() const { return num_rows() * row_floats(); }
    std::size_t num_values() const { return num_rows() * length; }
};

using Field = std::vector<float>;  // [x][y][v]; FFT rows have two more

class Solver {
 public:
    Solver(const MethodInput& input, const Cone& cone, double power, const TvSettings& settings)
        : input_(input),
          cone_(cone),
          period_(cone),
          settings_(settings),
          transform_(Fft::real_3d({period_.px, period_.py, period_.length}, Forward)),
          inverse_(Fft::real_3d({period_.px, period_.py, period_.length}, Inverse)),
          f_(period_.num_floats()),
          residual_(period_.num_floats()) {
        fill_kernel();
        fill_data(power);
        for (Field& u : u_) u.assign(period_.num_floats(), 0.0F);
        q_.assign(period_.num_floats(), 0.0F);
        weight_ = settings.weight ? *settings.weight : noise();
        sparsity_ = settings.sparsity ? *settings.sparsity : kSparsityShare * weight_;
        gradient_power_[0] = gradient_power(period_.px);
        gradient_power_[1] = gradient_power(period_.py);
        gradient_power_[2] = gradient_power(period_.length);
    }

    void run() {
        for (int i = 0; i < settings_.iterations; ++i) {
            check_stop(input_.progress);
            solve_for_f();
            if (i + 1 == settings_.iterations) break;
            update_data_split();
            update_splits();
            input_.progress.update(0.95 * (i + 1) / settings_.iterations, "prior");
        }
    }

    /// Turns results back into the data's unit.
    float unit() const { return largest_; }

    /// f inside the footprint, not negative: column (ix, iy), num_v() values.
    const float* column(std::size_t ix, std::size_t iy) { return row(f_.data(), ix, iy); }

 private:
    static constexpr Fft::Direction Forward = Fft::Direction::Forward;
    static constexpr Fft::Direction Inverse = Fft::Direction::Inverse;

    template <class Value>
    Value* row(Value* field, std::size_t ix, std::size_t iy) const {
        return field + (ix * period_.py + iy) * period_.row_floats();
    }

    /// |grad|^2 of forward differences along one axis, per frequency.
    static std::vector<float> gradient_power(std::size_t period) {
        std::vector<float> power(period);
        for (std::size_t k = 0; k < period; ++k) {
            const double angle =
                2.0 * core::kPi * static_cast<double>(k) / static_cast<double>(period);
            power[k] = static_cast<float>(2.0 - 2.0 * std::cos(angle));
        }
        return power;
    }

    /// Transforms the kernel of unit norm into kernel_.
    void fill_kernel() {
        const ConeKernel kernel(cone_, *input_.wall.grid);
        const auto scale = static_cast<float>(1.0 / std::sqrt(kernel.squared_norm()));
        for (std::size_t ix = 0; ix < period_.px; ++ix) {
            for (std::size_t iy = 0; iy < period_.py; ++iy) {
                const ConeEntry& entry =
                    kernel.entry(std::min(ix, period_.px - ix), std::min(iy, period_.py - iy));
                float* values = row(f_.data(), ix, iy);
                values[entry.shift] += scale * entry.here;
                values[entry.shift + 1] += scale * entry.next;
            }
        }
        transform_.run(f_);
        kernel_.assign(f_.complex(), f_.complex() + period_.num_floats() / 2);
        std::fill_n(f_.data(), period_.num_floats(), 0.0F);
    }

    /// The data, scaled to a maximum of 1; c - p starts with them.
    void fill_data(double power) {
        const ConeData data(input_, cone_, power);
        data_.resize(cone_.num_columns() * cone_.num_v());
        for (std::size_t column = 0; column < cone_.num_columns(); ++column) {
            data.fill(column, data_.data() + column * cone_.num_v());
            observed_.push_back(data.observed(column));
        }
        largest_ = std::max(0.0F, *std::max_element(data_.begin(), data_.end()));
        for (float& value : data_) value = largest_ > 0.0F ? value / largest_ : 0.0F;
        multiplier_.assign(data_.size(), 0.0F);
        for (std::size_t column = 0; column < cone_.num_columns(); ++column) {
            std::copy_n(data_.data() + column * cone_.num_v(),
                        cone_.num_v(),
                        row(residual_.data(), column / cone_.ny, column % cone_.ny));
        }
    }

    /// Standard deviation of the data, from second differences of neighbours along y.
    double noise() const {
        if (cone_.ny < 3) return 0.0;
        double sum = 0.0;
        double count = 0.0;
        for (std::size_t ix = 0; ix < cone_.nx; ++ix) {
            for (std::size_t iy = 0; iy + 2 < cone_.ny; ++iy) {
                const std::size_t column = ix * cone_.ny + iy;
                const float* a = data_.data() + column * cone_.num_v();
                const float* b = a + cone_.num_v();
                const float* c = b + cone_.num_v();
                const core::BinRange seen =
                    core::intersection(core::intersection(observed_[column], observed_[column + 1]),
                                       observed_[column + 2]);
                for (int v = seen.begin; v < seen.end; ++v) {
                    const double difference = static_cast<double>(a[v] - 2.0F * b[v] + c[v]);
                    sum += difference * difference / 6.0;
                }
                count += seen.size();
            }
        }
        return count > 0.0 ? std::sqrt(sum / count) : 0.0;
    }

    /// Updates c and p from K f in residual_, and leaves c - p there.
    void update_data_split() {
        core::parallel_for(cone_.num_columns(), [&](std::size_t column) {
            float* values = row(residual_.data(), column / cone_.ny, column % cone_.ny);
            const std::size_t first = column * cone_.num_v();
            const auto [begin, end] = observed_[column];
            for (std::size_t v = 0; v < cone_.num_v(); ++v) {
                const float e = values[v] + multiplier_[first + v];
                // Where nobody looked, no datum pulls.
                const bool is_seen = static_cast<int>(v) >= begin && static_cast<int>(v) < end;
                const float c = is_seen ? 0.5F * (data_[first + v] + e) : e;
                multiplier_[first + v] = e - c;
                values[v] = 2.0F * c - e;
            }
        });
    }

    /// From the right-hand side's splits in f_ and residual_ to f and K f.
    void solve_for_f() {
        transform_.run(f_);
        transform_.run(residual_);
        const auto mu = static_cast<float>(settings_.penalty);
        const auto scale = 1.0F / static_cast<float>(period_.num_values());
        const std::size_t num_k = period_.row_floats() / 2;
        core::parallel_for(period_.px, [&](std::size_t ix) {
            for (std::size_t iy = 0; iy < period_.py; ++iy) {
                const std::size_t first = (ix * period_.py + iy) * num_k;
                const float lateral = gradient_power_[0][ix] + gradient_power_[1][iy] + 1.0F;
                ComplexF* f = f_.complex() + first;
                ComplexF* residual = residual_.complex() + first;
                for (std::size_t k = 0; k < num_k; ++k) {
                    const ComplexF kernel = kernel_[first + k];
                    const float weight = std::norm(kernel) + mu * (lateral + gradient_power_[2][k]);
                    f[k] = scale / weight * (multiply(std::conj(kernel), residual[k]) + mu * f[k]);
                    residual[k] = multiply(kernel, f[k]);
                }
            }
        });
        inverse_.run(f_);
        inverse_.run(residual_);
    }

    /// Updates d, u, w and q from f and leaves grad'(d - u) + w - q in f_.
    void update_splits() {
        split_.resize(period_.num_floats());
        const std::size_t length = period_.length;
        for (Field& b : b_) b.resize(period_.num_floats());
        const auto tv = static_cast<float>(weight_ / settings_.penalty);
        const auto l1 = static_cast<float>(sparsity_ / settings_.penalty);
        core::parallel_for(period_.num_rows(), [&](std::size_t i) {
            const std::size_t ix = i / period_.py;
            const std::size_t iy = i % period_.py;
            const std::size_t at = i * period_.row_floats();
            const float* here = f_.data() + at;
            const float* next_x = row(f_.data(), (ix + 1) % period_.px, iy);
            const float* next_y = row(f_.data(), ix, (iy + 1) % period_.py);
            for (std::size_t v = 0; v < length; ++v) {
                const float next_v = here[v + 1 < length ? v + 1 : 0];
                const float ex = next_x[v] - here[v] + u_[0][at + v];
                const float ey = next_y[v] - here[v] + u_[1][at + v];
                const float ez = next_v - here[v] + u_[2][at + v];
                const float norm = std::sqrt(ex * ex + ey * ey + ez * ez);
                const float keep = norm > tv ? 1.0F - tv / norm : 0.0F;
                u_[0][at + v] = (1.0F - keep) * ex;  // e - d, the new multiplier
                u_[1][at + v] = (1.0F - keep) * ey;
                u_[2][at + v] = (1.0F - keep) * ez;
                b_[0][at + v] = (2.0F * keep - 1.0F) * ex;  // d - u
                b_[1][at + v] = (2.0F * keep - 1.0F) * ey;
                b_[2][at + v] = (2.0F * keep - 1.0F) * ez;
            }
            const bool is_inside = ix < cone_.nx && iy < cone_.ny;
            for (std::size_t v = 0; v < length; ++v) {
                const float e = here[v] + q_[at + v];
                const float w = is_inside && v < cone_.num_v() ? std::max(0.0F, e - l1) : 0.0F;
                q_[at + v] = e - w;
                split_[at + v] = 2.0F * w - e;  // w - q
            }
        });
        core::parallel_for(period_.num_rows(), [&](std::size_t i) {
            const std::size_t ix = i / period_.py;
            const std::size_t iy = i % period_.py;
            const std::size_t at = i * period_.row_floats();
            const float* before_x = row(b_[0].data(), (ix + period_.px - 1) % period_.px, iy);
            const float* before_y = row(b_[1].data(), ix, (iy + period_.py - 1) % period_.py);
            for (std::size_t v = 0; v < length; ++v) {
                const float before_v = b_[2][at + (v > 0 ? v - 1 : length - 1)];
                f_.data()[at + v] = split_[at + v] + before_x[v] - b_[0][at + v] + before_y[v] -
                                    b_[1][at + v] + before_v - b_[2][at + v];
            }
        });
    }

    const MethodInput& input_;
    const Cone& cone_;
    Period period_;
    const TvSettings& settings_;
    double weight_ = 0.0, sparsity_ = 0.0;
    float largest_ = 0.0F;  ///< of the data before they were scaled
    Fft transform_, inverse_;
    FftBuffer f_, residual_;
    std::vector<ComplexF> kernel_;
    Field data_, multiplier_;               ///< g and p, inside the footprint only
    std::vector<core::BinRange> observed_;  ///< of g, per column
    Field q_, split_;
    std::array<Field, 3> u_, b_;
    std::array<std::vector<float>, 3> gradient_power_;
};

}  // namespace

Volume total_variation_light_cone_transform(const MethodInput& input,
                                            const ReconstructSettings& settings,
                                            std::size_t /*num_slabs*/) {
    const Cone cone = make_cone(input, kIteratedBinsPerBin);
    Solver solver(input, cone, falloff_power(settings.falloff), settings.tv);
    solver.run();
    const ConservativeResampling to_depth = squared_range_to_depth(input, cone);
    const std::size_t num_z = input.axes.z_m.size();
    Volume volume{input.axes, std::vector<float>(cone.num_columns() * num_z), {}};
    core::parallel_for(cone.num_columns(), [&](std::size_t column) {
        float* voxels = volume.values.data() + column * num_z;
        to_depth.apply(solver.column(column / cone.ny, column % cone.ny), voxels);
        for (std::size_t iz = 0; iz < num_z; ++iz) {
            voxels[iz] = solver.unit() * std::max(0.0F, voxels[iz]);
        }
    });
    input.progress.update(1.0, "to depth");
    return volume;
}

double total_variation_bytes(const MethodInput& input,
                             const ReconstructSettings& /*settings*/,
                             std::size_t /*num_slabs*/) {
    const Cone cone = make_cone(input, kIteratedBinsPerBin);
    const double period = static_cast<double>(cone.px * cone.py * (cone.length + 2));
    // f, K f, the kernel, three u, three d - u, q and w - q; data and multiplier are an eighth
    // each.
    return 4.0 * 11.5 * period + 4.0 * static_cast<double>(input.axes.num_voxels());
}

}  // namespace nlos
