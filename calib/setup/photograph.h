// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace calib {

/// A grey picture on the sensor's own grid of pixels, row by row from the top.
struct Photograph {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> grey;
};

/// Reads a PNG or JPEG file, of grey or colour, of 8 or 16 bits; alpha is left aside.
///
/// throws    core::Error for other and damaged files, and for those with an EXIF orientation: a
///           camera is calibrated on its sensor's own grid, which turned views would mix up, while
///           many programs show, and count pixels in, the turned picture
Photograph read_photograph(const std::string& path);

}  // namespace calib
