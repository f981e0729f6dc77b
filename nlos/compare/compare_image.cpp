// SPDX-License-Identifier: MIT
#include "nlos/compare/compare_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

constexpr std::size_t kWindow = 11;
constexpr double kWindowSigma = 1.5;
constexpr double kC1 = 0.01 * 0.01;  // (K1 L)^2 with L = 1
constexpr double kC2 = 0.03 * 0.03;

using Image = std::vector<double>;

float largest(const std::vector<float>& image) {
    return image.empty() ? 0.0F : *std::max_element(image.begin(), image.end());
}

std::array<double, kWindow> window_weights() {
    std::array<double, kWindow> weights{};
    for (std::size_t i = 0; i < kWindow; ++i) {
        const double offset = static_cast<double>(i) - static_cast<double>(kWindow / 2);
        weights[i] = std::exp(-0.5 * offset * offset / (kWindowSigma * kWindowSigma));
    }
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (double& weight : weights) weight /= sum;
    return weights;
}

/// Weighted means over all windows inside the image: (rows - 10) x (columns - 10) values.
Image window_means(const Image& image, std::size_t rows, std::size_t columns) {
    static const std::array<double, kWindow> weights = window_weights();
    const std::size_t inner_columns = columns - kWindow + 1;
    const std::size_t inner_rows = rows - kWindow + 1;
    Image along_rows(rows * inner_columns, 0.0);
    for (std::size_t r = 0; r < rows; ++r) {
        for (std::size_t c = 0; c < inner_columns; ++c) {
            for (std::size_t k = 0; k < kWindow; ++k) {
                along_rows[r * inner_columns + c] += weights[k] * image[r * columns + c + k];
            }
        }
    }
    Image means(inner_rows * inner_columns, 0.0);
    for (std::size_t r = 0; r < inner_rows; ++r) {
        for (std::size_t k = 0; k < kWindow; ++k) {
            for (std::size_t c = 0; c < inner_columns; ++c) {
                means[r * inner_columns + c] +=
                    weights[k] * along_rows[(r + k) * inner_columns + c];
            }
        }
    }
    return means;
}

Image product(const Image& a, const Image& b) {
    Image result(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] * b[i];
    return result;
}

}  // namespace

Mask mask_above_fraction(const std::vector<float>& image, double fraction) {
    const double threshold = fraction * static_cast<double>(std::max(largest(image), 0.0F));
    Mask mask(image.size());
    for (std::size_t i = 0; i < image.size(); ++i) {
        mask[i] = static_cast<double>(image[i]) > threshold;
    }
    return mask;
}

std::optional<double> mask_iou(const Mask& mask, const Covered& truth) {
    double found = 0.0;
    double right = 0.0;
    double missed = 0.0;
    for (std::size_t i = 0; i < mask.size(); ++i) {
        if (mask[i] == 0) {
            missed += truth[i];
        } else {
            found += 1.0;
            right += truth[i] > 0.0 ? 1.0 : 0.0;
        }
    }
    if (!(found > 0.0) || !(right + missed > 0.0)) return std::nullopt;
    return right / (found + missed);
}

std::optional<ThresholdedMask> best_mask(const std::vector<float>& image, const Covered& truth) {
    double missed = std::accumulate(truth.begin(), truth.end(), 0.0);
    if (!(missed > 0.0) || !(largest(image) > 0.0F)) return std::nullopt;

    // Lowering the threshold adds pixels in falling order of value; only between two different
    // values is there a threshold.
    std::vector<std::size_t> order(image.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
        return image[i] > image[j];
    });
    ThresholdedMask best;
    std::size_t right = 0;
    for (std::size_t taken = 1; taken <= order.size(); ++taken) {
        right += truth[order[taken - 1]] > 0.0 ? 1 : 0;
        missed -= truth[order[taken - 1]];
        if (taken < order.size() && image[order[taken]] == image[order[taken - 1]]) continue;
        const double iou =
            static_cast<double>(right) / (static_cast<double>(taken) + std::max(0.0, missed));
        if (iou > best.iou) best = {iou, double{image[order[taken - 1]]} / largest(image)};
    }
    return best;
}

std::optional<std::vector<double>> normalised(const std::vector<float>& image) {
    const auto maximum = static_cast<double>(largest(image));
    if (!(maximum > 0.0)) return std::nullopt;
    std::vector<double> result(image.size());
    for (std::size_t i = 0; i < image.size(); ++i) {
        result[i] = std::max(0.0, static_cast<double>(image[i])) / maximum;
    }
    return result;
}

std::optional<double> psnr_db(const std::vector<double>& a, const std::vector<double>& b) {
    double squares = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
    if (!(squares > 0.0)) return std::nullopt;
    return -10.0 * std::log10(squares / static_cast<double>(a.size()));
}

std::optional<double> ssim(const std::vector<double>& a,
                           const std::vector<double>& b,
                           std::size_t rows,
                           std::size_t columns) {
    if (rows < kWindow || columns < kWindow) return std::nullopt;
    const Image mean_a = window_means(a, rows, columns);
    const Image mean_b = window_means(b, rows, columns);
    const Image mean_aa = window_means(product(a, a), rows, columns);
    const Image mean_bb = window_means(product(b, b), rows, columns);
    const Image mean_ab = window_means(product(a, b), rows, columns);
    double sum = 0.0;
    for (std::size_t i = 0; i < mean_a.size(); ++i) {
        const double ma = mean_a[i];
        const double mb = mean_b[i];
        const double variances = mean_aa[i] - ma * ma + mean_bb[i] - mb * mb;
        const double covariance = mean_ab[i] - ma * mb;
        sum += (2.0 * ma * mb + kC1) * (2.0 * covariance + kC2) /
               ((ma * ma + mb * mb + kC1) * (variances + kC2));
    }
    return sum / static_cast<double>(mean_a.size());
}

std::optional<double> relative_mse(std::span<const float> result,
                                   std::span<const float> reference) {
    double differences = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < reference.size(); ++i) {
        const auto wanted = static_cast<double>(reference[i]);
        const double error = static_cast<double>(result[i]) - wanted;
        differences += error * error;
        squares += wanted * wanted;
    }
    if (!(squares > 0.0)) return std::nullopt;
    return differences / squares;
}

}  // namespace nlos
