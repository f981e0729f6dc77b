// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/preparation/prepared_capture.h"
#include "nlos/reconstruction/reconstruct_settings.h"
#include "nlos/reconstruction/surface.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace nlos {

/// What a method needs of a capture beside kMinBins.
struct MethodNeeds {
    std::string_view text;              ///< in words, as in "at least 4 sensing points"
    std::string_view met;               ///< what a capture then is
    bool takes_other_patterns = false;  ///< as convert_to_confocal() leaves them
    /// What stands in the way; empty: nothing.
    std::string (*obstacle)(const PreparedCapture& prepared, const VolumeSettings& volume);
};

/// How sure a method's volumes are. Fits random surfaces, see reconstruction/README.md: there is no
/// default, as no method's errors are another's.
struct MethodErrors {
    VolumeErrors noisy;  ///< where the noise is known; `front` is that of confocal grids
    /// Without noise. It makes dim columns of its own: where there may be any, all columns are held
    /// against the brightest surfaces alone.
    PlateauFractions noiseless_plateau;

    constexpr MethodErrors(const VolumeErrors& with_noise, const PlateauFractions& without)
        : noisy(with_noise), noiseless_plateau(without) {}
};

/// The transforms and sums that a method cannot do without: the lower limit of its time.
struct LeastWork {
    std::size_t row_length = 0;                          ///< of transforms along time or depth
    std::size_t rows_forward = 0, rows_inverse = 0;      ///< real ones
    std::size_t complex_rows = 0;                        ///< likewise, inverse
    std::size_t planes_forward = 0, planes_inverse = 0;  ///< of the wall's points, padded to twice
    std::size_t filled_planes = 0;                       ///< of that size, forward
    std::size_t even_planes = 0;                         ///< of that size, known by a quadrant
    double multiply_adds = 0.0;                          ///< two of each histogram and voxel
};

/// How light falls off with range, and why, for people.
struct FalloffChoice {
    Falloff falloff = Falloff::Diffuse;
    std::string reason;
};

/// When to ask the data how light falls off.
enum class FalloffTrial { WhereNeeded, Always };

/// A reconstruction method: what it computes, and what others must know of it. A new one has a row
/// in its own file, which reconstruction/method.h lists.
struct MethodTraits {
    /// settings    with what the method takes from them filled in
    /// num_slabs   of its work, done one after another: the result is the same up to rounding,
    ///             memory shrinks, and a part of the work is repeated for each
    /// throws      core::Failure when asked to stop
    using Run = Volume(const MethodInput& input,
                       const ReconstructSettings& settings,
                       std::size_t num_slabs);
    /// Memory that it takes on top of its input, its volume included [bytes].
    using Bytes = double(const MethodInput& input,
                         const ReconstructSettings& settings,
                         std::size_t num_slabs);

    Method method;
    std::string_view meaning;   ///< what it computes, for people
    std::string_view captures;  ///< that it serves, for people
    Run& run;
    Bytes& bytes;
    MethodErrors errors;
    const MethodNeeds* needs = nullptr;  ///< null: serves every capture

    bool explains_response = false;    ///< the set-up's, which is then not taken off histograms
    bool explains_background = false;  ///< likewise
    bool explains_gaps = false;        ///< leaves out bins that were not observed
    bool propagates_wave = false;      ///< of settings.phasor
    bool has_wiener_filter = false;    ///< of settings.snr
    bool knows_facing = false;         ///< models falloff=facing
    bool gives_way_to_prior = false;   ///< with prior=tv kStatisticalMethod runs instead

    /// Asks the histograms how light falls off; null, and nothing: they do not tell.
    std::optional<FalloffChoice> (*choose_falloff)(const MethodInput& input,
                                                   const ReconstructSettings& settings,
                                                   FalloffTrial trial) = nullptr;
    /// On a grid; null: of methods that iterate.
    LeastWork (*least_work)(const MethodInput& input,
                            const ReconstructSettings& settings) = nullptr;
    /// The row of other settings than the usual ones; null: there are none.
    const MethodTraits& (*variant)(const ReconstructSettings& settings) = nullptr;
};

/// The row of a method other than Auto, with its usual settings.
inline const MethodTraits& traits_of(Method method) {
    return *kMethods[static_cast<std::size_t>(method) - 1];
}
inline const MethodTraits& traits_of(const ReconstructSettings& settings) {
    const MethodTraits& traits = traits_of(settings.method);
    return traits.variant ? traits.variant(settings) : traits;
}

/// A scan on an even planar grid with columns of voxels at its points, confocal or convertible.
extern const MethodNeeds kConfocalGrid;

/// A method and why it was taken.
struct MethodChoice {
    Method method;
    std::string reason;
};

/// Chooses the method for `auto`, or checks that the one set can serve. Single and exhaustive
/// measurements are converted in place when a method that needs it was asked for.
///
/// throws   core::Error when the method set cannot serve; names one that can
MethodChoice choose_method(const ReconstructSettings& settings, PreparedCapture& prepared);

/// The method that serves without iterating, the first of kPreferredMethods.
Method direct_method(const PreparedCapture& prepared, const VolumeSettings& volume);

/// What a method that works by transforms makes of bins that were not observed, for people; nothing
/// for other methods, which leave them out.
///
/// settings   whose method is chosen
/// num_bins   of a histogram
std::optional<std::string> unobserved_warning(const ReconstructSettings& settings,
                                              const core::ObservedBins& observed,
                                              int num_bins);

/// Says of few pairs of wall points, and of points too near each other or in a row, that they tell
/// distances rather than directions; nothing of others.
std::optional<std::string> directions_warning(const PreparedCapture& prepared);

}  // namespace nlos
