// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

namespace nlos {

/// The bytes of DejaVu Sans (.ttf), which become part of the program: pictures need no font where
/// it runs.
std::span<const std::byte> font_bytes();

}  // namespace nlos
