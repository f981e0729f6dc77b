// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>

namespace renderer {

/// One sample that stands for many candidates (source [Lin2022]).
///
/// Its contribution weight W is an unbiased estimate of one over the density with which it was
/// chosen: the mean of W f(sample) is the integral of f wherever the target value is positive.
template <class Sample>
struct Reservoir {
    Sample sample{};
    double target_value = 0.0;         ///< p-hat of the sample; 0: there is none
    double contribution_weight = 0.0;  ///< W
    double confidence = 0.0;           ///< how many frames' candidates it stands for

    bool empty() const { return !(target_value > 0.0); }
    /// The sample's estimate of the integral of the target function.
    double estimate() const { return target_value * contribution_weight; }
};

/// Chooses one of a stream of samples with probability proportional to resampling weights.
template <class Sample>
class ReservoirBuilder {
 public:
    /// Offers a sample.
    ///
    /// target_value        p-hat of the sample in the domain that is built for
    /// resampling_weight   its MIS weight times p-hat times its own contribution weight
    /// u                   uniform in [0, 1)
    void add(const Sample& sample, double target_value, double resampling_weight, double u) {
        if (!(resampling_weight > 0.0)) return;
        weight_sum_ += resampling_weight;
        if (u * weight_sum_ >= resampling_weight) return;
        sample_ = sample;
        target_value_ = target_value;
    }

    double weight_sum() const { return weight_sum_; }
    bool empty() const { return !(weight_sum_ > 0.0); }

    /// confidence   of the result
    /// scale        of the weight sum: one over the number of techniques that pairwise MIS adds up
    Reservoir<Sample> finish(double confidence, double scale = 1.0) const {
        Reservoir<Sample> result;
        result.confidence = confidence;
        if (empty()) return result;
        result.sample = sample_;
        result.target_value = target_value_;
        result.contribution_weight = scale * weight_sum_ / target_value_;
        return result;
    }

 private:
    Sample sample_{};
    double target_value_ = 0.0;
    double weight_sum_ = 0.0;
};

}  // namespace renderer
