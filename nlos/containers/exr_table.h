// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace nlos {

/// An OpenEXR file as numbers: channels of equal size and named values in its header.
struct ExrTable {
    std::size_t width = 0;
    std::size_t height = 0;
    std::map<std::string, std::vector<float>> channels;  ///< stored [row][column]
    std::map<std::string, double> numbers;
    std::map<std::string, std::string> texts;
    std::map<std::string, std::vector<float>> lists;
};

/// True when the file starts like an OpenEXR file. Throws nothing.
bool is_exr_file(const std::string& path);

/// Reads a single image of scan lines, each channel as float.
///
/// The format guards packed pixels only, so that files of ours state a checksum of pixels and of
/// the attributes nlos*: the attribute nlosCrc32.
///
/// throws   core::Error when it is damaged, cut short, or tiled, deep or of several parts;
///          core::Failure when it would not fit in memory
ExrTable read_exr_table(const std::string& path);

/// Writes scan lines of floats, compressed without loss; whole or not at all.
///
/// throws   core::Error for a bad target, core::Failure when writing fails
void write_exr_table(const std::string& path, const ExrTable& table);

}  // namespace nlos
