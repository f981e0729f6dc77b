// SPDX-License-Identifier: MIT
#include "renderer/core/capture/instrument_response.h"

#include "renderer/core/mapped_file.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/parallel.h"

#include <fmt/core.h>

#include <cassert>
#include <functional>
#include <numeric>
#include <sstream>

namespace core {
namespace {

constexpr double kGaussianReach = 8.0;      // standard deviations; 1e-15 of the light is beyond
constexpr double kExponentialReach = 30.0;  // means; 1e-13 of the light is beyond

double opl_from_ps(double ps) {
    return opl_from_seconds(ps * 1e-12);
}

/// Reads lines of a delay [ps] and a weight; lines that start with # are comments.
MeasuredResponse read_curve(const std::string& path) {
    constexpr std::size_t kMaxLines = std::size_t{1} << 20;
    const MappedFile file(path, "must be a readable text file");
    file.require_stored();
    std::istringstream lines{std::string(file.bytes())};
    MeasuredResponse response;
    std::string line;
    for (std::size_t number = 1; std::getline(lines, line); ++number) {
        const std::size_t begin = line.find_first_not_of(" \t\r");
        if (begin == std::string::npos || line[begin] == '#') continue;
        std::istringstream fields(line);
        double delay_ps = 0.0;
        double weight = 0.0;
        fields >> delay_ps >> weight;
        const bool ascends =
            response.delays_m.empty() || opl_from_ps(delay_ps) > response.delays_m.back();
        if (!fields || !std::isfinite(delay_ps) || !std::isfinite(weight) || weight < 0.0 ||
            !ascends || number > kMaxLines) {
            throw Error(fmt::format("{} line {}", path, number),
                        "found '" + line.substr(0, 40) + "'",
                        "must be a delay [ps] above the last one and a weight of at least 0");
        }
        response.delays_m.push_back(opl_from_ps(delay_ps));
        response.weights.push_back(weight);
    }
    const double sum = std::accumulate(response.weights.begin(), response.weights.end(), 0.0);
    if (!(sum > 0.0) || !std::isfinite(sum)) {
        throw Error(path, "holds no weight above 0", "must be a delay [ps] and a weight per line");
    }
    for (double& weight : response.weights) weight /= sum;
    return response;
}

/// Weights of the delays from `low_m` to `high_m`. With the triangle of linear interpolation
/// L(x) = max(0, 1 - |x|) the weight of k bins is the expectation of L(delay / w - k): the second
/// difference of `ramp`(u), the expectation of max(0, u - delay).
ResponseFilter sample_ramp(const std::function<double(double)>& ramp,
                           double low_m,
                           double high_m,
                           double bin_width_m) {
    ResponseFilter filter;
    filter.first_delay = static_cast<int>(std::floor(low_m / bin_width_m));
    const int last = static_cast<int>(std::ceil(high_m / bin_width_m));
    const auto at = [&](int bin) { return ramp(bin * bin_width_m); };
    for (int k = filter.first_delay; k <= last; ++k) {
        const double weight = (at(k + 1) - 2.0 * at(k) + at(k - 1)) / bin_width_m;
        filter.weights.push_back(std::max(0.0, weight));
    }
    const double sum = std::accumulate(filter.weights.begin(), filter.weights.end(), 0.0);
    for (double& weight : filter.weights) weight /= sum;
    return filter;
}

double variance_bins(const ResponseFilter& filter) {
    double mean = 0.0;
    double square = 0.0;
    for (std::size_t k = 0; k < filter.weights.size(); ++k) {
        mean += static_cast<double>(k) * filter.weights[k];
        square += static_cast<double>(k * k) * filter.weights[k];
    }
    return square - mean * mean;
}

/// The weights for a core of `sigma_m` and an exponential tail (0: none), without correction.
ResponseFilter sample_core(double sigma_m, double tail_m, double bin_width_m) {
    const double reach = kGaussianReach * sigma_m;
    const auto ramp = [&](double u) {
        if (sigma_m > 0.0 && tail_m > 0.0) return exponential_gaussian_ramp(u, sigma_m, tail_m);
        if (sigma_m > 0.0) return gaussian_ramp(u, sigma_m);
        if (u <= 0.0) return 0.0;
        return tail_m > 0.0 ? u - tail_m * (1.0 - std::exp(-u / tail_m)) : u;
    };
    return sample_ramp(ramp, -reach, reach + kExponentialReach * tail_m, bin_width_m);
}

/// Narrows the core until the weights have the variance of the response. Their variance grows with
/// the core's width, so bisection finds it; where the tail alone is too wide, no core is left.
ResponseFilter sample_narrowed(double sigma_m, double tail_m, double bin_width_m) {
    const double wanted = (sigma_m * sigma_m + tail_m * tail_m) / (bin_width_m * bin_width_m);
    // A core this narrow beside its tail changes nothing that a double could hold.
    const double smallest = 1e-4 * tail_m;
    double low = 0.0;
    double high = sigma_m;
    constexpr int kHalvings = 45;
    for (int i = 0; i < kHalvings && high > smallest; ++i) {
        const double middle = 0.5 * (low + high);
        const bool is_wide = variance_bins(sample_core(middle, tail_m, bin_width_m)) > wanted;
        (is_wide ? high : low) = middle;
    }
    return sample_core(high > smallest ? high : 0.0, tail_m, bin_width_m);
}

// One overload of sample_() and moments_() for each kind of response.

ResponseFilter sample_(const GaussianResponse& r, double bin_width_m) {
    return sample_narrowed(r.sigma_m, 0.0, bin_width_m);
}
ResponseFilter sample_(const ExponentialGaussianResponse& r, double bin_width_m) {
    return sample_narrowed(r.sigma_m, r.tail_m, bin_width_m);
}
ResponseFilter sample_(const MeasuredResponse& curve, double bin_width_m) {
    ResponseFilter filter;
    filter.first_delay = static_cast<int>(std::floor(curve.delays_m.front() / bin_width_m));
    const int last = static_cast<int>(std::floor(curve.delays_m.back() / bin_width_m)) + 1;
    filter.weights.assign(static_cast<std::size_t>(last - filter.first_delay + 1), 0.0);
    for (std::size_t i = 0; i < curve.delays_m.size(); ++i) {
        const double position = curve.delays_m[i] / bin_width_m - filter.first_delay;
        const auto bin = static_cast<std::size_t>(position);
        const double part = position - std::floor(position);
        filter.weights[bin] += (1.0 - part) * curve.weights[i];
        filter.weights[bin + 1] += part * curve.weights[i];
    }
    return filter;
}

ResponseMoments moments_(const GaussianResponse& r) {
    return {0.0, r.sigma_m * r.sigma_m, 0.0};
}
ResponseMoments moments_(const ExponentialGaussianResponse& r) {
    return {r.tail_m,
            r.sigma_m * r.sigma_m + r.tail_m * r.tail_m,
            2.0 * r.tail_m * r.tail_m * r.tail_m};
}
ResponseMoments moments_(const MeasuredResponse& r) {
    ResponseMoments m;
    for (std::size_t i = 0; i < r.delays_m.size(); ++i) m.mean_m += r.weights[i] * r.delays_m[i];
    for (std::size_t i = 0; i < r.delays_m.size(); ++i) {
        const double d = r.delays_m[i] - m.mean_m;
        m.variance_m2 += r.weights[i] * d * d;
        m.third_central_m3 += r.weights[i] * d * d * d;
    }
    return m;
}

/// Drops weights at both ends that hold less than 1e-13 of the light together.
void trim(ResponseFilter& filter) {
    constexpr double kNegligible = 5e-14;
    double dropped = 0.0;
    std::size_t first = 0;
    while (first + 1 < filter.weights.size() && dropped + filter.weights[first] <= kNegligible) {
        dropped += filter.weights[first++];
    }
    dropped = 0.0;
    std::size_t end = filter.weights.size();
    while (end > first + 1 && dropped + filter.weights[end - 1] <= kNegligible) {
        dropped += filter.weights[--end];
    }
    filter.weights = {filter.weights.begin() + static_cast<std::ptrdiff_t>(first),
                      filter.weights.begin() + static_cast<std::ptrdiff_t>(end)};
    filter.first_delay += static_cast<int>(first);
}

}  // namespace

void read_value(const Json& json, const std::string& where, ResponseSettings& settings) {
    settings.of_capture = json == "capture";
    settings.is_none = json == "none";
    if (settings.of_capture || settings.is_none) return;
    if (!json.is_object()) {
        throw_wrong_type(where, json, "capture, none, or an object with named fields");
    }
    read_value<ResponseSettings>(json, where, settings);
}

Json write_value(const ResponseSettings& settings) {
    if (settings.of_capture) return "capture";
    return settings.is_none ? Json("none") : write_value<ResponseSettings>(settings);
}

InstrumentResponse make_response(const ResponseSettings& settings, const std::string& where) {
    const auto check = [&](const char* key, double value) {
        constexpr double kLargest = 1e9;  // [ps], 300 km
        require(
            value >= 0.0 && value <= kLargest, join_key(where, key), value, "from 0 to 1e9 [ps]");
    };
    check("jitter_fwhm_ps", settings.jitter_fwhm_ps);
    check("tail_ps", settings.tail_ps);
    if (!settings.curve.empty()) {
        if (settings.jitter_fwhm_ps > 0.0 || settings.tail_ps > 0.0) {
            throw Error(join_key(where, "curve"),
                        "found beside jitter_fwhm_ps or tail_ps",
                        "must stand alone");
        }
        return read_curve(settings.curve);
    }
    const double sigma_m = sigma_m_from_fwhm_ps(settings.jitter_fwhm_ps);
    if (settings.tail_ps > 0.0) {
        return ExponentialGaussianResponse{sigma_m, opl_from_ps(settings.tail_ps)};
    }
    return GaussianResponse{sigma_m};
}

double widest_bin_m(double fwhm_ps) {
    return 0.5 * sigma_m_from_fwhm_ps(fwhm_ps);
}

double sigma_m_from_fwhm_ps(double fwhm_ps) {
    return opl_from_ps(fwhm_ps) / std::sqrt(8.0 * std::log(2.0));
}

ResponseMoments moments(const InstrumentResponse& response) {
    return std::visit([](const auto& r) { return moments_(r); }, response);
}

ResponseFilter sample_response(const InstrumentResponse& response, double bin_width_m) {
    assert(bin_width_m > 0.0);
    ResponseFilter filter =
        std::visit([&](const auto& r) { return sample_(r, bin_width_m); }, response);
    trim(filter);
    return filter;
}

Transient apply_filter(const ResponseFilter& filter, const Transient& transient) {
    Transient result(transient.num_pairs(), static_cast<int>(transient.num_bins()));
    parallel_for(transient.num_pairs(), [&](std::size_t pair) {
        apply_filter<float, float>(filter, transient.histogram(pair), result.histogram(pair));
    });
    return result;
}

}  // namespace core
