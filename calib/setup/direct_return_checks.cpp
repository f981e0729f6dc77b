// SPDX-License-Identifier: MIT
#include "calib/setup/direct_return_checks.h"

#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

void require_light(std::span<const float> histogram, std::size_t point) {
    const std::string where = fmt::format("direct_returns: point {}", point);
    const auto [least, most] = std::minmax_element(histogram.begin(), histogram.end());
    if (*least < 0.0F) {
        throw core::Error(where,
                          fmt::format("found {:.6g} in bin {}", *least, least - histogram.begin()),
                          "must hold counts, at least 0, from which no background was subtracted");
    }
    if (!(*most > 0.0F)) {
        throw core::Error(where, "found no light", "every histogram must hold its direct return");
    }
}

/// The longest run of bins that hold a value.
int longest_run(std::span<const float> histogram, float value) {
    int longest = 0;
    int run = 0;
    for (const float one : histogram) {
        run = one == value ? run + 1 : 0;
        longest = std::max(longest, run);
    }
    return longest;
}

}  // namespace

void require_peaks(const core::Capture& capture) {
    constexpr int kFlatTop = 3;  // bins; counts that scatter hardly ever agree in as many
    const std::size_t count = capture.transient.num_pairs();
    float top = 0.0F;
    for (std::size_t p = 0; p < count; ++p) {
        const auto histogram = capture.transient.histogram(p);
        require_light(histogram, p);
        top = std::max(top, *std::max_element(histogram.begin(), histogram.end()));
    }
    std::size_t num_flat = 0;
    int longest = 0;
    for (std::size_t p = 0; p < count; ++p) {
        const int run = longest_run(capture.transient.histogram(p), top);
        if (run >= kFlatTop) ++num_flat;
        longest = std::max(longest, run);
    }
    if (2 * num_flat <= count) return;
    throw core::Failure(
        "direct_returns",
        fmt::format("{} of {} peaks are clipped: they are flat at {:.6g} over {} bins and more, up "
                    "to {}, so that their places cannot be told; record with less light",
                    num_flat,
                    count,
                    top,
                    kFlatTop,
                    longest));
}

std::vector<std::string> peak_warnings(const core::Capture& capture,
                                       const DirectReturns& result,
                                       double scatter) {
    constexpr double kBeyondChance = 5.0;  // standard deviations
    constexpr double kNotableExcess = 1.5;
    constexpr double kWidest_m = 1.0;  // standard deviation: 8 ns (FWHM)
    std::vector<std::string> warnings;
    if (result.sigma_m > kWidest_m) {
        warnings.push_back(fmt::format(
            "the peaks are {:.3g} ps wide (FWHM), as no pulse is: the time axis may be in other "
            "units than metres of path length; capture.bin_width_m and capture.opl_shift_m "
            "replace what the file says",
            result.sigma_m / core::sigma_m_from_fwhm_ps(1.0)));
    }
    const auto values = capture.transient.values();
    if (!std::ranges::all_of(values, [](float value) { return value == std::floor(value); })) {
        warnings.emplace_back(
            "direct_returns hold numbers that are not whole: reported errors are those of as many "
            "counted photons");
    }
    const double excess = result.deviance - result.expected_deviance;
    if (excess > kBeyondChance * scatter &&
        result.deviance > kNotableExcess * result.expected_deviance) {
        warnings.push_back(fmt::format(
            "the deviance of the peaks, {:.4g}, is far above the {:.4g} that counting explains: "
            "they do not have the shape of response={}, or the detector was blind after photons "
            "(pile-up)",
            result.deviance,
            result.expected_deviance,
            core::enum_name(result.shape)));
    }
    return warnings;
}

}  // namespace calib
