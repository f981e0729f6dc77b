// SPDX-License-Identifier: MIT
#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/sandboxed_process.h"
#include "renderer/scene_import/foreign_file.h"

#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace renderer {
namespace {

using core::Json;

constexpr int kDeepestNode = 32;
constexpr std::size_t kMostNodes = 100'000;

/// The number that a plain scalar is, with underscores between digits as YAML 1.1 allows them.
std::optional<Json> number_of(std::string text) {
    if (text.starts_with('_') || text.find("__") != std::string::npos) return std::nullopt;
    text.erase(std::remove(text.begin(), text.end(), '_'), text.end());
    if (text.starts_with('+')) text.erase(0, 1);
    const char* end = text.data() + text.size();
    std::int64_t whole = 0;
    if (const auto [at, error] = std::from_chars(text.data(), end, whole);
        error == std::errc() && at == end) {
        return whole;
    }
    double real = 0.0;
    const auto [at, error] = std::from_chars(text.data(), end, real);
    if (error != std::errc() || at != end || !std::isfinite(real)) return std::nullopt;
    return real;
}

Json plain_scalar(const std::string& text) {
    const auto is_one_of = [&](std::initializer_list<const char*> words) {
        return std::find(words.begin(), words.end(), text) != words.end();
    };
    if (is_one_of({"", "~", "null", "Null", "NULL"})) return nullptr;
    if (is_one_of({"true", "True", "TRUE", "yes", "Yes", "YES", "on", "On", "ON"})) return true;
    if (is_one_of({"false", "False", "FALSE", "no", "No", "NO", "off", "Off", "OFF"})) return false;
    return number_of(text).value_or(text);
}

/// Turns nodes into JSON; aliases, which may multiply a small file, count as often as they stand.
class YamlReader {
 public:
    explicit YamlReader(std::string path) : path_(std::move(path)) {}

    Json read(const YAML::Node& node, int depth = 0) {
        if (depth > kDeepestNode || ++num_nodes_ > kMostNodes) {
            throw core::Error(
                path_,
                fmt::format("nests deeper than {} levels or holds more than {} values",
                            kDeepestNode,
                            kMostNodes),
                "must be a plain scene");
        }
        if (node.IsScalar()) {
            return node.Tag() == "!" ? Json(node.Scalar()) : plain_scalar(node.Scalar());
        }
        if (node.IsSequence()) {
            Json list = Json::array();
            for (const YAML::Node& item : node) list.push_back(read(item, depth + 1));
            return list;
        }
        if (!node.IsMap()) return nullptr;
        Json object = Json::object();
        for (const auto& item : node) {
            if (!item.first.IsScalar()) {
                throw core::Error(path_, "has a key that is no text", "must have texts as keys");
            }
            object[item.first.Scalar()] = read(item.second, depth + 1);
        }
        return object;
    }

 private:
    std::string path_;
    std::size_t num_nodes_ = 0;
};

}  // namespace

core::Json read_yaml(const std::string& path) {
    const auto read = [&] {
        const core::MappedFile file(path, "must be a scene of y-tal");
        file.require_stored();
        return YamlReader(path).read(YAML::Load(std::string(file.bytes())));
    };
    return core::run_sandboxed(path, read, [&](const std::string& message) {
        return core::Error(
            path, "is no valid YAML (" + message.substr(0, 120) + ")", "must be a scene of y-tal");
    });
}

}  // namespace renderer
