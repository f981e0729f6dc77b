// SPDX-License-Identifier: MIT
#include "apps/python/json_values.h"

#include "renderer/core/settings/settings_json.h"

#include <nanobind/stl/string.h>

#include <cmath>

namespace python {
namespace {

namespace nb = nanobind;
using core::Json;

constexpr int kDeepest = 100;  // as files

Json from_python(nb::handle value, const std::string& where, int depth);

Json from_dict(const nb::dict& dict, const std::string& where, int depth) {
    Json json = Json::object();
    for (const auto& [key, value] : dict) {
        if (!nb::isinstance<nb::str>(key)) {
            throw core::Error(where, "found a key that is no text", "must have texts as keys");
        }
        const auto name = nb::cast<std::string>(key);
        json[name] = from_python(value, core::join_key(where, name), depth + 1);
    }
    return json;
}

Json from_sequence(nb::handle values, const std::string& where, int depth) {
    Json json = Json::array();
    for (nb::handle value : values) {
        json.push_back(
            from_python(value, where + "[" + std::to_string(json.size()) + "]", depth + 1));
    }
    return json;
}

Json from_number(nb::handle value, const std::string& where) {
    const auto number = nb::cast<double>(nb::float_(value));
    if (!std::isfinite(number)) {
        throw core::Error(where, "found " + std::to_string(number), "must be a finite number");
    }
    return number;
}

// Whole numbers of Python and NumPy have __index__.
Json from_index(nb::handle value, const std::string& where) {
    const auto index = nb::steal(PyNumber_Index(value.ptr()));
    if (!index.is_valid()) throw nb::python_error();
    std::int64_t small = 0;
    if (nb::try_cast(index, small)) return small;
    std::uint64_t large = 0;
    if (nb::try_cast(index, large)) return large;
    throw core::Error(where, "found a number of more than 64 bits", "must be smaller");
}

Json from_python(nb::handle value, const std::string& where, int depth) {
    if (depth > kDeepest)
        throw core::Error(where, "is nested too deeply", "must hold itself less often");
    if (value.is_none()) return nullptr;
    if (nb::isinstance<nb::bool_>(value)) return nb::cast<bool>(value);
    if (nb::isinstance<nb::str>(value)) return nb::cast<std::string>(value);
    if (nb::isinstance<nb::dict>(value))
        return from_dict(nb::borrow<nb::dict>(value), where, depth);
    if (nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value)) {
        return from_sequence(value, where, depth);
    }
    if (PyFloat_Check(value.ptr())) return from_number(value, where);
    if (nb::hasattr(value, "tolist")) return from_python(value.attr("tolist")(), where, depth + 1);
    if (PyIndex_Check(value.ptr())) return from_index(value, where);
    if (nb::hasattr(value, "__fspath__")) {
        return from_python(value.attr("__fspath__")(), where, depth + 1);
    }
    throw core::Error(
        where,
        "found an object of type " + nb::cast<std::string>(value.type().attr("__name__")),
        "must be a number, text, list or dictionary");
}

}  // namespace

Json json_from_python(nb::handle value, const std::string& where) {
    return from_python(value, where, 0);
}

std::string path_from(nb::handle value) {
    const Json json = json_from_python(value, "path");
    if (!json.is_string()) core::throw_wrong_type("path", json, "a path");
    return json.get<std::string>();
}

nb::object python_from_json(const Json& json) {
    switch (json.type()) {
        case Json::value_t::object: {
            nb::dict dict;
            for (const auto& [key, value] : json.items())
                dict[key.c_str()] = python_from_json(value);
            return dict;
        }
        case Json::value_t::array: {
            nb::list list;
            for (const Json& value : json) list.append(python_from_json(value));
            return list;
        }
        case Json::value_t::string:
            return nb::cast(json.get<std::string>());
        case Json::value_t::boolean:
            return nb::cast(json.get<bool>());
        case Json::value_t::number_integer:
            return nb::cast(json.get<std::int64_t>());
        case Json::value_t::number_unsigned:
            return nb::cast(json.get<std::uint64_t>());
        case Json::value_t::number_float:
            return nb::cast(json.get<double>());
        default:
            return nb::none();
    }
}

}  // namespace python
