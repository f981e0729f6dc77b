// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/canvas/canvas.h"
#include "nlos/pictures/panel.h"

#include <string>
#include <vector>

namespace nlos {

/// Draws panels in reading order in so many columns, on white: the next one stands where there is
/// room farthest up.
///
/// format    PNG at twice the usual density of pixels, or SVG or PDF, whose lines and letters stay
///           sharp at any size
/// returns   the bytes of the file
/// throws    core::Error when there is no panel or a panel's values do not match its size
std::string encode_panels(const std::vector<Panel>& panels,
                          int columns,
                          PictureFormat format = PictureFormat::Png);

/// Writes the same picture, in the format of its suffix; whole or not at all.
/// throws    also core::Error for a bad target and core::Failure when writing fails
void write_panels(const std::string& path, const std::vector<Panel>& panels, int columns);

/// The format of a file by its suffix: .png, .svg or .pdf. Throws core::Error for others.
PictureFormat picture_format(const std::string& path);

/// Throws core::Error when `path`, unless it is empty, ends in no suffix of a picture.
void check_picture_suffix(const std::string& path);

}  // namespace nlos
