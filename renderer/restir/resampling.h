// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

namespace renderer {

/// One sample that represents many candidates (source [Lin2022]).
///
/// Its contribution weight W is an unbiased estimate of the reciprocal of the density with which it
/// was chosen: the expectation of W f(sample) is the integral of f where the target is positive.
template <class Sample>
struct Reservoir {
    Sample sample{};
    double target_value = 0.0;         ///< p-hat of the sample; 0: there is none
    double contribution_weight = 0.0;  ///< W
    double confidence = 0.0;           ///< number of frames whose candidates it represents

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

/// A sample shifted into another domain.
template <class Sample>
struct Carried {
    Sample sample{};
    double target_value = 0.0;  ///< p-hat there, in that domain's measure
    double jacobian = 1.0;      ///< of the shift mapping
};

/// Weighs two domains' samples against each other by confidence times density: the generalised
/// balance heuristic m_i = c_i p_{<-i} / sum_j c_j p_{<-j} for two (source [Lin2022]).
///
/// own           c p-hat of the sample in the domain it comes from, per area there
/// foreign       c p-hat of its image in the other domain, per area there; 0 without an image
/// jacobian      of the map from its own domain to the other one
inline double balance_weight(double own, double foreign, double jacobian) {
    const double both = own + foreign * jacobian;
    return both > 0.0 ? own / both : 0.0;
}

/// Offers `other`'s sample, whose image in the canonical domain is `here`; that domain counts with
/// `canonical_confidence`. u: uniform in [0, 1).
template <class Sample>
void add_foreign(ReservoirBuilder<Sample>& builder,
                 const Reservoir<Sample>& other,
                 const std::optional<Carried<Sample>>& here,
                 double canonical_confidence,
                 double u) {
    if (other.empty() || !here || !(here->target_value > 0.0)) return;
    const double weight = balance_weight(other.confidence * other.target_value,
                                         canonical_confidence * here->target_value,
                                         here->jacobian);
    builder.add(here->sample,
                here->target_value,
                weight * here->target_value * other.contribution_weight * here->jacobian,
                u);
}

/// Merges the reservoirs of two domains by the generalised balance heuristic.
///
/// canonical     of the domain that is built for
/// other         of another domain, its confidence already capped
/// here          image of `other`'s sample in the canonical domain; nothing if it has none
/// there         image of `canonical`'s sample in the other domain; likewise
/// u1, u2        uniform in [0, 1)
template <class Sample>
Reservoir<Sample> resample_balance_heuristic(const Reservoir<Sample>& canonical,
                                             const Reservoir<Sample>& other,
                                             const std::optional<Carried<Sample>>& here,
                                             const std::optional<Carried<Sample>>& there,
                                             double u1,
                                             double u2) {
    ReservoirBuilder<Sample> builder;
    if (!canonical.empty()) {
        const double own = canonical.confidence * canonical.target_value;
        const double weight =
            there ? balance_weight(own, other.confidence * there->target_value, there->jacobian)
                  : 1.0;
        builder.add(canonical.sample, canonical.target_value, weight * canonical.estimate(), u1);
    }
    add_foreign(builder, other, here, canonical.confidence, u2);
    return builder.finish(canonical.confidence + other.confidence);
}

/// Merges a canonical reservoir with neighbours whose number was fixed before any sample was
/// known, by defensive pairwise MIS (source [Bitterli2022], weights as in [Lin2022]).
///
/// A neighbour without a sample, or whose sample cannot be shifted, still counts: its part goes to
/// the canonical sample. Counting only successful shifts would be biased.
template <class Sample>
class PairwiseMisMerge {
 public:
    using Carry = std::optional<Carried<Sample>>;

    PairwiseMisMerge(const Reservoir<Sample>& canonical, int num_neighbours)
        : canonical_(canonical),
          num_neighbours_(num_neighbours),
          canonical_fraction_(num_neighbours > 0 ? canonical.confidence / num_neighbours : 0.0) {}

    /// here    image of the neighbour's sample in the canonical domain, nothing if it has none
    /// there   image of the canonical sample in the neighbour's domain, likewise
    /// u       uniform in [0, 1)
    void add_neighbour(const Reservoir<Sample>& neighbour,
                       const Carry& here,
                       const Carry& there,
                       double u) {
        if (!canonical_.empty()) {
            const double own = canonical_fraction_ * canonical_.target_value;
            canonical_weight_ +=
                there ? balance_weight(
                            own, neighbour.confidence * there->target_value, there->jacobian)
                      : 1.0;
        }
        add_foreign(builder_, neighbour, here, canonical_fraction_, u);
    }

    /// The result counts as many frames as the canonical reservoir: neighbours know no others.
    ///
    /// u   uniform in [0, 1)
    Reservoir<Sample> finish(double u) {
        builder_.add(canonical_.sample,
                     canonical_.target_value,
                     canonical_weight_ * canonical_.estimate(),
                     u);
        return builder_.finish(canonical_.confidence, 1.0 / (num_neighbours_ + 1.0));
    }

 private:
    const Reservoir<Sample>& canonical_;
    int num_neighbours_;
    double canonical_fraction_;  ///< M_c / N
    double canonical_weight_ = 1.0;
    ReservoirBuilder<Sample> builder_;
};

}  // namespace renderer
