// SPDX-License-Identifier: MIT
#pragma once

#include "apps/terminal.h"
#include "nlos/layouts/capture_settings.h"

#include <string>
#include <utility>
#include <vector>

namespace apps {

/// What a file is and what it holds, in lines for people.
///
/// paths      one file, or the frames of a sequence
/// settings   what is told of a capture beside its file
/// throws     core::Error when there is no such file, or it is damaged
std::string describe_files(const std::vector<std::string>& paths,
                           const nlos::CaptureReadSettings& settings = {});

/// Adds to lines that describe a file; every part is made printable.
template <class... Parts>
void add_line(std::string& text, fmt::format_string<Parts...> format, Parts&&... parts) {
    text += message(format, std::forward<Parts>(parts)...) + "\n";
}

/// Says what the objects of a glTF or mesh file are to the renderer. Throws core::Error as
/// renderer::load_geometry().
void describe_geometry(std::string& text, const std::string& path);

/// Says what a scene's objects are, its scan, where its light lies on the time axis, and which
/// settings differ from the defaults. Throws core::Error when the scene cannot be rendered.
void describe_scene(std::string& text, const std::string& path);

}  // namespace apps
