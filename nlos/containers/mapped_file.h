// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace nlos {

/// The bytes of a regular file, without a copy of them.
class MappedFile {
 public:
    /// Throws core::Error when the file cannot be read.
    explicit MappedFile(const std::string& path);
    ~MappedFile();
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;

    std::string_view bytes() const { return bytes_; }

 private:
    std::string_view bytes_;
};

}  // namespace nlos
