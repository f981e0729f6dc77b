// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/settings_json.h"

#include <nanobind/nanobind.h>

#include <string>

namespace python {

/// A Python value as JSON: None, truth values, numbers, texts, paths, lists, tuples, NumPy arrays
/// and scalars, and dictionaries with texts as keys.
///
/// where    what messages call the value
/// throws   core::Error naming the part that is something else or no finite number
core::Json json_from_python(nanobind::handle value, const std::string& where);

/// A path, as a text or anything with __fspath__.
/// throws   core::Error naming the argument `path`
std::string path_from(nanobind::handle value);

/// JSON as dictionaries, lists, texts and numbers.
nanobind::object python_from_json(const core::Json& json);

/// Settings from keyword arguments, over their defaults or what `settings` holds already.
template <core::SettingsStruct S>
S settings_from_python(const nanobind::dict& keywords, S settings = {}) {
    core::read_value(json_from_python(keywords, ""), "", settings);
    return settings;
}

}  // namespace python
