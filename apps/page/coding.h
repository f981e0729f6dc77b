// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_file.h"
#include "renderer/core/types.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

namespace apps {

/// The arrays of a page: little-endian numbers, compressed with zlib, as base64 text in script
/// elements that a browser does not run. The page's data refer to them by number.
class PageArrays {
 public:
    /// returns   {"array": number, "type": "u8", "u16" or "u32", "count": of elements}
    template <class Code>
    core::Json add(const std::vector<Code>& codes) {
        static_assert(std::is_unsigned_v<Code> && sizeof(Code) <= 4);
        bytes_.emplace_back(reinterpret_cast<const char*>(codes.data()),
                            codes.size() * sizeof(Code));
        return {{"array", bytes_.size() - 1},
                {"type", "u" + std::to_string(8 * sizeof(Code))},
                {"count", codes.size()}};
    }

    /// One script element per array, id `nlos-array-NUMBER`.
    std::string html() const;

 private:
    std::vector<std::string> bytes_;
};

// Real numbers as small whole ones, for arrays of a page. Code 0 is kept for what is not there.

/// Evenly spaced values from `low` to `high`; what lies outside takes the nearer end, and NaN is
/// code 0.
struct LinearCoding {
    double low = 0.0;
    double high = 1.0;

    template <class Code>
    Code encode(double value) const {
        if (std::isnan(value)) return 0;
        constexpr double kSteps = std::numeric_limits<Code>::max() - 1;
        const double fraction = high > low ? (value - low) / (high - low) : 0.0;
        return static_cast<Code>(1.5 + kSteps * std::clamp(fraction, 0.0, 1.0));
    }

    /// Codes all values. returns   what PageArrays::add() does, with the coding
    template <class Code, class Values>
    core::Json add(PageArrays& arrays, const Values& values) const {
        std::vector<Code> codes;
        codes.reserve(values.size());
        for (const auto value : values) codes.push_back(encode<Code>(value));
        core::Json json = arrays.add(codes);
        json.update({{"coding", "linear"}, {"low", low}, {"high", high}});
        return json;
    }
};

/// Light by its logarithm, in 255 values from `low` to `high` of one ratio between neighbours;
/// code 0 is no light, or less than half a step below `low`.
struct LogCoding {
    double low = 1.0;
    double high = 1.0;

    std::uint8_t encode(double value) const {
        if (!(value > 0.0)) return 0;
        if (!(high > low)) return 255;
        const double code = 1.0 + kSteps * (1.0 - std::log(high / value) / std::log(high / low));
        return static_cast<std::uint8_t>(std::clamp(std::round(code), 0.0, kSteps + 1.0));
    }

    double decode(std::uint8_t code) const {
        if (code == 0) return 0.0;
        return high * std::pow(low / high, 1.0 - (code - 1.0) / kSteps);
    }

 private:
    static constexpr double kSteps = 254.0;
};

/// The smallest and the largest finite value, both 0 where there is none.
template <class Values>
LinearCoding coding_of(const Values& values) {
    LinearCoding coding{std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity()};
    for (const double value : values) {
        if (!std::isfinite(value)) continue;
        coding.low = std::min(coding.low, value);
        coding.high = std::max(coding.high, value);
    }
    if (coding.low > coding.high) return {0.0, 0.0};
    return coding;
}

/// Points as steps of 1/65535 of the box around them: x, y, z by turns, with the box.
///
/// frame_from_world   of the page, in which they are stored
core::Json add_points(PageArrays& arrays,
                      const std::vector<core::Vec3>& points,
                      const core::Transform& frame_from_world = core::Transform::Identity());

}  // namespace apps
