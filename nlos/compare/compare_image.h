// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace nlos {

/// One truth value per pixel, 0 or 1 (not vector<bool>: its elements have no address).
using Mask = std::vector<unsigned char>;

/// Per pixel the fraction of it that is foreground, in [0, 1].
using Covered = std::vector<double>;

/// Pixels above `fraction` of the largest value; all 0 when no value is positive.
Mask mask_above_fraction(const std::vector<float>& image, double fraction);

/// Intersection over union of a mask with a true one; empty when either is.
///
/// A pixel of which any part is foreground is rightly in the mask; one that is left out is missed
/// by the part of it that is foreground.
std::optional<double> mask_iou(const Mask& mask, const Covered& truth);

/// The mask of an image that a threshold cuts out.
struct ThresholdedMask {
    double iou = 0.0;       ///< intersection over union with the truth
    double fraction = 0.0;  ///< the least value in the mask, of the image's largest
};

/// The largest intersection over union that any threshold on `image` reaches, found exactly.
///
/// image    one value per pixel
/// truth    what to reach, as many pixels; see mask_iou()
/// returns  iou in (0, 1]; empty when the mask is empty or no value is positive
std::optional<ThresholdedMask> best_mask(const std::vector<float>& image, const Covered& truth);

/// The image divided by its largest value, negative values set to 0; empty when none is positive.
std::optional<std::vector<double>> normalised(const std::vector<float>& image);

/// Peak signal-to-noise ratio of images on [0, 1] [dB]; empty for equal images (it is infinite) and
/// for images without pixels.
std::optional<double> psnr_db(const std::vector<double>& a, const std::vector<double>& b);

/// Mean structural similarity of images on [0, 1], over all windows that fit into the image.
///
/// a, b           stored with `columns` fastest
/// rows, columns  size of both images
/// returns        in [-1, 1]; empty when an 11 x 11 window does not fit
/// source         [Wang2004]: Gaussian windows 11 x 11 of sigma 1.5, K1 = 0.01, K2 = 0.03
std::optional<double> ssim(const std::vector<double>& a,
                           const std::vector<double>& b,
                           std::size_t rows,
                           std::size_t columns);

/// Sum of squared differences over the sum of squares of the reference; empty when that is 0.
std::optional<double> relative_mse(std::span<const float> result, std::span<const float> reference);

}  // namespace nlos
