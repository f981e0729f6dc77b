// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/methods.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/format.h>

#include <cctype>
#include <string>
#include <utility>
#include <vector>

namespace nlos_test {

/// A row of the list of methods, or a variant of one.
struct MethodCase {
    std::string name;                    ///< as tests are named, as in "FbpPhasor"
    std::vector<std::string> overrides;  ///< that choose it
    const nlos::MethodTraits* traits;

    nlos::ReconstructSettings settings(const std::vector<std::string>& more = {}) const {
        nlos::ReconstructSettings result;
        for (const std::string& text : overrides) core::apply_override(result, text);
        for (const std::string& text : more) core::apply_override(result, text);
        return result;
    }
    /// Whether it solves for the scene in steps instead of inverting once, in slabs.
    bool iterates() const { return traits->least_work == nullptr; }
};

inline std::string capitalised(std::string_view name) {
    std::string text(name);
    text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    return text;
}

inline std::vector<MethodCase> every_method() {
    std::vector<MethodCase> cases;
    for (const nlos::MethodTraits* usual : nlos::kMethods) {
        const std::string_view name = core::enum_name(usual->method);
        const MethodCase method{capitalised(name), {fmt::format("method={}", name)}, usual};
        cases.push_back(method);
        for (const auto& [filter, text] : core::EnumNames<nlos::FbpFilter>::value) {
            MethodCase variant = method;
            variant.name += capitalised(text);
            variant.overrides.push_back(fmt::format("filter={}", text));
            variant.traits = &nlos::traits_of(variant.settings());
            if (variant.traits != usual) cases.push_back(std::move(variant));
        }
    }
    return cases;
}

/// Every method with every pattern of scan that it serves without conversion.
inline std::vector<std::pair<MethodCase, core::ScanPattern>> every_method_and_scan() {
    std::vector<std::pair<MethodCase, core::ScanPattern>> cases;
    for (MethodCase method : every_method()) {
        if (method.traits->has_wiener_filter) method.overrides.push_back("snr=10");
        for (const auto& [pattern, text] : core::EnumNames<core::ScanPattern>::value) {
            const bool is_confocal = pattern == core::ScanPattern::Confocal;
            if (method.traits->needs == &nlos::kConfocalGrid && !is_confocal) continue;
            cases.emplace_back(method, pattern);
            cases.back().first.name += capitalised(text);
        }
    }
    return cases;
}

}  // namespace nlos_test
