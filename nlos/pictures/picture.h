// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/pictures/panel.h"

#include <string>
#include <vector>

namespace nlos {

/// Draws panels in reading order, `columns` to a row, on white.
///
/// returns   the bytes of a PNG file, at twice the usual density of pixels
/// throws    core::Error when there is no panel or a panel's values do not match its size
std::string encode_panels_png(const std::vector<Panel>& panels, int columns);

/// Writes what encode_panels_png() returns; whole or not at all.
/// throws    also core::Error for a bad target and core::Failure when writing fails
void write_panels_png(const std::string& path, const std::vector<Panel>& panels, int columns);

}  // namespace nlos
