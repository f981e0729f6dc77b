// SPDX-License-Identifier: MIT
#include "nlos/containers/matlab_name.h"

#include <charconv>

namespace nlos {
namespace {

/// Takes an index in brackets off `text`; false when there is none.
bool take_index(std::string_view& text, char closing, std::size_t& index) {
    const char* end = text.data() + text.size();
    const auto [after, error] = std::from_chars(text.data() + 1, end, index);
    if (error != std::errc() || after == end || *after != closing) return false;
    text.remove_prefix(static_cast<std::size_t>(after + 1 - text.data()));
    return true;
}

/// The step that stands at the begin of `text`, which loses it.
std::optional<MatlabStep> take_step(std::string_view& text) {
    MatlabStep step;
    if (text.starts_with('{')) {
        if (!take_index(text, '}', step.cell)) return std::nullopt;
        return step;
    }
    if (text.starts_with('(') && !take_index(text, ')', step.element.emplace())) {
        return std::nullopt;
    }
    if (text.starts_with('.')) text.remove_prefix(1);
    step.field = text.substr(0, text.find_first_of(".({"));
    text.remove_prefix(step.field.size());
    if (step.field.empty()) return std::nullopt;
    return step;
}

}  // namespace

std::optional<std::vector<MatlabStep>> parse_matlab_name(const std::string& name) {
    if (name.find_first_of(".({") == 0) return std::nullopt;
    std::string_view rest = name;
    std::vector<MatlabStep> steps;
    do {
        const std::optional<MatlabStep> step = take_step(rest);
        if (!step) return std::nullopt;
        steps.push_back(*step);
    } while (!rest.empty());
    return steps;
}

}  // namespace nlos
