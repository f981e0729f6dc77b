// SPDX-License-Identifier: MIT
#include "renderer/core/settings/json_file.h"

#include "nlos/containers/json_leaves.h"
#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"

#include <fmt/core.h>

namespace nlos {
namespace {

using core::Json;

constexpr const char* kJsonBlanks = " \t\r\n";

/// Takes the first line off `text`.
std::string_view take_line(std::string_view& text) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return line;
}

bool is_blank(std::string_view text) {
    return text.find_first_not_of(kJsonBlanks) == std::string_view::npos;
}

/// One value, or a list of those that stand one per line, as in a log.
Json parse_file(std::string_view text, const std::string& path) {
    std::string_view rest = text;
    const std::string_view first = take_line(rest);
    if (is_blank(rest) || !Json::accept(first)) return core::parse_json(text, path);
    Json values = Json::array({core::parse_json(first, path)});
    for (std::size_t number = 2; !rest.empty(); ++number) {
        const std::string_view line = take_line(rest);
        if (is_blank(line)) continue;
        values.push_back(core::parse_json(line, fmt::format("{}: line {}", path, number)));
    }
    return values;
}

class JsonFile : public JsonLeaves {
 public:
    explicit JsonFile(const std::string& path) {
        const core::MappedFile file(path);
        add_leaves("", parse_file(file.bytes(), path));
    }

    std::string container() const override { return "json"; }
};

/// A file that starts as an object or a list, after blanks, and holds no zero bytes there.
bool is_json_file(const std::string& path) {
    const std::string bytes = core::first_bytes(path, 1024);
    std::string_view start = bytes;
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (start.starts_with(kByteOrderMark)) start.remove_prefix(kByteOrderMark.size());
    const std::size_t begin = start.find_first_not_of(kJsonBlanks);
    return begin != std::string_view::npos && (start[begin] == '{' || start[begin] == '[') &&
           start.find('\0') == std::string_view::npos;
}

}  // namespace

Container json_container() {
    return {"JSON", is_json_file, open_as<JsonFile>};
}

}  // namespace nlos
