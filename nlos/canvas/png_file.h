// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace nlos {

/// The bytes of a .png of pixels that are stored as blue, green, red and one unused byte.
///
/// Rows are stored as differences from the row above and packed lightly: for drawings that takes a
/// fifth of the time of cairo's own writer, for half as many bytes again.
///
/// pixels    first byte of the top row
/// stride    bytes from one row to the next, at least 4 width
/// throws    core::Failure when they cannot be packed
std::string encode_png(const unsigned char* pixels, int width, int height, int stride);

}  // namespace nlos
