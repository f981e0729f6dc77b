// SPDX-License-Identifier: MIT
#include "nlos/layouts/array_list.h"

#include <fmt/core.h>

#include <algorithm>

namespace nlos {
namespace {

constexpr std::size_t kMostListed = 200;
constexpr std::size_t kMostRead = std::size_t{1} << 22;  // values, for a range in the list

std::string shown(const std::string& text) {
    constexpr std::size_t kLongest = 60;
    const std::string first = text.substr(0, std::min(text.find('\n'), kLongest));
    return first.size() < text.size() ? first + " ..." : first;
}

std::string describe_array(const LayoutFiles& files, const std::string& name) {
    const ArrayReader& file = files.main();
    std::string line = fmt::format("{}: {}", name, file.type(name));
    if (file.kind(name) == ElementKind::Text)
        return line + " \"" + shown(file.read_text(name)) + "\"";
    const Shape shape = files.shape(name);
    const std::uint64_t count = total_bytes(shape, 1);
    const ElementKind kind = file.kind(name);
    const bool is_numeric = kind == ElementKind::Integer || kind == ElementKind::Real;
    line += " " + shape_text(shape);
    if (!is_numeric || count == 0 || count > kMostRead) return line;
    const std::vector<double> values = files.read(name);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return values.size() == 1 ? fmt::format("{}: {:.6g}", line, *low)
                              : fmt::format("{}, {:.6g} to {:.6g}", line, *low, *high);
}

/// Of an array that cannot be read, why.
std::string describe_any_array(const LayoutFiles& files, const std::string& name) {
    try {
        if (files.main().has(name)) return describe_array(files, name);
        return fmt::format("{}: {}", name, files.main().type(name));
    } catch (const core::Error& error) {
        return fmt::format("{}: {}; {}", name, reason_of(error, name), error.allowed());
    }
}

}  // namespace

std::string reason_of(const core::Error& error, const std::string& name) {
    const std::string prefix = name + ": ";
    const std::string found = error.found();
    return found.starts_with(prefix) ? found.substr(prefix.size()) : found;
}

std::vector<std::string> list_arrays(const LayoutFiles& files) {
    std::vector<std::string> lines;
    std::string last_cell;
    std::size_t alike = 0;
    const auto count_alike = [&] {
        if (alike > 0) lines.back() += fmt::format("; and {} more such cells", alike);
        alike = 0;
    };
    for (const std::string& name : files.main().names()) {
        const std::size_t brace = name.find('{');
        const std::string cell = brace == std::string::npos ? "" : name.substr(0, brace);
        if (!cell.empty() && cell == last_cell) {
            ++alike;
            continue;
        }
        count_alike();
        last_cell = cell;
        if (lines.size() == kMostListed) {
            lines.emplace_back("...");
            break;
        }
        if (files.main().has_object(name)) lines.push_back(describe_any_array(files, name));
    }
    count_alike();
    return lines;
}

}  // namespace nlos
