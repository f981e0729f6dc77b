// SPDX-License-Identifier: MIT
#include "nlos/preparation/slip_recognition.h"

#include "nlos/preparation/histogram_sample.h"
#include "renderer/core/scan_extent.h"

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

constexpr double kWellExplained = 0.1;     // no questions are asked
constexpr double kDecisive = 1.35;         // by which the description must explain less
constexpr double kMostUnexplained = 0.55;  // by a slip that is named
constexpr double kHopeless = 2.0;          // share of a slip that is tried no further
constexpr double kTie = 1.25;              // slips that explain so much alike are all named
constexpr std::size_t kMostNamed = 2;

// A free time zero explains nearly everything a little better.
constexpr double kGuessedZero = 1.5;
constexpr double kZeroIsAsked = 0.2;

/// First lengths of light, as shares of the wall's extent, to which time zero may have to move.
constexpr std::array kFirstLengths{0.3, 0.5, 0.8, 1.2, 1.8, 2.6, 4.0};
constexpr int kShiftRefinements = 3;

class Trial {
 public:
    Trial(const core::Capture& capture, const HistogramSample& sample)
        : capture_(capture), sample_(sample) {}

    CorrectionShare operator()(const CaptureCorrection& correction) const {
        const PathGeometry geometry = corrected_geometry(capture_, sample_, correction);
        return {correction, unexplained_share(sample_, geometry, kHopeless)};
    }

    CorrectionShare shifted(double shift_m) const {
        CaptureCorrection correction;
        correction.shift_m = shift_m;
        return (*this)(correction);
    }

    /// The best time zero near `start`, between its neighbours `step_m` away.
    CorrectionShare refined(CorrectionShare start, double step_m) const {
        for (int i = 0; i < kShiftRefinements; ++i) {
            step_m *= 0.5;
            const double middle_m = start.correction.shift_m;
            for (const double shift_m : {middle_m - step_m, middle_m + step_m}) {
                const CorrectionShare other = shifted(shift_m);
                if (other.unexplained < start.unexplained) start = other;
            }
        }
        return start;
    }

 private:
    const core::Capture& capture_;
    const HistogramSample& sample_;
};

double extent_m(const core::Capture& capture) {
    const core::ScanExtent extent = core::scan_extent(capture.scan);
    return std::hypot(extent.size_m[0], extent.size_m[1]);
}

/// The best guess of time zero, whatever the slip that moved it.
CorrectionShare best_shift(const core::Capture& capture,
                           const HistogramSample& sample,
                           const Trial& trial) {
    const PathGeometry geometry = corrected_geometry(capture, sample, {});
    const double first_m =
        geometry.opl_start_m - *std::min_element(geometry.legs_m.begin(), geometry.legs_m.end());
    const double wall_m = extent_m(capture);
    CorrectionShare best;
    double step_m = 0.0;
    double before_m = 0.0;
    for (const double share : kFirstLengths) {
        const CorrectionShare next = trial.shifted(share * wall_m - first_m);
        if (next.unexplained < best.unexplained) {
            best = next;
            step_m = share * wall_m - before_m;
        }
        before_m = share * wall_m;
    }
    return step_m > 0.0 ? trial.refined(best, step_m) : best;
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
    if (evidence.given < kWellExplained) return evidence;
    for (const CaptureCorrection& correction : possible_corrections(capture, *sample)) {
        evidence.corrections.push_back(trial(correction));
    }
    if (direct && std::abs(direct->offset_m) > 2.0 * capture.time_axis.bin_width_m) {
        evidence.corrections.push_back(trial.shifted(-direct->offset_m));
    } else if (!direct && evidence.given > kZeroIsAsked && is_in_proportion(capture, *sample, {})) {
        CorrectionShare shift = best_shift(capture, *sample, trial);
        shift.unexplained *= kGuessedZero;
        evidence.corrections.push_back(shift);
    }
    return evidence;
}

std::vector<CaptureCorrection> recognise_slips(const SlipEvidence& evidence) {
    std::vector<CorrectionShare> best = evidence.corrections;
    std::ranges::stable_sort(best, {}, &CorrectionShare::unexplained);
    if (best.empty() || evidence.given < kWellExplained ||
        best.front().unexplained > kMostUnexplained ||
        evidence.given < kDecisive * best.front().unexplained) {
        return {};
    }
    std::vector<CaptureCorrection> named;
    for (const CorrectionShare& candidate : best) {
        if (candidate.unexplained > kTie * best.front().unexplained) break;
        if (named.size() < kMostNamed) named.push_back(candidate.correction);
    }
    return named;
}

}  // namespace nlos
