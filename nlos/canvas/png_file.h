// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/canvas/raster.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nlos {

/// The bytes of a .png of pixels that are stored as blue, green, red and one unused byte.
///
/// Rows are stored as differences from the row above and packed lightly.
///
/// pixels    first byte of the top row
/// stride    bytes from one row to the next, at least 4 width
/// throws    core::Failure when they cannot be packed
std::string encode_png(const unsigned char* pixels, int width, int height, int stride);

/// The pixels of a PNG file, on white where it is transparent; of an animated one, its first
/// picture. returns   nothing of what is no whole PNG file
std::optional<Raster> decode_png(std::string_view bytes);

/// Joins pictures into an animation that repeats for ever; viewers that know of none show the
/// first.
///
/// frames    at least one PNG file as Canvas makes them, all of one size
/// returns   the bytes of an animated PNG file
std::string join_animated_png(const std::vector<std::string>& frames, int frames_per_second);

}  // namespace nlos
