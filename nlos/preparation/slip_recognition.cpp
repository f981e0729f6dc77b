// SPDX-License-Identifier: MIT
#include "nlos/preparation/slip_recognition.h"

#include "nlos/preparation/histogram_sample.h"
#include "renderer/core/scan_extent.h"

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

constexpr double kWellExplained = 0.1;    // no questions are asked
constexpr double kFullyExplained = 0.03;  // nor about axes, which change lengths little
constexpr double kDecisive = 1.3;         // by which the description must explain less
constexpr double kOverwhelming = 4.0;     // the same for a slip that leaves much itself
constexpr double kMostUnexplained = 0.6;  // by a slip that is named
constexpr double kBrief = 0.25;           // of how late it is, for a direct return to fade in
constexpr double kHopeless = 2.0;         // share of a slip that is tried no further
constexpr double kTie = 1.25;             // slips that explain so much alike are all named
constexpr std::size_t kMostNamed = 2;

class Trial {
 public:
    Trial(const core::Capture& capture, const HistogramSample& sample)
        : capture_(capture), sample_(sample) {}

    CorrectionShare operator()(const CaptureCorrection& correction) const {
        const PathGeometry geometry = corrected_geometry(capture_, sample_, correction);
        return {correction, unexplained_share(sample_, geometry, kHopeless)};
    }

    /// With the direct return where it belongs. The light of a plane that faces the wall is equally
    /// late everywhere, too, but takes as long to fade as the plane is far.
    CorrectionShare shifted(const DirectReturn& direct) const {
        CaptureCorrection correction;
        correction.shift_m = -direct.offset_m;
        CorrectionShare share = (*this)(correction);
        share.is_seen = direct.fading_m < kBrief * std::abs(direct.offset_m);
        return share;
    }

 private:
    const core::Capture& capture_;
    const HistogramSample& sample_;
};

double extent_m(const core::Capture& capture) {
    const core::ScanExtent extent = core::scan_extent(capture.scan);
    return std::hypot(extent.size_m[0], extent.size_m[1]);
}

}  // namespace

std::optional<SlipEvidence> slip_evidence(const core::Capture& capture,
                                          const std::vector<double>& ambient) {
    if (capture.scan.camera || !(extent_m(capture) > 0.0)) return std::nullopt;
    const std::optional<DirectReturn> direct = find_direct_return(capture, ambient);
    const auto sample = sample_histograms(capture, ambient, direct);
    if (!sample || !has_structure(*sample)) return std::nullopt;

    const Trial trial(capture, *sample);
    SlipEvidence evidence;
    if (is_in_proportion(capture, *sample, {})) {
        evidence.given = unexplained_share(*sample, corrected_geometry(capture, *sample, {}));
    }
    if (direct && std::abs(direct->offset_m) > 2.0 * capture.time_axis.bin_width_m) {
        evidence.corrections.push_back(trial.shifted(*direct));
    }
    if (evidence.given < kFullyExplained) return evidence;
    for (const CaptureCorrection& correction : possible_corrections(capture, *sample)) {
        const bool moves_axes = correction.swap_xy || correction.flip_x || correction.flip_y;
        if (evidence.given < kWellExplained && !moves_axes) continue;
        evidence.corrections.push_back(trial(correction));
    }
    return evidence;
}

std::vector<CaptureCorrection> recognise_slips(const SlipEvidence& evidence) {
    std::vector<CorrectionShare> best = evidence.corrections;
    std::ranges::stable_sort(best, {}, &CorrectionShare::unexplained);
    std::vector<CaptureCorrection> named;
    for (const CorrectionShare& candidate : best) {
        const bool fits = candidate.unexplained < std::max(kMostUnexplained, evidence.given);
        if (candidate.is_seen && fits) named.push_back(candidate.correction);
    }
    if (best.empty() || evidence.given < kFullyExplained) return named;
    const double least = best.front().unexplained;
    const double decisive = least < kMostUnexplained ? kDecisive : kOverwhelming;
    if (least > 1.0 || evidence.given < decisive * least) return named;
    for (const CorrectionShare& candidate : best) {
        if (candidate.unexplained > std::max(kTie * least, kFullyExplained)) break;
        if (!candidate.is_seen && named.size() < kMostNamed) named.push_back(candidate.correction);
    }
    return named;
}

}  // namespace nlos
