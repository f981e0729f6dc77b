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
constexpr int kSamplesPerPilotPass = 32;
constexpr double kPassesAfterPilot = 32.0;  // expected; even samples need fewer for an error
constexpr int kLeastGrowth = 4;             // then the pilot is at most a sixteenth of the work
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

PassPlan plan_passes(const core::Scan& scan, const RenderSettings& settings) {
    if (is_open_ended(settings)) return {kSamplesPerPilotPass, kWithoutEnd};
    const int passes =
        std::max(kMinPasses, ceil_div(settings.samples, max_samples_per_pass(scan, settings)));
    const int per_pass = round_up_to_kinds(ceil_div(settings.samples, passes));
    return {per_pass, ceil_div(settings.samples, per_pass)};
}

std::optional<PassPlan> plan_after_pilot(const core::Scan& scan,
                                         const RenderSettings& settings,
                                         double fraction) {
    const double expected = kSamplesPerPilotPass * kPilotPasses / fraction;
    const double per_pass =
        std::min<double>(expected / kPassesAfterPilot, max_samples_per_pass(scan, settings));
    if (per_pass < kLeastGrowth * kSamplesPerPilotPass) return std::nullopt;
    return PassPlan{round_up_to_kinds(static_cast<int>(per_pass)), kWithoutEnd};
}

}  // namespace renderer
