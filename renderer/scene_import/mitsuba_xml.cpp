// SPDX-License-Identifier: MIT
#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/sandboxed_process.h"
#include "renderer/scene_import/foreign_file.h"

#include <fmt/core.h>
#include <pugixml.hpp>

#include <cctype>
#include <cmath>
#include <map>

namespace renderer {
namespace {

using core::Json;

constexpr int kDeepestElement = 32;  // of a scene: shape, bsdf, bsdf, texture, transform
constexpr std::size_t kMostElements = 1'000'000;

/// Walks a parsed document.
class XmlReader {
 public:
    explicit XmlReader(std::string where) : where_(std::move(where)) {}

    Json read(const pugi::xml_document& document) {
        for (const pugi::xml_node& node : document.children()) {
            if (node.type() == pugi::node_doctype) {
                fail("found a document type (DOCTYPE)", "must be a scene without entities");
            }
        }
        const pugi::xml_node root = document.document_element();
        if (!root) fail("holds no element", "must be a scene of Mitsuba 3");
        return plugin(root, 0);
    }

 private:
    [[noreturn]] void fail(const std::string& found, const std::string& allowed) const {
        throw core::Error(where_, found, allowed);
    }

    /// An attribute with $names replaced by their defaults.
    std::string attribute(const pugi::xml_node& node, const char* name) const {
        std::string text = node.attribute(name).value();
        for (std::size_t at = text.find('$'); at != std::string::npos; at = text.find('$', at)) {
            std::size_t end = at + 1;
            while (end < text.size() &&
                   (std::isalnum(static_cast<unsigned char>(text[end])) || text[end] == '_')) {
                ++end;
            }
            const auto found = defaults_.find(text.substr(at + 1, end - at - 1));
            if (found == defaults_.end()) {
                fail("uses " + text.substr(at, end - at) + " without a <default>",
                     "must give its value");
            }
            text.replace(at, end - at, found->second);
            at += found->second.size();
        }
        return text;
    }

    std::vector<double> numbers(const pugi::xml_node& node, const char* name) const {
        const std::string text = attribute(node, name);
        try {
            return numbers_in(text);
        } catch (const std::invalid_argument&) {
            fail(fmt::format("found <{} {}=\"{}\">", node.name(), name, text.substr(0, 60)),
                 "must be numbers");
        }
    }

    double number(const pugi::xml_node& node, const char* name) const {
        const std::vector<double> values = numbers(node, name);
        if (values.size() != 1) {
            fail(fmt::format("found <{} {}> with {} numbers", node.name(), name, values.size()),
                 "must have one");
        }
        return values.front();
    }

    /// x, y and z of `value`, or of attributes of their own.
    std::array<double, 3> vector(const pugi::xml_node& node, double otherwise) const {
        std::array<double, 3> result{otherwise, otherwise, otherwise};
        if (node.attribute("value")) {
            const std::vector<double> values = numbers(node, "value");
            if (values.size() == 1) result.fill(values[0]);
            if (values.size() == 3) std::copy(values.begin(), values.end(), result.begin());
            if (values.size() == 1 || values.size() == 3) return result;
            fail(fmt::format("found <{}> with {} numbers", node.name(), values.size()),
                 "must have three");
        }
        constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
        for (std::size_t i = 0; i < 3; ++i) {
            if (node.attribute(kAxes[i])) result[i] = number(node, kAxes[i]);
        }
        return result;
    }

    core::Vec3 vec3(const pugi::xml_node& node, const char* name) const {
        const std::vector<double> values = numbers(node, name);
        if (values.size() != 3) {
            fail(fmt::format("found <{} {}> with {} numbers", node.name(), name, values.size()),
                 "must have three");
        }
        return {values[0], values[1], values[2]};
    }

    /// Each step acts on what those before it made.
    Json transform(const pugi::xml_node& node) {
        Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
        for (const pugi::xml_node& step : node.children()) {
            if (step.type() != pugi::node_element) continue;
            const std::string name = step.name();
            if (name == "translate") {
                matrix = translation(vector(step, 0.0)) * matrix;
            } else if (name == "scale") {
                matrix = scaling(vector(step, 1.0)) * matrix;
            } else if (name == "rotate") {
                matrix = rotation(vector(step, 0.0), number(step, "angle")) * matrix;
            } else if (name == "lookat") {
                const core::Vec3 up = step.attribute("up") ? vec3(step, "up") : core::Vec3::UnitY();
                matrix = look_at(vec3(step, "origin"), vec3(step, "target"), up) * matrix;
            } else if (name == "matrix") {
                matrix = matrix_of(numbers(step, "value"), where_) * matrix;
            } else {
                fail("found <" + name + "> in a transform",
                     "must be translate, scale, rotate, lookat or matrix");
            }
        }
        return to_json(matrix);
    }

    Json spectrum(const pugi::xml_node& node) const {
        const std::string text = attribute(node, "value");
        if (node.name() == std::string("rgb") && !text.starts_with("#")) {
            const auto [r, g, b] = vector(node, 0.0);
            return {{"type", "rgb"}, {"value", {r, g, b}}};
        }
        Json value = text;  // "#rrggbb" and "400:1, 700:1" stay as they are
        if (text.find_first_of(":#") == std::string::npos && !text.empty()) {
            value = numbers(node, "value");
            if (value.size() == 1) value = value[0];
        }
        return {{"type", node.name()}, {"value", value}};
    }

    Json property(const pugi::xml_node& node, int depth) {
        const std::string tag = node.name();
        if (tag == "string") return attribute(node, "value");
        if (tag == "integer") return integer(node);
        if (tag == "float") return number(node, "value");
        if (tag == "boolean") return boolean(node);
        if (tag == "point" || tag == "vector") return vector(node, 0.0);
        if (tag == "rgb" || tag == "spectrum") return spectrum(node);
        if (tag == "transform") return transform(node);
        if (tag == "ref") return {{"type", "ref"}, {"id", attribute(node, "id")}};
        return plugin(node, depth + 1);
    }

    std::int64_t integer(const pugi::xml_node& node) const {
        constexpr double kLargest = 1e15;
        const double value = number(node, "value");
        if (std::trunc(value) != value || std::abs(value) > kLargest) {
            fail(fmt::format("found <integer value=\"{:g}\">", value), "must be a whole number");
        }
        return static_cast<std::int64_t>(value);
    }

    bool boolean(const pugi::xml_node& node) const {
        const std::string text = attribute(node, "value");
        if (text != "true" && text != "false") {
            fail("found <boolean value=\"" + text.substr(0, 60) + "\">", "must be true or false");
        }
        return text == "true";
    }

    Json plugin(const pugi::xml_node& node, int depth) {
        if (depth > kDeepestElement) {
            fail(fmt::format("nests deeper than {} elements", kDeepestElement),
                 "must be a plain scene");
        }
        Json object = Json::object();
        object["type"] = node.attribute("type") ? attribute(node, "type") : node.name();
        if (node.attribute("id")) object["id"] = attribute(node, "id");
        if (node.attribute("filename")) object["filename"] = attribute(node, "filename");
        for (const pugi::xml_node& child : node.children()) {
            if (child.type() != pugi::node_element) continue;
            if (++num_elements_ > kMostElements) fail("has too many elements", "must be a scene");
            if (child.name() == std::string("default")) {
                defaults_.emplace(child.attribute("name").value(),
                                  child.attribute("value").value());
                continue;
            }
            object[key_of(child, object)] = property(child, depth);
        }
        return object;
    }

    static std::string key_of(const pugi::xml_node& child, const Json& object) {
        for (const char* name : {"name", "id"}) {
            const std::string key = child.attribute(name).value();
            if (!key.empty() && !object.contains(key)) return key;
        }
        std::string key = child.name();
        for (int i = 2; object.contains(key); ++i) key = fmt::format("{}_{}", child.name(), i);
        return key;
    }

    std::string where_;
    std::map<std::string, std::string> defaults_;
    std::size_t num_elements_ = 0;
};

Json parse_xml(const std::string& text, const std::string& where) {
    pugi::xml_document document;
    const pugi::xml_parse_result result =
        document.load_buffer(text.data(), text.size(), pugi::parse_default | pugi::parse_doctype);
    if (!result) {
        throw core::Error(
            where,
            fmt::format("is no valid XML: {} at byte {}", result.description(), result.offset),
            "must be a scene of Mitsuba 3");
    }
    return XmlReader(where).read(document);
}

}  // namespace

core::Json parse_mitsuba_xml(const std::string& text,
                             const std::string& path,
                             const std::string& where) {
    return core::run_sandboxed(path, [&] { return parse_xml(text, path + ": " + where); });
}

core::Json read_mitsuba_xml(const std::string& path) {
    return core::run_sandboxed(path, [&] {
        const core::MappedFile file(path, "must be a scene of Mitsuba 3");
        file.require_stored();
        return parse_xml(std::string(file.bytes()), path);
    });
}

}  // namespace renderer
