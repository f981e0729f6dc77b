// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/observed_bins.h"
#include "renderer/core/capture/scan.h"
#include "renderer/core/capture/time_axis.h"
#include "renderer/core/capture/transient.h"
#include "renderer/core/capture/velocity_axis.h"
#include "renderer/core/settings/boxed_json.h"
#include "renderer/core/settings/settings.h"
#include "renderer/core/types.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace core {

/// What the numbers of a histogram are.
enum class TransientUnit { Radiance, Counts };

template <>
struct EnumNames<TransientUnit> {
    static constexpr auto value = names_from_zero<TransientUnit>("radiance", "counts");
};

/// Frames of a gate and of objects that move on from one to the next.
struct FrameSequence {
    std::vector<Transient> frames;         ///< the last one is the capture's own transient
    double gate_step_m = 0.0;              ///< by which the time axis moved per frame
    double frame_s = 0.0;                  ///< in which objects moved on per frame
    std::vector<ObservedBins> observed{};  ///< of each frame; empty: all have those of the capture
    /// Relative L2 over all of each frame that its estimate reports, NaN: not known; empty: of
    /// none.
    std::vector<double> errors{};
};

/// What a detector recorded, or a renderer computed: transients and where they belong.
struct Capture {
    Scan scan;
    TimeAxis time_axis;
    Transient transient;                ///< (num_pairs, num_bins)
    ObservedBins observed;              ///< all bins hold 0 elsewhere
    std::optional<Transient> variance;  ///< of each value of `transient`, when known
    TransientUnit unit = TransientUnit::Radiance;
    std::optional<double> counts_per_radiance;  ///< when counts stem from known radiance
    std::vector<int> orders;          ///< bounce orders of `by_order`; empty when not resolved
    std::vector<Transient> by_order;  ///< one per entry of `orders`; they sum to `transient`
    std::optional<VelocityHistogram> velocity;  ///< the same light by path velocity
    std::optional<FrameSequence> sequence;      ///< whose last frame the rest is about

    BoxedJson scene_info;            ///< free dictionary: settings echo, version, seed, ...
    std::vector<std::string> notes;  ///< what the reader assumed or changed; shown by `nlos info`

    /// The bins in which the detector could record this pair.
    BinRange observed_range(std::size_t pair) const {
        return core::observed_range(observed, pair, time_axis.num_bins);
    }
    /// The observed bins of a frame of the sequence; of a capture without one, its own.
    const ObservedBins& observed_in_frame(std::size_t frame) const {
        const bool has_own = sequence && !sequence->observed.empty();
        return has_own ? sequence->observed[frame] : observed;
    }
    /// What a pair's histogram holds in these bins.
    std::span<const float> observed_values(std::size_t pair) const {
        const BinRange range = observed_range(pair);
        return transient.histogram(pair).subspan(static_cast<std::size_t>(range.begin),
                                                 static_cast<std::size_t>(range.size()));
    }
};

/// Visits all histograms by path length: what they are called, their values, and how many time axes
/// follow one another in each.
template <class AnyCapture, class Visit>
void for_each_transient(AnyCapture& capture, Visit&& visit) {
    visit("H", capture.transient, 1);
    if (capture.variance) visit("variance", *capture.variance, 1);
    for (auto& order : capture.by_order) visit("H_by_order", order, 1);
    if (capture.sequence) {
        for (auto& frame : capture.sequence->frames) visit("frames", frame, 1);
    }
    if (!capture.velocity || !capture.velocity->axis.with_time) return;
    const int num_velocities = capture.velocity->axis.num_bins;
    visit("velocity", capture.velocity->values, num_velocities);
    if (capture.velocity->variance) {
        visit("velocity_variance", *capture.velocity->variance, num_velocities);
    }
}

/// Visits the observed bins of a capture and, where frames have their own, of each frame.
template <class Visit>
void for_each_observed(Capture& capture, Visit&& visit) {
    if (capture.observed) visit(*capture.observed);
    if (!capture.sequence) return;
    for (ObservedBins& observed : capture.sequence->observed) {
        if (observed) visit(*observed);
    }
}

/// Throws Error unless points, pairs, bins and normals agree, every value is finite, and bins that
/// were not observed hold 0.
///
/// where   prefix of messages, usually the file's name
void validate(const Capture& capture, const std::string& where);

/// Declares that bins outside a range were not observed: sets them to 0 in all histograms and
/// intersects the range with what is said already. Histograms of velocity alone stay as they are.
///
/// Images keep no ranges: their bins outside hold 0, which is taken for darkness.
///
/// range    of all pairs, or one per pair, within the axis
/// throws   Error for a range that is not
void restrict_observed(Capture& capture, const BinRange& range);
void restrict_observed(Capture& capture, const std::vector<BinRange>& ranges);

}  // namespace core
