// SPDX-License-Identifier: MIT
#include "nlos/solver/confocal_solver.h"

#include "nlos/solver/cone_convolution.h"
#include "nlos/solver/confocal_problem.h"
#include "nlos/solver/pair_gains.h"
#include "nlos/solver/proximal.h"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

// Splits c = K f, h = B c, d = grad f and w = f, with scaled multipliers p, r, u and q and the
// penalties 1, P (the data's precision, per bin), mu and nu. Given the others, f and h are
// independent of each other, and so are c, d and w:
//     f <- (K'K + mu grad'grad + nu)^-1 (K'(c - p) + mu grad'(d - u) + nu (w - q))
//     h <- what each bin's likelihood makes of B c - r, or that where nobody looked
//     c <- (1 + B'P B)^-1 (K f + p + B'P (h + r)),    p <- p + K f - c,    r <- r + h - B c
//     d <- shrink(grad f + u, tv / mu),               u <- u + grad f - d
//     w <- max(0, f + q - sparsity / nu),             q <- q + f - w.
// each of f and h taken beyond where they moved from their splits (over-relaxation). Outside the
// wall's footprint nothing was measured: there c - p = K f, and d, u, w and q are 0. Where points
// have gains g of their own, light of h counts g h + background.

namespace nlos {
namespace {

// They change speed, hardly the result, but what light from outside the footprint costs.
constexpr double kGradientPenalty = 1.0;  // mu
constexpr double kAlbedoPenalty = 10.0;   // nu
constexpr float kRelaxation = 1.7F;       // of f and h away from their splits
constexpr int kGainInterval = 5;          // iterations from one update of gains to the next

// Weights of total variation, unless set. What radiance leaves unexplained is the model's error,
// much alike at neighbouring points, where counts have noise of their own.
constexpr double kPoissonWeight = 1.0;
constexpr double kGaussianWeight = 4.0;
constexpr double kSparsityShare = 0.1;  // of the weight of total variation, unless set

/// What the noise of light at v makes of a voxel at u, in units of its standard deviation: the
/// root of its mean square over the wall points that see the voxel.
std::vector<double> voxel_noise(const ConfocalProblem& data, const WallGrid& grid) {
    const ConeKernel kernel(data.cone, grid);
    const std::size_t num_v = data.cone.num_v();
    std::vector<double> share(num_v + 1, 0.0);  // of K's square, per shift from u to v
    for (std::size_t ix = 0; ix < kernel.qx(); ++ix) {
        for (std::size_t iy = 0; iy < kernel.qy(); ++iy) {
            const ConeEntry& entry = kernel.entry(ix, iy);
            share[entry.shift] += std::pow(static_cast<double>(entry.here), 2);
            share[entry.shift + 1] += std::pow(static_cast<double>(entry.next), 2);
        }
    }
    const std::vector<double> light = data.time.normal_diagonal(data.precision);
    std::vector<double> noise(num_v);
    for (std::size_t u = 0; u < num_v; ++u) {
        double sum = 0.0;
        double weights = 0.0;
        for (std::size_t shift = 0; u + shift < num_v; ++shift) {
            sum += share[shift] * light[u + shift];
            weights += share[shift];
        }
        noise[u] = weights > 0.0 ? std::sqrt(sum / weights) : 0.0;
    }
    return noise;
}

class ConfocalSolver {
 public:
    ConfocalSolver(const MethodInput& input,
                   const ConfocalProblem& data,
                   const SolverSettings& settings)
        : data_(data),
          cone_(data.cone),
          tolerance_(settings.tolerance),
          time_(data.time),
          convolution_(cone_, *input.wall.grid, settings.spot_m, kGradientPenalty, kAlbedoPenalty),
          num_bins_(static_cast<std::size_t>(data.axis.num_bins)),
          has_gains_(settings.gains),
          gains_(cone_.num_columns()),
          right_(convolution_.num_values()),
          light_(right_.size()),
          c_(right_.size()),
          p_(right_.size()),
          q_(right_.size()),
          w_(right_.size()),
          r_(data.values.size()) {
        time_.factorize(data.precision);
        for (ConeField& u : u_) u.resize(right_.size());
        for (ConeField& b : b_) b.resize(right_.size());
        const double tv = settings.tv.value_or(
            data.likelihood == Likelihood::Poisson ? kPoissonWeight : kGaussianWeight);
        const double sparsity = settings.sparsity.value_or(kSparsityShare * tv);
        for (const double noise : voxel_noise(data, *input.wall.grid)) {
            tv_.push_back(static_cast<float>(tv * noise / kGradientPenalty));
            sparsity_.push_back(static_cast<float>(sparsity * noise / kAlbedoPenalty));
        }
    }

    /// Returns the number of iterations.
    int run(const core::Progress& progress, int max_iterations) {
        split_data(true);
        for (int i = 1; i <= max_iterations; ++i) {
            check_stop(progress);
            convolution_.solve(light_, right_);
            if (has_gains_ && i % kGainInterval == 0) update_gains();
            split_data(false);
            const Change change = split_field();
            const double share =
                std::max(static_cast<double>(i) / max_iterations,
                         std::min(1.0, std::log(change.relative()) / std::log(tolerance_)));
            progress.update(0.95 * share, fmt::format("change {:.2g}", change.relative()));
            if (change.relative() <= tolerance_) return i;
        }
        return max_iterations;
    }

    const ConeField& albedo() const { return w_; }

    /// Twice how much less likely the observed bins are than under their own values (the
    /// deviance), all scatterers included.
    double misfit() const {
        std::vector<double> rows(cone_.nx, 0.0);
        core::parallel_for(cone_.nx, [&](std::size_t ix) {
            const std::size_t lanes = cone_.ny;
            std::vector<float> time(num_bins_ * lanes);
            time_.apply(c_.data() + ix * cone_.num_v() * lanes, time.data(), lanes);
            for (std::size_t i = 0; i < time.size(); ++i) {
                const std::size_t column = ix * lanes + i % lanes;
                const std::size_t t = i / lanes;
                if (!data_.observed[column].holds(static_cast<int>(t))) continue;
                const double y = static_cast<double>(data_.values[ix * num_bins_ * lanes + i]);
                const double m = static_cast<double>(gains_[column] * time[i] +
                                                     data_.background_per_bin[column]);
                rows[ix] += data_.likelihood == Likelihood::Poisson
                                ? poisson_deviance(y, m)
                                : data_.precision[t] * (y - m) * (y - m);
            }
        });
        return std::accumulate(rows.begin(), rows.end(), 0.0);
    }

 private:
    /// Squares that say how far the iterations have come.
    struct Change {
        double step = 0.0, gap = 0.0, norm = 0.0;

        Change& operator+=(const Change& other) {
            step += other.step;
            gap += other.gap;
            norm += other.norm;
            return *this;
        }
        double relative() const { return norm > 0.0 ? std::sqrt(std::max(step, gap) / norm) : 0.0; }
    };

    /// From K f in light_ to the next c, p and r and, in light_, c - p - K f; or from the data
    /// alone to the first of them.
    void split_data(bool is_first) {
        core::parallel_for(cone_.nx, [&](std::size_t ix) {
            const std::size_t lanes = cone_.ny;
            const std::size_t num_v = cone_.num_v() * lanes;
            float* light = light_.data() + ix * num_v;
            float* c = c_.data() + ix * num_v;
            float* p = p_.data() + ix * num_v;
            float* r = r_.data() + ix * num_bins_ * lanes;
            std::vector<float> time(num_bins_ * lanes);
            std::vector<float> pull(num_v);
            time_.apply(c, time.data(), lanes);
            for (std::size_t t = 0; t < num_bins_; ++t) {
                explain_bins(ix, t, is_first, time.data() + t * lanes, r + t * lanes);
            }
            time_.apply_adjoint(time.data(), pull.data(), lanes);
            for (std::size_t i = 0; i < num_v; ++i) {
                p[i] += is_first ? 0.0F : relaxed(light[i], c[i]);
                c[i] = p[i] + pull[i];
            }
            time_.solve(c, lanes);
            time_.apply(c, time.data(), lanes);
            for (std::size_t i = 0; i < num_bins_ * lanes; ++i) r[i] -= time[i];
            for (std::size_t i = 0; i < num_v; ++i) {
                p[i] = is_first ? 0.0F : p[i] - c[i];
                light[i] = c[i] - p[i] - light[i];
            }
            if (is_first) std::fill_n(r, num_bins_ * lanes, 0.0F);
        });
    }

    /// The gains that explain the data best by K f, in light_.
    void update_gains() {
        std::vector<double> measured(cone_.num_columns(), 0.0);
        std::vector<double> expected(cone_.num_columns(), 0.0);
        core::parallel_for(cone_.nx, [&](std::size_t ix) {
            const std::size_t lanes = cone_.ny;
            std::vector<float> time(num_bins_ * lanes);
            time_.apply(light_.data() + ix * cone_.num_v() * lanes, time.data(), lanes);
            for (std::size_t i = 0; i < time.size(); ++i) {
                const std::size_t column = ix * lanes + i % lanes;
                if (!data_.observed[column].holds(static_cast<int>(i / lanes))) continue;
                const double m = data_.precision[i / lanes] * static_cast<double>(time[i]);
                measured[column] += m * static_cast<double>(data_.values[ix * time.size() + i] -
                                                            data_.background_per_bin[column]);
                expected[column] += m * static_cast<double>(time[i]);
            }
        });
        gains_.update(measured, expected);
    }

    static float relaxed(float value, float split) { return split + kRelaxation * (value - split); }

    /// From B c of one bin to P (h + r) in its place; h + r stays in `r`.
    void explain_bins(std::size_t ix, std::size_t t, bool is_first, float* time, float* r) const {
        const std::size_t lanes = cone_.ny;
        const float* values = data_.values.data() + (ix * num_bins_ + t) * lanes;
        const float* background = data_.background_per_bin.data() + ix * lanes;
        const core::BinRange* observed = data_.observed.data() + ix * lanes;
        const auto penalty = static_cast<float>(data_.precision[t]);
        const bool is_poisson = data_.likelihood == Likelihood::Poisson;
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const bool is_seen = observed[lane].holds(static_cast<int>(t));
            const float gain = gains_[ix * lanes + lane];
            const float e = time[lane] - r[lane];
            float h = is_first ? 0.0F : e;
            if (is_seen) {
                const float y = values[lane];
                const float expected = gain * e + background[lane];
                const float own_penalty = penalty / (gain * gain);  // of counts instead of light
                const float m = is_first     ? y
                                : is_poisson ? poisson_proximal(y, expected, own_penalty)
                                             : gaussian_proximal(y, expected, penalty, own_penalty);
                h = (m - background[lane]) / gain;
            }
            r[lane] += is_first ? h : relaxed(h, time[lane]);
            time[lane] = penalty * r[lane];
        }
    }

    /// Updates d, u, w and q from f in right_ and leaves grad'(d - u) + w - q there.
    Change split_field() {
        std::vector<Change> changes(cone_.nx);
        core::parallel_for(cone_.nx, [&](std::size_t ix) {
            for (std::size_t v = 0; v < cone_.num_v(); ++v) split_gradients(ix, v);
        });
        core::parallel_for(cone_.nx, [&](std::size_t ix) {
            for (std::size_t v = 0; v < cone_.num_v(); ++v) changes[ix] += split_albedo(ix, v);
        });
        Change change;
        for (const Change& own : changes) change += own;
        return change;
    }

    std::size_t at(std::size_t ix, std::size_t v) const {
        return (ix * cone_.num_v() + v) * cone_.ny;
    }

    /// d and u of a row of voxels; b_ = d - u. Differences across the volume's faces stay 0.
    void split_gradients(std::size_t ix, std::size_t v) {
        const std::size_t ny = cone_.ny;
        const std::size_t here = at(ix, v);
        const float* f = right_.data() + here;
        const float* next_x = ix + 1 < cone_.nx ? right_.data() + at(ix + 1, v) : f;
        const float* next_v = v + 1 < cone_.num_v() ? right_.data() + at(ix, v + 1) : f;
        float* __restrict ux = u_[0].data() + here;
        float* __restrict uy = u_[1].data() + here;
        float* __restrict uv = u_[2].data() + here;
        float* __restrict bx = b_[0].data() + here;
        float* __restrict by = b_[1].data() + here;
        float* __restrict bv = b_[2].data() + here;
        const float tv = tv_[v];
        for (std::size_t iy = 0; iy < ny; ++iy) {
            const float next_y = iy + 1 < ny ? f[iy + 1] : f[iy];
            const float ex = relaxed(next_x[iy] - f[iy], bx[iy] + ux[iy]) + ux[iy];
            const float ey = relaxed(next_y - f[iy], by[iy] + uy[iy]) + uy[iy];
            const float ev = relaxed(next_v[iy] - f[iy], bv[iy] + uv[iy]) + uv[iy];
            const float norm = std::sqrt(ex * ex + ey * ey + ev * ev);
            const float keep = norm > tv ? 1.0F - tv / norm : 0.0F;
            ux[iy] = (1.0F - keep) * ex;  // e - d, the new multiplier
            uy[iy] = (1.0F - keep) * ey;
            uv[iy] = (1.0F - keep) * ev;
            bx[iy] = (2.0F * keep - 1.0F) * ex;
            by[iy] = (2.0F * keep - 1.0F) * ey;
            bv[iy] = (2.0F * keep - 1.0F) * ev;
        }
    }

    /// w and q of a row of voxels, and the next right-hand side.
    Change split_albedo(std::size_t ix, std::size_t v) {
        const std::size_t ny = cone_.ny;
        const std::size_t here = at(ix, v);
        const float* before_x = ix > 0 ? b_[0].data() + at(ix - 1, v) : nullptr;
        const float* before_v = v > 0 ? b_[2].data() + at(ix, v - 1) : nullptr;
        const float* bx = b_[0].data() + here;
        const float* by = b_[1].data() + here;
        const float* bv = b_[2].data() + here;
        Change change;
        for (std::size_t iy = 0; iy < ny; ++iy) {
            const std::size_t i = here + iy;
            const float f = right_[i];
            const float e = relaxed(f, w_[i]) + q_[i];
            const float w = std::max(0.0F, e - sparsity_[v]);
            change.step += static_cast<double>((w - w_[i]) * (w - w_[i]));
            change.gap += static_cast<double>((w - f) * (w - f));
            change.norm += static_cast<double>(w * w);
            w_[i] = w;
            q_[i] = e - w;
            const float divergence = (before_x ? before_x[iy] : 0.0F) - bx[iy] +
                                     (iy > 0 ? by[iy - 1] : 0.0F) - by[iy] +
                                     (before_v ? before_v[iy] : 0.0F) - bv[iy];
            right_[i] = static_cast<float>(kAlbedoPenalty) * (2.0F * w - e) +
                        static_cast<float>(kGradientPenalty) * divergence;
        }
        return change;
    }

    const ConfocalProblem& data_;
    const Cone& cone_;
    double tolerance_;
    TimeOperator time_;
    ConeConvolution convolution_;
    std::size_t num_bins_;
    bool has_gains_;
    PairGains gains_;
    ConeField right_, light_;  ///< f and K f, or what the next of them is computed from
    ConeField c_, p_, q_, w_;
    std::array<ConeField, 3> u_, b_;
    std::vector<float> r_;              ///< [x][bin][y]
    std::vector<float> tv_, sparsity_;  ///< thresholds, per bin of v
};

// Of the choice between falloffs.
constexpr int kTrialIterations = 20;
constexpr double kFewCounts = 5.0;      // in the bins that hold most of the light
constexpr double kClearlyBetter = 0.8;  // share of the misfit

/// The mean of counts, weighted by themselves.
double mean_intensity(const ConfocalProblem& data) {
    double sum = 0.0;
    double squares = 0.0;
    for (const float value : data.values) {
        sum += static_cast<double>(value);
        squares += static_cast<double>(value) * static_cast<double>(value);
    }
    return sum > 0.0 ? squares / sum : 0.0;
}

double num_observed_bins(const ConfocalProblem& data) {
    double count = 0.0;
    for (const core::BinRange& range : data.observed) count += range.size();
    return std::max(1.0, count);
}

/// Fields over the footprint that a solver holds, those of time included.
constexpr double kNumFields = 14.0;

}  // namespace

Volume solve_confocal(const MethodInput& input,
                      const ReconstructSettings& settings,
                      std::size_t /*num_slabs*/) {
    const ConfocalProblem data = make_confocal_problem(input, settings);
    const Cone& cone = data.cone;
    ConfocalSolver solver(input, data, settings.solver);
    const int iterations = solver.run(input.progress, settings.solver.max_iterations);
    if (input.progress.announce) {
        input.progress.announce(
            fmt::format("solver: {} iterations, {:.3g} of deviance per observed bin",
                        iterations,
                        solver.misfit() / num_observed_bins(data)));
    }
    const ConservativeResampling to_depth = squared_range_to_depth(input, cone);
    const std::size_t num_z = input.axes.z_m.size();
    const ConeKernel kernel(cone, *input.wall.grid);
    const auto unit = static_cast<float>(data.unit / std::sqrt(kernel.squared_norm()));
    Volume volume{input.axes, std::vector<float>(cone.num_columns() * num_z), {}};
    core::parallel_for(cone.num_columns(), [&](std::size_t column) {
        std::vector<float> row(cone.num_v());
        for (std::size_t v = 0; v < cone.num_v(); ++v) {
            row[v] =
                unit *
                solver.albedo()[(column / cone.ny * cone.num_v() + v) * cone.ny + column % cone.ny];
        }
        to_depth.apply(row.data(), volume.values.data() + column * num_z);
    });
    input.progress.update(1.0, "to depth");
    return volume;
}

FalloffChoice choose_falloff(const MethodInput& input, ReconstructSettings settings) {
    const core::Progress silent = input.progress.part(0.0, 0.0);
    std::array<double, 2> misfits{};
    for (const Falloff falloff : {Falloff::Diffuse, Falloff::Retro}) {
        settings.falloff = falloff;
        const ConfocalProblem data = make_confocal_problem(input, settings);
        if (data.likelihood != Likelihood::Poisson || mean_intensity(data) < kFewCounts) {
            return {Falloff::Diffuse, "falloff: taken for diffuse, which only many counts tell"};
        }
        ConfocalSolver solver(input, data, settings.solver);
        solver.run(silent, kTrialIterations);
        misfits[static_cast<std::size_t>(falloff)] = solver.misfit();
    }
    const double ratio = misfits[1] / misfits[0];
    const bool is_retro = ratio < kClearlyBetter;
    return {is_retro ? Falloff::Retro : Falloff::Diffuse,
            fmt::format("falloff: {}, misfit of retroreflective over diffuse light {:.2f}",
                        is_retro ? "retroreflective" : "diffuse",
                        ratio)};
}

double solve_confocal_bytes(const MethodInput& input,
                            const ReconstructSettings& /*settings*/,
                            std::size_t /*num_slabs*/) {
    const Cone cone = make_cone(input, 1);
    return ConeConvolution::bytes(cone, kNumFields) +
           4.0 * static_cast<double>(input.axes.num_voxels());
}

}  // namespace nlos
