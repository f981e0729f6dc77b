// SPDX-License-Identifier: MIT
#include "nlos/solver/confocal_admm.h"

#include "nlos/solver/proximal.h"

#include <fmt/format.h>

#include <algorithm>
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

// They change what light from outside the footprint costs, and speed. Larger ones take fewer
// iterations to the same change, but stop farther from the minimum: tilted surfaces are too near.
constexpr double kGradientPenalty = 0.3;     // mu
constexpr double kAlbedoPenalty = 3.0;       // nu
constexpr float kRelaxation = 1.9F;          // of f and h away from their splits
constexpr double kToleranceOfGrids = 0.015;  // of the relative change, unless set; few points pull
                                             // weakly: times the root of their share
constexpr int kGainInterval = 5;             // iterations from one update of gains to the next

// Weights of total variation where light is plenty, unless set: the fourth root of how scarce it is
// multiplies them. `nlos bench weights` holds what follows from them against a search. What
// radiance leaves unexplained is the model's error, much alike at neighbouring points, where counts
// have noise of their own.
constexpr double kPoissonWeight = 0.35;
constexpr double kGaussianWeight = 0.6;
constexpr double kPlenty = 150.0;       // photons per wall point
constexpr double kFewest = 0.6;         // fewer weigh as these
constexpr double kSparsityShare = 0.1;  // of the weight of total variation, unless set

// Powers of how far the response smears depth, where the model tells all of the light: then a
// smaller weight shows more of the shape, and takes longer to settle.
constexpr double kSmearedWeight = -2.5;
constexpr double kSmearedTolerance = -2.0;

/// Share of the wall points that were observed at all.
double observed_share(const ConfocalProblem& data) {
    const auto num_seen = std::ranges::count_if(
        data.observed, [](const core::BinRange& seen) { return seen.size() > 0; });
    return static_cast<double>(num_seen) / static_cast<double>(data.observed.size());
}

/// The weight of total variation by default: more where photons, or points with radiance, are few.
double default_weight(const ConfocalProblem& data) {
    const double smeared = data.is_confined ? std::pow(data.blur, kSmearedWeight) : 1.0;
    if (data.likelihood == Likelihood::Gaussian) {
        return kGaussianWeight * smeared * std::pow(observed_share(data), -0.25);
    }
    const double photons = std::max(kFewest, data.photons_per_point);
    return kPoissonWeight * smeared * std::pow(std::max(1.0, kPlenty / photons), 0.25);
}

/// The relative change at which iterations stop by default.
double default_tolerance(const ConfocalProblem& data) {
    const double smeared = data.is_confined ? std::pow(data.blur, kSmearedTolerance) : 1.0;
    return kToleranceOfGrids * smeared * std::sqrt(observed_share(data));
}

/// What the noise of light at v makes of a voxel at u, in units of its standard deviation: the
/// root of its mean square over the wall points that see the voxel, and of the share of these that
/// were observed.
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
    const double observed = observed_share(data);
    std::vector<double> noise(num_v);
    for (std::size_t u = 0; u < num_v; ++u) {
        double sum = 0.0;
        double weights = 0.0;
        for (std::size_t shift = 0; u + shift < num_v; ++shift) {
            sum += share[shift] * light[u + shift];
            weights += share[shift];
        }
        noise[u] = weights > 0.0 ? std::sqrt(observed * sum / weights) : 0.0;
    }
    return noise;
}

float relaxed(float value, float split) {
    return split + kRelaxation * (value - split);
}

/// Fields over the footprint that are held, those of time included.
constexpr double kNumFields = 14.0;

}  // namespace

ConfocalAdmm::ConfocalAdmm(const MethodInput& input,
                           const ConfocalProblem& data,
                           const SolverSettings& settings)
    : data_(data),
      cone_(data.cone),
      tolerance_(settings.tolerance.value_or(default_tolerance(data))),
      weight_(settings.tv.value_or(default_weight(data))),
      time_(data.time),
      convolution_(cone_,
                   *input.wall.grid,
                   settings.spot_m,
                   kGradientPenalty,
                   kAlbedoPenalty,
                   data.is_confined),
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
    const double sparsity = settings.sparsity.value_or(kSparsityShare * weight_);
    for (const double noise : voxel_noise(data, *input.wall.grid)) {
        tv_.push_back(static_cast<float>(weight_ * noise / kGradientPenalty));
        sparsity_.push_back(static_cast<float>(sparsity * noise / kAlbedoPenalty));
    }
}

int ConfocalAdmm::run(const core::Progress& progress, int max_iterations) {
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

double ConfocalAdmm::misfit() {
    if (data_.is_confined) convolution_.forward(w_, light_);
    const ConeField& light = data_.is_confined ? light_ : c_;
    std::vector<double> rows(cone_.nx, 0.0);
    core::parallel_for(cone_.nx, [&](std::size_t ix) {
        const std::size_t lanes = cone_.ny;
        std::vector<float> time(num_bins_ * lanes);
        time_.apply(light.data() + ix * cone_.num_v() * lanes, time.data(), lanes);
        for (std::size_t i = 0; i < time.size(); ++i) {
            const std::size_t column = ix * lanes + i % lanes;
            const std::size_t t = i / lanes;
            if (!data_.observed[column].holds(static_cast<int>(t))) continue;
            const double y = static_cast<double>(data_.values[ix * num_bins_ * lanes + i]);
            const double m =
                static_cast<double>(gains_[column] * time[i] + data_.background_per_bin[column]);
            rows[ix] += data_.likelihood == Likelihood::Poisson
                            ? poisson_deviance(y, m)
                            : data_.precision[t] * (y - m) * (y - m);
        }
    });
    return std::accumulate(rows.begin(), rows.end(), 0.0);
}

void ConfocalAdmm::split_data(bool is_first) {
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

void ConfocalAdmm::update_gains() {
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

void ConfocalAdmm::explain_bins(
    std::size_t ix, std::size_t t, bool is_first, float* time, float* r) const {
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

ConfocalAdmm::Change ConfocalAdmm::split_field() {
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

void ConfocalAdmm::split_gradients(std::size_t ix, std::size_t v) {
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

ConfocalAdmm::Change ConfocalAdmm::split_albedo(std::size_t ix, std::size_t v) {
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

double ConfocalAdmm::bytes(const Cone& cone, bool is_confined) {
    return ConeConvolution::bytes(cone, kNumFields, is_confined);
}

}  // namespace nlos
