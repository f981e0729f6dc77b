// SPDX-License-Identifier: MIT
#include "nlos/containers/array_reader.h"

#include "nlos/containers/text_checksum.h"
#include "renderer/core/error.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/sandboxed_process.h"

#include <fmt/core.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <type_traits>

namespace nlos {
namespace {

using core::Json;

// A request is a list: "container", "names", "describe" and a name, or "read" and a name, a first
// row, a number of rows and a precision. Values come as bytes, all else as Json.

Json to_json(const std::optional<ArrayDescription>& description) {
    if (!description) return nullptr;
    Json json{{"kind", description->kind},
              {"type", description->type},
              {"rows_per_read", description->rows_per_read},
              {"attributes", *description->attributes}};
    if (description->shape) json["shape"] = *description->shape;
    if (description->text) json["text"] = *description->text;
    return json;
}

std::optional<ArrayDescription> description_from_json(const Json& json) {
    if (json.is_null()) return std::nullopt;
    ArrayDescription description;
    description.kind = json.at("kind");
    description.type = json.at("type");
    description.rows_per_read = json.at("rows_per_read");
    description.attributes = json.at("attributes");
    if (json.contains("shape")) description.shape = json.at("shape").get<Shape>();
    if (json.contains("text")) description.text = json.at("text").get<std::string>();
    return description;
}

/// How to store what an array of such a type holds so that it can be read; nothing for other types.
std::optional<std::string> how_to_store(const std::string& type, const std::string& name) {
    if (type == "sparse") return fmt::format("must be a full array: {0} = full({0})", name);
    if (type == "cell") {
        return fmt::format("must be an array of numbers, such as cat(3, {0}{{:}})", name);
    }
    if (type == "structured" || type == "compound") {
        return fmt::format("must be an array of numbers, such as one of its fields: {}['a']", name);
    }
    return std::nullopt;
}

std::string answer(const ArrayFile& file, const Json& request) {
    const std::string what = request.at(0);
    if (what == "read") {
        return file.read(request.at(1), {request.at(2), request.at(3), request.at(4)});
    }
    Json json;
    if (what == "describe") {
        json = to_json(file.describe(request.at(1)));
    } else if (what == "names") {
        const ArrayNames names = file.names();
        json = Json::array({names.names, names.is_complete});
    } else {
        json = Json::array({file.container(), file.first_index_fastest()});
    }
    std::string bytes;
    Json::to_cbor(json, bytes);
    return bytes;
}

const Container& known_container(const std::string& path) {
    if (const Container* container = find_container(path)) return *container;
    if (!std::filesystem::exists(path)) {
        throw core::Error(path, "cannot be opened", "must be a readable file");
    }
    std::string known;
    for (const Container& container : containers()) {
        if (container.content == nullptr) continue;
        known += (known.empty() ? "" : ", ") + std::string(container.content);
    }
    throw core::Error(path, "is no file of arrays", "must be " + known);
}

}  // namespace

ArrayReader::ArrayReader(std::string path) : path_(std::move(path)) {
    const Container& kind = known_container(path_);
    // The file is opened in the child, at the first request.
    const auto file = std::make_shared<std::unique_ptr<ArrayFile>>();
    process_ = std::make_unique<core::SandboxedProcess>(
        path_, [file, &kind, this](const std::string& request) {
            if (!*file) *file = kind.open(path_);
            return answer(**file, Json::from_cbor(request));
        });
    const Json opened = ask(Json::array({"container"}));
    container_ = opened.at(0);
    first_index_fastest_ = opened.at(1);
}

ArrayReader::~ArrayReader() = default;

Json ArrayReader::ask(const Json& request) const {
    std::string bytes;
    Json::to_cbor(request, bytes);
    return Json::from_cbor(process_->ask(bytes));
}

const ArrayNames& ArrayReader::listed() const {
    if (!names_) {
        const Json json = ask(Json::array({"names"}));
        names_ = ArrayNames{json.at(0), json.at(1)};
    }
    return *names_;
}

const std::optional<ArrayDescription>& ArrayReader::describe(const std::string& name) const {
    auto known = described_.find(name);
    if (known == described_.end()) {
        const Json json = ask(Json::array({"describe", name}));
        known = described_.emplace(name, description_from_json(json)).first;
    }
    return known->second;
}

const ArrayDescription& ArrayReader::describe_array(const std::string& name) const {
    if (has(name)) return *describe(name);
    const auto hint = has_object(name) ? how_to_store(type(name), name) : std::nullopt;
    if (hint) throw core::Error(where(name), "is a " + type(name) + " array", *hint);
    throw core::Error(where(name), "is missing or empty", "must be an array with values");
}

bool ArrayReader::has_object(const std::string& name) const {
    return describe(name).has_value();
}

bool ArrayReader::has(const std::string& name) const {
    return has_object(name) && describe(name)->shape;
}

Shape ArrayReader::shape(const std::string& name) const {
    return *describe_array(name).shape;
}

ElementKind ArrayReader::kind(const std::string& name) const {
    return describe_array(name).kind;
}

std::string ArrayReader::type(const std::string& name) const {
    if (!has_object(name)) throw core::Error(where(name), "is missing", "must be in the file");
    return describe(name)->type;
}

void ArrayReader::require_numeric(const std::string& name) const {
    const ElementKind found = kind(name);
    if (found != ElementKind::Integer && found != ElementKind::Real) {
        throw core::Error(
            where(name),
            found == ElementKind::Text ? "holds text" : "holds no plain numbers: " + type(name),
            how_to_store(type(name), name).value_or("must hold real numbers"));
    }
}

template <class T>
std::vector<T> ArrayReader::read_values(const std::string& name,
                                        std::size_t first,
                                        std::size_t count) const {
    constexpr Precision kPrecision =
        std::is_same_v<T, double> ? Precision::Double : Precision::Single;
    std::string request;
    Json::to_cbor(Json::array({"read", name, first, count, kPrecision}), request);
    const std::string bytes = process_->ask(request);
    const std::uint64_t row = values_per_row(shape(name));
    if (bytes.size() != count * row * sizeof(T)) {
        throw core::Error(where(name), "cannot be read", "must be an undamaged file");
    }
    std::vector<T> values(count * row);
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
}

template std::vector<float> ArrayReader::read_values(const std::string&,
                                                     std::size_t,
                                                     std::size_t) const;

template <class T>
std::vector<T> ArrayReader::read_all(const std::string& name, const Shape& wanted) const {
    const Shape found = shape(name);
    if (found != wanted) {
        throw core::Error(
            where(name), "has shape " + shape_text(found), "must have shape " + shape_text(wanted));
    }
    require_numeric(name);
    return read_values<T>(name, 0, found.empty() ? 1 : found[0]);
}

std::vector<float> ArrayReader::read_floats(const std::string& name, const Shape& wanted) const {
    return read_all<float>(name, wanted);
}

std::vector<double> ArrayReader::read_doubles(const std::string& name, const Shape& wanted) const {
    return read_all<double>(name, wanted);
}

double ArrayReader::read_real(const std::string& name) const {
    const Shape found = shape(name);
    return read_doubles(name, Shape(found.size(), 1))[0];
}

std::int64_t ArrayReader::read_integer(const std::string& name) const {
    constexpr double kLimit = 9.0e18;
    if (kind(name) != ElementKind::Integer) {
        throw core::Error(where(name), "holds no whole number", "must be an integer, enum or bool");
    }
    const double value = read_real(name);
    if (!(std::abs(value) < kLimit)) {
        throw core::Error(where(name), fmt::format("is {}", value), "must fit 64 bits");
    }
    return static_cast<std::int64_t>(value);
}

std::string ArrayReader::read_text(const std::string& name) const {
    if (kind(name) != ElementKind::Text) {
        throw core::Error(where(name), "holds no text", "must be a text");
    }
    if (!describe(name)->text) {
        throw core::Error(where(name), "has shape " + shape_text(shape(name)), "must be one text");
    }
    check_text(*describe(name)->text, name, kTextChecksum);
    return *describe(name)->text;
}

/// Holds a text against its checksum, the attribute `checksum`, where there is one.
void ArrayReader::check_text(const std::string& text,
                             const std::string& object,
                             const std::string& checksum) const {
    const auto stated = real_attribute(object, checksum);
    if (!stated || (stated->size() == 1 && stated->front() == text_checksum(text))) return;
    throw core::Error(where(object),
                      "is damaged: a text does not agree with its checksum, attribute " + checksum,
                      "must be as it was written, or without that attribute");
}

/// How many rows there are to read: none of an array without values, however many it claims.
std::size_t ArrayReader::row_count(const std::string& name) const {
    const Shape found = shape(name);
    if (found.empty()) throw core::Error(where(name), "is one number", "must be an array");
    return total_bytes(found, 1) == 0 ? 0 : found[0];
}

std::size_t ArrayReader::rows_per_read(const std::string& name) const {
    require_numeric(name);
    return describe_array(name).rows_per_read;
}

/// Null when the object or the attribute is missing.
const Json* ArrayReader::find_attribute(const std::string& object, const std::string& name) const {
    if (!has_object(object)) return nullptr;
    const Json& attributes = *describe(object)->attributes;
    const auto found = attributes.find(name);
    return found == attributes.end() ? nullptr : &*found;
}

std::optional<std::string> ArrayReader::text_attribute(const std::string& object,
                                                       const std::string& name) const {
    const Json* value = find_attribute(object, name);
    if (value == nullptr) return {};
    if (value->is_string()) {
        check_text(*value, object, checksum_attribute(name));
        return *value;
    }
    throw core::Error(where(object + " attribute " + name), "holds no text", "must be one text");
}

std::optional<std::vector<double>> ArrayReader::real_attribute(const std::string& object,
                                                               const std::string& name) const {
    const Json* value = find_attribute(object, name);
    if (value == nullptr) return {};
    if (value->is_array()) return *value;
    throw core::Error(
        where(object + " attribute " + name), "holds no numbers", "must hold a few numbers");
}

std::shared_ptr<const ArrayReader> open_arrays(const std::string& path) {
    return find_container(path) == nullptr ? nullptr : std::make_shared<const ArrayReader>(path);
}

std::optional<std::string> container_of(const std::string& path) {
    const auto file = open_arrays(path);
    return file ? std::optional(file->container()) : std::nullopt;
}

}  // namespace nlos
