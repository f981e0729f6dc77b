// SPDX-License-Identifier: MIT
#pragma once

#include "apps/terminal.h"

#include <string>
#include <utility>

namespace apps {

/// Lines that describe a file, every part printable.
class Description {
 public:
    template <class... Parts>
    void print(fmt::format_string<Parts...> format, Parts&&... parts) {
        text_ += message(format, std::forward<Parts>(parts)...);
    }
    const std::string& text() const { return text_; }

 private:
    std::string text_;
};

/// Says what the objects of a glTF or mesh file are to the renderer. Throws core::Error as
/// renderer::load_geometry().
void describe_geometry(Description& out, const std::string& path);

/// Says what a scene's objects are, its scan, where its light lies on the time axis, and which
/// settings differ from the defaults. Throws core::Error when the scene cannot be rendered.
void describe_scene(Description& out, const std::string& path);

}  // namespace apps
