// SPDX-License-Identifier: MIT
#include "renderer/pass_plan.h"

#include <algorithm>
#include <limits>

namespace renderer {
namespace {

constexpr int kMinPasses = 8;  // for a mean error of all bins
constexpr int kMaxSamplesPerPass = 16384;
// Of images, whose passes share light subpaths, and for a variance of each bin, which takes many
// passes.
constexpr int kMaxSamplesPerShortPass = 256;
constexpr double kMaxPathsPerPass = 1 << 25;  // some seconds, after which the caller may stop

/// How open-ended renders find the length of their passes.
struct OpenEnded {
    int samples_per_pass = 32;  ///< of the first ones
    double passes = 32.0;       ///< expected
    double least_growth = 4.0;  ///< then the first ones are at most a sixteenth of the work
    double most_growth = 8.0;
};

/// Of even samples an error may take few passes.
OpenEnded open_ended(bool is_even) {
    return is_even ? OpenEnded{64, kPilotPasses, 2.0, 8.0} : OpenEnded{};
}

constexpr int kWithoutEnd = std::numeric_limits<int>::max();

int ceil_div(int a, int b) {
    return (a - 1) / b + 1;
}

// Multiples of 4 split into the path tracer's two kinds of samples without rounding noise.
int round_up_to_kinds(int samples) {
    return samples > 4 ? 4 * ceil_div(samples, 4) : samples;
}

int max_samples_per_pass(const core::Scan& scan, const RenderSettings& settings) {
    if (!scan.has_wall() || settings.variance) return kMaxSamplesPerShortPass;
    const double fit = kMaxPathsPerPass / static_cast<double>(scan.num_pairs());
    return static_cast<int>(std::clamp<double>(fit, kMaxSamplesPerShortPass, kMaxSamplesPerPass));
}

}  // namespace

bool is_open_ended(const RenderSettings& settings) {
    return settings.seconds || settings.target_error;
}

PassPlan plan_passes(const core::Scan& scan, const RenderSettings& settings, bool is_even) {
    if (is_open_ended(settings)) return {open_ended(is_even).samples_per_pass, kWithoutEnd};
    const int passes =
        std::max(kMinPasses, ceil_div(settings.samples, max_samples_per_pass(scan, settings)));
    const int per_pass = round_up_to_kinds(ceil_div(settings.samples, passes));
    return {per_pass, ceil_div(settings.samples, per_pass)};
}

std::optional<PassPlan> plan_longer_passes(const core::Scan& scan,
                                           const RenderSettings& settings,
                                           bool is_even,
                                           int samples_per_pass,
                                           double fraction) {
    const OpenEnded rules = open_ended(is_even);
    const double now = samples_per_pass;
    const double expected = now * kPilotPasses / fraction;
    const double longer = std::min({expected / rules.passes,
                                    rules.most_growth * now,
                                    static_cast<double>(max_samples_per_pass(scan, settings))});
    if (longer < rules.least_growth * now) return std::nullopt;
    return PassPlan{round_up_to_kinds(static_cast<int>(longer)), kWithoutEnd};
}

}  // namespace renderer
