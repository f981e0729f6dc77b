// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/fourier/fft.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/capture/time_axis.h"
#include "renderer/core/capture/transient.h"

#include <complex>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace nlos {

/// Ambient light of a capture and where its signal ends.
struct SignalExtent {
    std::vector<double> ambient_per_bin;  ///< per pair
    double photon =
        1.0;          ///< what one adds: 1 to counts, else the dark segments' variance over mean
    int end_bin = 0;  ///< bins from here on hold nothing but ambient light
    bool has_background = false;   ///< it is there, and the same in all of its segments
    int begin_bin = 0;             ///< the first that any pair observed or holds something in
    bool reaches_the_end = false;  ///< the signal lasts as long as the observed bins
};

/// Finds constant background light and the end of the signal.
///
/// Of 32 segments of the axis, the quarter that is darkest over all pairs gives each pair's ambient
/// level. Left out are zeroed bins at the axis's start, and those at its end where a background
/// ends at once: nobody looked there. The signal ends with the last segment whose sum over all
/// pairs exceeds the ambient light by 5 standard deviations and by 1 % of the strongest segment:
/// noise behind it would be raised by range^4 and outshine the scene. The noise of counts is
/// Poisson's; that of other values is told from the dark segments.
///
/// Bins that were not observed count nowhere: the segments share the bins that were, sums are
/// scaled to full sight, and a pair that saw less than one dark segment takes the others' level.
///
/// returns   nothing when the axis is too short to tell (fewer than 64 filled bins)
/// throws    nothing
std::optional<SignalExtent> find_signal(const core::Transient& transient,
                                        const core::ObservedBins& observed = std::nullopt,
                                        core::TransientUnit unit = core::TransientUnit::Counts);

/// Light of all pairs in each bin, of those that observed it.
///
/// observed     per pair, null: all bins
/// background   per bin of each pair, taken off; empty: none
std::vector<double> light_per_bin(const core::Transient& transient,
                                  const std::vector<core::BinRange>* observed,
                                  const std::vector<double>& background);

/// Takes a set-up's response off histograms: a Wiener filter along time.
///
/// Where the response lets through the fraction R of a frequency's amplitude, the filter multiplies
/// by conj(R) / (|R|^2 + floor^2): by 1/R where |R| is well above the floor, and never by more than
/// 1 / (2 floor), which is how much it may raise noise. Delays are undone along with the blur, so
/// that light of a response with a tail comes to lie at its length.
///
/// source   [Wiener1949]
class ResponseDeconvolution {
 public:
    /// filter     response on the histograms' axis
    /// num_bins   of a histogram
    /// floor      positive; about the ratio of noise to signal, as amplitudes
    ResponseDeconvolution(const core::ResponseFilter& filter, std::size_t num_bins, double floor);

    /// factors    that frequencies are multiplied by, from 0 to the highest of transforms whose
    ///            length is twice a good_fft_size() of at least num_bins
    /// num_bins   of a histogram
    ResponseDeconvolution(const std::vector<std::complex<double>>& factors, std::size_t num_bins);

    /// Replaces a histogram of num_bins by what it would be without the response; nothing is taken
    /// from beyond its ends. Bins may become negative. Safe to call from several threads.
    void apply(std::span<double> histogram) const;

 private:
    std::size_t num_bins_;
    std::size_t length_;  ///< of transforms
    Fft forward_;
    Fft inverse_;
    std::vector<ComplexF> factors_;  ///< per frequency, the transforms' scale included
};

/// Raised cosines at the ends of histograms, which a transform would take for edges of the scene.
struct Taper {
    int begin_bin = 0;     ///< where observation begins, for pairs of which nothing else is known
    int opening_bins = 0;  ///< length behind the first observed bin
    int end_bins = 0;      ///< length before the last
};

/// What to do to histograms before a method sees them.
struct PreparationPlan {
    int merge_bins = 1;
    int num_bins = 0;                     ///< after merging; later bins are dropped
    std::vector<double> ambient_per_bin;  ///< per pair, before merging; empty: none
    /// Of histograms of the capture's length, null: none.
    std::shared_ptr<const ResponseDeconvolution> deconvolution = nullptr;
    core::ObservedBins observed = std::nullopt;  ///< before merging
    Taper taper = {};                            ///< likewise
    std::optional<double> photon = {};           ///< of radiance, what a photon adds to a value

    /// The bins of a prepared histogram that were observed, each of them as a whole.
    core::BinRange prepared_range(std::size_t pair) const {
        if (!observed) return {0, num_bins};
        return core::intersection(core::merged((*observed)[pair], merge_bins), {0, num_bins});
    }

    /// The axis of prepared histograms.
    core::TimeAxis prepared_axis(const core::TimeAxis& axis) const {
        return {axis.opl_start_m, merge_bins * axis.bin_width_m, num_bins};
    }
};

/// A histogram without ambient light, tapered, before anything else is done to it. Bins zeroed at
/// its start stay 0, as do those not observed.
std::vector<double> signal_of(const core::Transient& transient,
                              const PreparationPlan& plan,
                              std::size_t pair);

/// Takes off ambient light, tapers, takes off the set-up's response, adds up neighbouring bins and
/// drops those behind the plan's end. Bins zeroed at the start of a histogram stay 0, as do those
/// not observed; what was observed of a bin that was not as a whole is dropped.
core::Transient prepare_histograms(const core::Transient& transient, const PreparationPlan& plan);

/// The observed bins of prepared histograms.
core::ObservedBins prepared_observed(const PreparationPlan& plan);

/// Multiplies every bin by range^power, range being half its path length without device segments;
/// bins before the wall become 0. The power of the light's falloff makes equal scatterers equally
/// bright wherever they are, without moving them.
void multiply_by_range(const core::WallScan& scan,
                       const core::TimeAxis& axis,
                       double power,
                       core::Transient& transient);

}  // namespace nlos
