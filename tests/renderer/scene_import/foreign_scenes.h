// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene_import/scene_import.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <algorithm>
#include <string>

namespace scene_import_test {

/// Imports a scene from a text; a triangle stands beside it as shape.obj.
inline renderer::ImportedScene import_text(const std::string& name, const std::string& text) {
    const test_support::TemporaryFolder folder;
    test_support::write_file_bytes(folder.file("shape.obj"),
                                   "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    test_support::write_file_bytes(folder.file(name), text);
    return renderer::import_scene(folder.file(name));
}

/// True when a line of what is not translated contains `part`.
inline bool lists(const renderer::ImportedScene& scene, const std::string& part) {
    return std::any_of(
        scene.not_translated.begin(), scene.not_translated.end(), [&](const std::string& line) {
            return line.find(part) != std::string::npos;
        });
}

/// The text with each $NAME replaced; unnamed ones become empty.
inline std::string filled(std::string text,
                          const std::vector<std::pair<std::string, std::string>>& values) {
    for (const auto& [name, value] : values) {
        for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at)) {
            text.replace(at, name.size(), value);
            at += value.size();
        }
    }
    return text;
}

}  // namespace scene_import_test
