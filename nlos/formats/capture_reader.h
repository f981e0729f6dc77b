// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/formats/capture_file.h"

#include <string>

namespace nlos {

/// One known capture format. To add one: write a .cpp that defines its row, declare the row below
/// and list it in kReaders of capture_file.cpp.
struct CaptureReader {
    const char* name;     ///< for people
    const char* content;  ///< what its files hold, for the message about an unknown file

    /// True when the file is of this format, be it damaged further on.
    bool (*recognise)(const std::string& path);
    core::Capture (*read)(const std::string& path, const CaptureReadSettings& settings);

    int default_zero_bins = 0;  ///< leading bins that the format's authors drop
};

extern const CaptureReader kYtalReader;
extern const CaptureReader kStanfordReader;
extern const CaptureReader kPointListReader;

}  // namespace nlos
