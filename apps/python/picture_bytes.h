// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/pictures/picture.h"

#include <nanobind/nanobind.h>

#include <string>
#include <vector>

namespace python {

/// Draws panels for Python.
///
/// format    png, svg or pdf
/// throws    core::Error for other formats
inline nanobind::bytes picture_bytes(const std::vector<nlos::Panel>& panels,
                                     int columns,
                                     const std::string& format) {
    const std::string bytes =
        nlos::encode_panels(panels, columns, nlos::picture_format("picture." + format));
    return nanobind::bytes(bytes.data(), bytes.size());
}

}  // namespace python
