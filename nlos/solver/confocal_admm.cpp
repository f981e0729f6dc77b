// SPDX-License-Identifier: MIT
#include "nlos/solver/confocal_admm.h"

#include "nlos/solver/confocal_defaults.h"
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
//
// Where all light is the model's, a factor of the background is found with the scene, from 0: a
// gate full of light has no dark bins. Under a wide spot too, sparsity is reweighted [Candes2008]:
// an empty column costs the most, a bright one next to nothing.

namespace nlos {
namespace {

// They change what light from outside the footprint costs, and speed. Larger ones take fewer
// iterations to the same change, but stop farther from the minimum: tilted surfaces are too near.
constexpr double kGradientPenalty = 0.3;  // mu
constexpr double kAlbedoPenalty = 3.0;    // nu
constexpr float kRelaxation = 1.9F;       // of f and h away from their splits
constexpr int kGainInterval = 5;          // iterations from one update of gains or background

constexpr double kSparsityFraction = 0.1;  // of the weight of total variation, unless set

// Reweighted sparsity. What a voxel of an empty column costs is a fraction of what would hold back
// one as bright as the brightest, were it alone: so it does not depend on how many photons there
// are. Where the model leaves more of the data unexplained than noise, total variation weighs as
// for noise as large: else surfaces that do not quite face the wall fall apart.
constexpr double kEmptyCost = 0.04;
constexpr double kHalfCost = 0.1;      // of the brightest: such a column costs half
constexpr int kReweightInterval = 50;  // iterations
constexpr int kReweightUntil = 600;    // then columns' costs stay: else few columns take all light
constexpr double kReweightedWeight = 2.0;
constexpr std::array<int, 2> kMaxIterations{200, 600};  // without and under a wide spot

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
      max_iterations_(settings.max_iterations.value_or(kMaxIterations[data.is_under_spot ? 1 : 0])),
      weight_(settings.tv.value_or(default_weight(data))),
      time_(data.time),
      convolution_(cone_,
                   *input.wall.grid,
                   settings.spot_m.value_or(0.0),
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
      r_(data.values.size()),
      costs_(data.is_under_spot && !settings.sparsity ? right_.size() : 0),
      is_weight_set_(settings.tv.has_value()),
      background_factor_(data.finds_background ? 0.0F : 1.0F) {
    time_.factorize(data.precision);
    for (ConeField& u : u_) u.resize(right_.size());
    for (ConeField& b : b_) b.resize(right_.size());
    const double sparsity = settings.sparsity.value_or(kSparsityFraction * weight_);
    for (const double noise : voxel_noise(data, *input.wall.grid)) {
        tv_.push_back(static_cast<float>(weight_ * noise / kGradientPenalty));
        const double cost = costs_.empty() ? sparsity * noise : kEmptyCost * noise * noise;
        sparsity_.push_back(static_cast<float>(cost / kAlbedoPenalty));
    }
}

int ConfocalAdmm::run(const core::Progress& progress, std::optional<int> at_most) {
    const int max_iterations = at_most.value_or(max_iterations_);
    split_data(true);
    double fraction = 0.0;
    for (int i = 1; i <= max_iterations; ++i) {
        check_stop(progress);
        convolution_.solve(light_, right_);
        if (has_gains_ && i % kGainInterval == 0) update_gains();
        if (data_.finds_background && i % kGainInterval == 0) update_background();
        split_data(false);
        const Change change = split_field();
        if (!costs_.empty() && i % kReweightInterval == 0 && i <= kReweightUntil) reweight();
        // The change may grow for a while, the fraction done may not.
        fraction = std::max({fraction,
                             static_cast<double>(i) / max_iterations,
                             std::min(1.0, std::log(change.relative()) / std::log(tolerance_))});
        progress.update(0.95 * fraction, fmt::format("change {:.2g}", change.relative()));
        if (change.relative() <= tolerance_) return i;
    }
    return max_iterations;
}

template <class Visit>
void ConfocalAdmm::visit_light(std::size_t ix, const Visit& visit) {
    const std::size_t lanes = cone_.ny;
    std::vector<float> time(num_bins_ * lanes);
    time_.apply(light_.data() + ix * cone_.num_v() * lanes, time.data(), lanes);
    for (std::size_t i = 0; i < time.size(); ++i) {
        const std::size_t column = ix * lanes + i % lanes;
        if (!data_.observed[column].holds(static_cast<int>(i / lanes))) continue;
        visit(column, i / lanes, time[i], data_.values[ix * time.size() + i]);
    }
}

double ConfocalAdmm::misfit() {
    light_ = c_;
    if (data_.is_confined) convolution_.forward(w_, light_);
    std::vector<double> rows(cone_.nx, 0.0);
    core::parallel_for(cone_.nx, [&](std::size_t ix) {
        visit_light(ix, [&](std::size_t column, std::size_t t, float light, float value) {
            const auto y = static_cast<double>(value);
            const auto m = static_cast<double>(gains_[column] * light + background(column));
            rows[ix] += data_.likelihood == Likelihood::Poisson
                            ? poisson_deviance(y, m)
                            : data_.precision[t] * (y - m) * (y - m);
        });
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
        visit_light(ix, [&](std::size_t column, std::size_t t, float light, float value) {
            const double m = data_.precision[t] * static_cast<double>(light);
            measured[column] += m * static_cast<double>(value - background(column));
            expected[column] += m * static_cast<double>(light);
        });
    });
    gains_.update(measured, expected);
}

void ConfocalAdmm::update_background() {
    std::vector<double> excess(cone_.nx, 0.0);  // over light and background of factor 1
    std::vector<double> squares(cone_.nx, 0.0);
    core::parallel_for(cone_.nx, [&](std::size_t ix) {
        visit_light(ix, [&](std::size_t column, std::size_t t, float light, float value) {
            const auto b = static_cast<double>(data_.background_per_bin[column]);
            const auto left = static_cast<double>(value - gains_[column] * light);
            excess[ix] += data_.precision[t] * b * left;
            squares[ix] += data_.precision[t] * b * b;
        });
    });
    const double sum = std::accumulate(squares.begin(), squares.end(), 0.0);
    const double left = std::accumulate(excess.begin(), excess.end(), 0.0);
    if (sum > 0.0) background_factor_ = static_cast<float>(std::max(0.0, left / sum));
}

void ConfocalAdmm::reweight() {
    std::vector<float> columns(cone_.num_columns(), 0.0F);
    double sum = 0.0;
    double norm = 0.0;
    for (std::size_t i = 0; i < w_.size(); ++i) {
        columns[column_of(i)] += w_[i];
        sum += static_cast<double>(w_[i]);
        norm += static_cast<double>(w_[i] * w_[i]);
    }
    if (!(sum > 0.0)) return;
    double squares = 0.0;
    for (const float column : columns) squares += static_cast<double>(column * column);
    const auto brightest = static_cast<float>(norm / sum);
    const auto half = static_cast<float>(kHalfCost * squares / sum);
    for (std::size_t i = 0; i < w_.size(); ++i) {
        costs_[i] = brightest * half / (columns[column_of(i)] + half);
    }
    if (is_weight_set_) return;
    ConeField light = light_;  // misfit() takes its place
    tv_factor_ = kReweightedWeight * std::sqrt(std::max(1.0, misfit() / num_observed_bins(data_)));
    light_ = std::move(light);
}

void ConfocalAdmm::explain_bins(
    std::size_t ix, std::size_t t, bool is_first, float* time, float* r) const {
    const std::size_t lanes = cone_.ny;
    const float* values = data_.values.data() + (ix * num_bins_ + t) * lanes;
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
            const float dark = background(ix * lanes + lane);
            const float expected = gain * e + dark;
            const float own_penalty = penalty / (gain * gain);  // of counts instead of light
            const float m = is_first     ? y
                            : is_poisson ? poisson_proximal(y, expected, own_penalty)
                                         : gaussian_proximal(y, expected, penalty, own_penalty);
            h = (m - dark) / gain;
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
    const float tv = static_cast<float>(tv_factor_) * tv_[v];
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
    const float* costs = costs_.empty() ? nullptr : costs_.data();
    Change change;
    for (std::size_t iy = 0; iy < ny; ++iy) {
        const std::size_t i = here + iy;
        const float f = right_[i];
        const float e = relaxed(f, w_[i]) + q_[i];
        const float w = std::max(0.0F, e - (costs ? costs[i] : 1.0F) * sparsity_[v]);
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
    return ConeConvolution::bytes(cone, kNumFields + (is_confined ? 2.0 : 0.0), is_confined);
}

}  // namespace nlos
