// SPDX-License-Identifier: MIT
#include "nlos/solver/time_operator.h"

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

/// y += a x over lanes.
void add_scaled(float a, const float* __restrict x, float* __restrict y, std::size_t lanes) {
    for (std::size_t i = 0; i < lanes; ++i) y[i] += a * x[i];
}

/// The fraction of each bin of v that falls into each bin of time, without a response, times the
/// falloff: dense rows, one per bin of time and of `margin` more on both sides.
std::vector<std::vector<double>> resampling_rows(const core::TimeAxis& axis,
                                                 int margin,
                                                 std::span<const double> v_edges,
                                                 double power) {
    const std::size_t num_v = v_edges.size() - 1;
    const double width = v_edges[1] - v_edges[0];
    const auto edge = [&](int bin) {
        return std::pow(std::max(0.0, 0.5 * axis.bin_begin_m(bin)), 2);
    };
    std::vector<std::vector<double>> rows(static_cast<std::size_t>(axis.num_bins + 2 * margin),
                                          std::vector<double>(num_v, 0.0));
    for (int bin = -margin; bin < axis.num_bins + margin; ++bin) {
        const double begin = edge(bin);
        const double end = edge(bin + 1);
        const double first = std::max(0.0, std::floor((begin - v_edges.front()) / width));
        for (auto v = static_cast<std::size_t>(first); v < num_v && v_edges[v] < end; ++v) {
            const double overlap = std::min(end, v_edges[v + 1]) - std::max(begin, v_edges[v]);
            const double range = std::sqrt(0.5 * (v_edges[v] + v_edges[v + 1]));
            rows[static_cast<std::size_t>(bin + margin)][v] =
                std::max(0.0, overlap) / width * std::pow(range, -power);
        }
    }
    return rows;
}

/// Rows convolved with the response along time, those of the axis: light from bins that the
/// response reaches beyond it counts too.
std::vector<std::vector<double>> blurred_rows(const core::TimeAxis& axis,
                                              std::span<const double> v_edges,
                                              double power,
                                              const core::ResponseFilter& response) {
    if (response.weights.empty()) return resampling_rows(axis, 0, v_edges, power);
    const int taps = static_cast<int>(response.weights.size());
    const int margin = std::max(std::abs(response.first_delay), response.first_delay + taps);
    const std::vector<std::vector<double>> rows = resampling_rows(axis, margin, v_edges, power);
    std::vector<std::vector<double>> result(static_cast<std::size_t>(axis.num_bins),
                                            std::vector<double>(rows.front().size(), 0.0));
    for (int to = 0; to < axis.num_bins; ++to) {
        for (int k = 0; k < taps; ++k) {
            const int from = to - response.first_delay - k + margin;
            const double weight = response.weights[static_cast<std::size_t>(k)];
            const std::vector<double>& source = rows[static_cast<std::size_t>(from)];
            std::vector<double>& sum = result[static_cast<std::size_t>(to)];
            for (std::size_t v = 0; v < sum.size(); ++v) {
                sum[v] += weight * source[v];
            }
        }
    }
    return result;
}

}  // namespace

TimeOperator::TimeOperator(const core::TimeAxis& axis,
                           std::span<const double> v_edges,
                           double power,
                           const core::ResponseFilter& response)
    : num_v_(v_edges.size() - 1) {
    for (const std::vector<double>& dense : blurred_rows(axis, v_edges, power, response)) {
        const auto is_set = [](double weight) { return weight != 0.0; };
        const auto first = std::ranges::find_if(dense, is_set);
        const auto last = std::find_if(dense.rbegin(), dense.rend(), is_set).base();
        Row row;
        if (first < last) {
            row.first = static_cast<std::size_t>(first - dense.begin());
            row.weights.assign(first, last);
        }
        rows_.push_back(std::move(row));
    }
}

void TimeOperator::scale(double factor) {
    for (Row& row : rows_) {
        for (float& weight : row.weights) weight *= static_cast<float>(factor);
    }
}

void TimeOperator::apply(const float* v, float* time, std::size_t lanes) const {
    for (std::size_t t = 0; t < rows_.size(); ++t) {
        const Row& row = rows_[t];
        float* sum = time + t * lanes;
        std::fill_n(sum, lanes, 0.0F);
        for (std::size_t i = 0; i < row.weights.size(); ++i) {
            add_scaled(row.weights[i], v + (row.first + i) * lanes, sum, lanes);
        }
    }
}

void TimeOperator::apply_adjoint(const float* time, float* v, std::size_t lanes) const {
    std::fill_n(v, num_v_ * lanes, 0.0F);
    for (std::size_t t = 0; t < rows_.size(); ++t) {
        const Row& row = rows_[t];
        for (std::size_t i = 0; i < row.weights.size(); ++i) {
            add_scaled(row.weights[i], time + t * lanes, v + (row.first + i) * lanes, lanes);
        }
    }
}

std::vector<double> TimeOperator::normal_diagonal(std::span<const double> weights) const {
    std::vector<double> diagonal(num_v_, 0.0);
    for (std::size_t t = 0; t < rows_.size(); ++t) {
        for (std::size_t i = 0; i < rows_[t].weights.size(); ++i) {
            diagonal[rows_[t].first + i] += weights[t] * std::pow(rows_[t].weights[i], 2);
        }
    }
    return diagonal;
}

void TimeOperator::factorize(std::span<const double> weights) {
    band_ = 0;
    for (const Row& row : rows_) band_ = std::max(band_, row.weights.size());
    band_ = band_ > 0 ? band_ - 1 : 0;
    const std::size_t stride = band_ + 1;
    std::vector<double> matrix(num_v_ * stride, 0.0);  // [i][band + j - i] for j <= i
    for (std::size_t i = 0; i < num_v_; ++i) matrix[i * stride + band_] = 1.0;
    for (std::size_t t = 0; t < rows_.size(); ++t) {
        const Row& row = rows_[t];
        for (std::size_t a = 0; a < row.weights.size(); ++a) {
            for (std::size_t b = 0; b <= a; ++b) {
                matrix[(row.first + a) * stride + band_ + b - a] +=
                    weights[t] * static_cast<double>(row.weights[a]) *
                    static_cast<double>(row.weights[b]);
            }
        }
    }
    for (std::size_t i = 0; i < num_v_; ++i) {
        double* own = matrix.data() + i * stride;
        const std::size_t begin = i > band_ ? i - band_ : 0;
        for (std::size_t j = begin; j <= i; ++j) {
            const double* other = matrix.data() + j * stride;
            double sum = own[band_ + j - i];
            for (std::size_t k = std::max(begin, j > band_ ? j - band_ : 0); k < j; ++k) {
                sum -= own[band_ + k - i] * other[band_ + k - j];
            }
            own[band_ + j - i] = j == i ? std::sqrt(sum) : sum / other[band_];
        }
    }
    factor_.assign(matrix.begin(), matrix.end());
    inverse_diagonal_.resize(num_v_);
    for (std::size_t i = 0; i < num_v_; ++i) {
        inverse_diagonal_[i] = static_cast<float>(1.0 / matrix[i * stride + band_]);
    }
}

void TimeOperator::solve(float* v, std::size_t lanes) const {
    const std::size_t stride = band_ + 1;
    for (std::size_t i = 0; i < num_v_; ++i) {
        float* own = v + i * lanes;
        for (std::size_t j = i > band_ ? i - band_ : 0; j < i; ++j) {
            add_scaled(-factor_[i * stride + band_ + j - i], v + j * lanes, own, lanes);
        }
        for (std::size_t lane = 0; lane < lanes; ++lane) own[lane] *= inverse_diagonal_[i];
    }
    for (std::size_t i = num_v_; i-- > 0;) {
        float* own = v + i * lanes;
        for (std::size_t lane = 0; lane < lanes; ++lane) own[lane] *= inverse_diagonal_[i];
        for (std::size_t j = i > band_ ? i - band_ : 0; j < i; ++j) {
            add_scaled(-factor_[i * stride + band_ + j - i], own, v + j * lanes, lanes);
        }
    }
}

}  // namespace nlos
