// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace nlos {

/// Joins pictures into an animation that repeats for ever; viewers that know of none show the
/// first.
///
/// frames    at least one PNG file as Canvas makes them, all of one size
/// returns   the bytes of an animated PNG file
std::string join_animated_png(const std::vector<std::string>& frames, int frames_per_second);

}  // namespace nlos
