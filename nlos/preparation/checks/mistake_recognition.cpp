// SPDX-License-Identifier: MIT
#include "nlos/preparation/checks/capture_correction.h"
#include "nlos/preparation/checks/scatter_fit.h"
#include "nlos/preparation/histogram_sample.h"
#include "renderer/core/capture/capture.h"

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

constexpr double kWellExplained = 0.1;    // no questions are asked
constexpr double kFullyExplained = 0.03;  // nor about axes, which change lengths little
constexpr double kDecisive = 1.3;         // by which the description must explain less
constexpr double kOverwhelming = 4.0;     // the same for a mistake that leaves much itself
constexpr double kReversal = 2.5;         // the same for reversed time
constexpr double kMostUnexplained = 0.6;  // by a mistake that is named
constexpr double kBrief = 0.25;           // of how late it is, for a direct return to fade in
constexpr double kPromising = 3.0;        // times the least fraction, up to which fits are refined
constexpr double kTie = 1.5;              // mistakes that explain so much alike are all named
constexpr std::size_t kMostNamed = 2;

/// With the direct return where it belongs. The light of a plane that faces the wall is equally
/// late everywhere, too, but takes as long to fade as the plane is far.
CorrectionFit shifted(const DirectReturn& direct) {
    CorrectionFit fit;
    fit.correction.shift_m = -direct.offset_m;
    fit.is_seen = direct.fading_m < kBrief * std::abs(direct.offset_m);
    return fit;
}

/// Fits what `evidence` lists: to the end where a fit is nowhere far behind the best.
void fit_corrections(const core::Capture& capture,
                     const HistogramSample& sample,
                     MistakeEvidence& evidence) {
    std::vector<ScatterFit> fits;
    for (const CorrectionFit& tried : evidence.corrections) {
        fits.emplace_back(sample, corrected_geometry(capture, sample, tried.correction));
    }
    for (int i = 0; i < ScatterFit::kRefinements && !fits.empty(); ++i) {
        const double least =
            std::ranges::min_element(fits, {}, &ScatterFit::unexplained)->unexplained();
        for (ScatterFit& fit : fits) {
            if (fit.unexplained() <= kPromising * least) fit.refine();
        }
    }
    for (std::size_t i = 0; i < fits.size(); ++i) {
        evidence.corrections[i].unexplained = fits[i].unexplained();
    }
}

/// How many times as much the description must leave unexplained. Light that spreads from all
/// around explains much of a plane's histograms backwards, so that only a great gain shows a
/// reversal.
double needed_gain(const CorrectionFit& fit) {
    if (fit.unexplained >= kMostUnexplained) return kOverwhelming;
    return fit.correction.flip_t ? kReversal : kDecisive;
}

double extent_m(const core::Capture& capture) {
    const core::ScanExtent extent = core::scan_extent(capture.scan.wall());
    return std::hypot(extent.size_m[0], extent.size_m[1]);
}

}  // namespace

std::optional<MistakeEvidence> mistake_evidence(const core::Capture& capture,
                                                const std::vector<double>& ambient) {
    if (!capture.scan.has_wall() || !(extent_m(capture) > 0.0)) return std::nullopt;
    const std::optional<DirectReturn> direct = find_direct_return(capture, ambient);
    const auto sample = sample_histograms(capture, ambient, direct);
    if (!sample || !has_structure(*sample)) return std::nullopt;

    MistakeEvidence evidence;
    if (is_in_proportion(capture, *sample, {})) {
        evidence.given = unexplained_fraction(*sample, corrected_geometry(capture, *sample, {}));
    }
    if (direct && std::abs(direct->offset_m) > 2.0 * capture.time_axis.bin_width_m) {
        evidence.corrections.push_back(shifted(*direct));
    }
    if (evidence.given >= kFullyExplained) {
        for (const CaptureCorrection& correction : possible_corrections(capture, *sample)) {
            const bool moves_axes = correction.swap_xy || correction.flip_x || correction.flip_y;
            if (evidence.given < kWellExplained && !moves_axes) continue;
            evidence.corrections.push_back({.correction = correction});
        }
    }
    fit_corrections(capture, *sample, evidence);
    return evidence;
}

std::vector<CaptureCorrection> recognise_mistakes(const MistakeEvidence& evidence) {
    std::vector<CorrectionFit> best = evidence.corrections;
    std::ranges::stable_sort(best, {}, &CorrectionFit::unexplained);
    std::vector<CaptureCorrection> named;
    for (const CorrectionFit& candidate : best) {
        const bool fits = candidate.unexplained < std::max(kMostUnexplained, evidence.given);
        if (candidate.is_seen && fits) named.push_back(candidate.correction);
    }
    if (evidence.given < kFullyExplained) return named;
    std::erase_if(best, [&](const CorrectionFit& c) {
        return c.unexplained > 1.0 || evidence.given < needed_gain(c) * c.unexplained;
    });
    for (const CorrectionFit& candidate : best) {
        const double least = best.front().unexplained;
        if (candidate.unexplained > std::max(kTie * least, kFullyExplained)) break;
        if (!candidate.is_seen && named.size() < kMostNamed) named.push_back(candidate.correction);
    }
    return named;
}

}  // namespace nlos
