// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/system/output_file.h"

#include <fstream>
#include <string>

namespace nlos {

/// A tar archive being written (the format ustar of POSIX), as WebDataset reads it; finish() puts
/// it in place. The same members give the same bytes: owner and times are 0.
///
/// Our own, since a header of 512 bytes is all there is to it, while the libraries for archives
/// bring a dozen others with them.
///
/// Writes that fail (disk full) throw core::Failure and leave an older file as it was.
/// source   [POSIX2017], pax
class TarWriter {
 public:
    /// Throws core::Error when the target's folder does not exist or cannot be written.
    explicit TarWriter(std::string target);

    /// Adds a file.
    /// name   of at most 100 bytes
    void add(const std::string& name, const std::string& bytes);

    void finish();

 private:
    void write(const std::string& bytes);

    std::string target_;
    core::OutputFile output_;
    std::ofstream stream_;
};

}  // namespace nlos
