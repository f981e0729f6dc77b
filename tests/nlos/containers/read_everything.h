// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/array_reader.h"
#include "renderer/core/error.h"

#include <string>

namespace nlos {

/// Reads an array in every way that its kind allows.
inline void read_array(const ArrayReader& file, const std::string& name) {
    constexpr std::uint64_t kMostValues = 1'000'000;
    if (!file.has(name)) return;
    const Shape shape = file.shape(name);
    const ElementKind kind = file.kind(name);
    if (kind == ElementKind::Text) file.read_text(name);
    if (kind == ElementKind::Integer) file.read_integer(name);
    if (kind == ElementKind::Text || kind == ElementKind::Other) return;
    if (total_bytes(shape, 1) > kMostValues) return;
    file.read_doubles(name, shape);
    file.read_rows(name, [](std::size_t, std::size_t, const std::vector<float>&) {});
}

/// Reads everything that a file names, up to a bound; refusals of single arrays are none of the
/// file. Throws core::Error when the file is refused.
inline void read_everything(const std::string& path) {
    constexpr std::size_t kMostNames = 64;
    const ArrayReader file(path);
    for (std::size_t i = 0; i < std::min(file.names().size(), kMostNames); ++i) {
        try {
            read_array(file, file.names()[i]);
        } catch (const core::Error&) {
        }
    }
}

}  // namespace nlos
