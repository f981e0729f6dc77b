// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace core {

/// The bytes of a regular file, without a copy of them: what nobody looks at is not read.
class MappedFile {
 public:
    /// Throws Error, with what is allowed, for what is no regular file or cannot be read.
    explicit MappedFile(std::string path,
                        std::string allowed = "must be a readable file that fits in memory");
    ~MappedFile();
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;

    std::string_view bytes() const { return bytes_; }

    /// Throws Error for a large file of which next to nothing is stored: only holes, which take no
    /// space on a disk and all the time and memory of what they claim to be.
    void require_stored() const;

 private:
    std::string path_;
    std::string allowed_;
    std::uint64_t stored_bytes_ = 0;  ///< without holes
    std::string_view bytes_;
};

/// The first `count` bytes of a file; fewer of a shorter one, none of one that cannot be read.
std::string first_bytes(const std::string& path, std::size_t count);

}  // namespace core
