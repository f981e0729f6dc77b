// SPDX-License-Identifier: MIT
#include "nlos/containers/matlab_name.h"

#include <charconv>

namespace nlos {
namespace {

/// The step that stands at the begin of `text`, which loses it.
std::optional<MatlabStep> take_step(std::string_view& text) {
    MatlabStep step;
    if (text.front() != '(' && text.front() != '{') {
        const std::size_t end = std::min(text.find_first_of(".({"), text.size());
        if (end == 0) return std::nullopt;
        step.field = text.substr(0, end);
        text.remove_prefix(end);
        return step;
    }
    step.kind = text.front() == '(' ? MatlabStep::Kind::Element : MatlabStep::Kind::Cell;
    const char closing = text.front() == '(' ? ')' : '}';
    const char* end = text.data() + text.size();
    const auto [after, error] = std::from_chars(text.data() + 1, end, step.index);
    if (error != std::errc() || after == end || *after != closing) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(after + 1 - text.data()));
    return step;
}

}  // namespace

std::optional<std::vector<MatlabStep>> parse_matlab_name(const std::string& name) {
    std::string_view rest = name;
    std::vector<MatlabStep> steps;
    do {
        if (!steps.empty() && rest.front() == '.') rest.remove_prefix(1);
        if (rest.empty()) return std::nullopt;
        const std::optional<MatlabStep> step = take_step(rest);
        if (!step || (steps.empty() && step->kind != MatlabStep::Kind::Field)) return std::nullopt;
        steps.push_back(*step);
    } while (!rest.empty());
    return steps;
}

}  // namespace nlos
