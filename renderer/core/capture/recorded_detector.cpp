// SPDX-License-Identifier: MIT
#include "renderer/core/capture/recorded_detector.h"

#include "renderer/core/settings/json_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace core {
namespace {

// Provenance comes from anywhere: what is no object of ours counts as nothing.
const Json* detector_of(const Capture& capture) {
    if (!capture.scene_info->is_object()) return nullptr;
    const auto found = capture.scene_info->find("detector");
    return found != capture.scene_info->end() && found->is_object() ? &*found : nullptr;
}

double number_at(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_number() ? found->get<double>() : 0.0;
}

// A measured curve always matters: that is why it was measured.
bool matters(const ResponseSettings& response, double bin_width_m) {
    if (!response.curve.empty()) return true;
    const ResponseMoments m = moments(make_response(response, "response"));
    return std::max(std::sqrt(m.variance_m2), std::abs(m.mean_m)) > 0.5 * bin_width_m;
}

// Photons per pulse of the brightest pair: late ones hide behind as large a fraction of them.
double largest_fraction_of_pulses(const Capture& capture, double pulses) {
    double largest = 0.0;
    for (std::size_t pair = 0; pair < capture.transient.num_pairs(); ++pair) {
        const auto histogram = capture.transient.histogram(pair);
        largest = std::max(largest, std::accumulate(histogram.begin(), histogram.end(), 0.0));
    }
    return largest / pulses;
}

}  // namespace

std::string describe(const ResponseSettings& response) {
    if (!response.curve.empty()) return "a measured response (" + response.curve + ")";
    std::string text = fmt::format("a response of {:.4g} ps (FWHM)", response.jitter_fwhm_ps);
    if (response.tail_ps > 0.0) text += fmt::format(" with a tail of {:.4g} ps", response.tail_ps);
    return text;
}

std::string describe_spot(double fwhm_m) {
    return fmt::format("a spot of {:.3g} m on the wall (FWHM)", fwhm_m);
}

std::optional<ResponseSettings> recorded_response(const Capture& capture) {
    const Json* detector = detector_of(capture);
    if (detector == nullptr) return std::nullopt;
    const auto described = detector->find("response");
    if (described == detector->end() || !described->is_object()) return std::nullopt;
    ResponseSettings response;
    response.jitter_fwhm_ps = std::max(0.0, number_at(*described, "jitter_fwhm_ps"));
    response.tail_ps = std::max(0.0, number_at(*described, "tail_ps"));
    if (const auto curve = described->find("curve");
        curve != described->end() && curve->is_string()) {
        response.curve = curve->get<std::string>();
    }
    if (!is_given(response)) return std::nullopt;
    return response;
}

std::optional<double> recorded_spot_m(const Capture& capture) {
    const Json* detector = detector_of(capture);
    const double spot_m = detector != nullptr ? number_at(*detector, "spot_m") : 0.0;
    return spot_m > 0.0 ? std::optional(spot_m) : std::nullopt;
}

ResponseSettings resolve_response(const ResponseSettings& asked,
                                  const Capture& capture,
                                  const std::string& where) {
    const auto recorded = recorded_response(capture);
    if (asked.of_capture) {
        require(recorded.has_value(),
                where,
                "capture, whose provenance gives no response",
                "jitter_fwhm_ps, tail_ps or curve");
        return *recorded;
    }
    const bool is_open = !is_given(asked) && !asked.is_none;
    const bool counts = recorded && matters(*recorded, capture.time_axis.bin_width_m);
    return is_open && counts ? *recorded : asked;
}

ResponseSettings resolve_scene_response(const ResponseSettings& asked, const Capture& capture) {
    const Json::json_pointer jitter("/settings/detector/jitter_fwhm_ps");
    if (is_given(asked) || asked.is_none) return asked;
    ResponseSettings response;
    if (capture.scene_info->contains(jitter) && (*capture.scene_info)[jitter].is_number()) {
        response.jitter_fwhm_ps = (*capture.scene_info)[jitter].get<double>();
    }
    return response;
}

std::optional<std::string> detector_warning(const Capture& capture) {
    constexpr double kNotablePileUp = 0.05;
    const Json* detector = detector_of(capture);
    const double pulses = detector != nullptr ? number_at(*detector, "pulses") : 0.0;
    const double fraction = pulses > 0.0 ? largest_fraction_of_pulses(capture, pulses) : 0.0;
    if (fraction <= kNotablePileUp) return std::nullopt;
    return fmt::format(
        "the detector was blind after photons, up to {:.2g} per pulse: early light "
        "hides late light (pile-up), which is not modelled",
        fraction);
}

}  // namespace core
