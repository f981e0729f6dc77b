// SPDX-License-Identifier: MIT
#include "nlos/containers/mapped_file.h"

#include "renderer/core/error.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace nlos {

MappedFile::MappedFile(const std::string& path) {
    struct stat status {};
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool is_open = file >= 0 && ::fstat(file, &status) == 0;
    const auto size = static_cast<std::size_t>(status.st_size);
    void* begin = MAP_FAILED;
    if (is_open && size > 0) begin = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
    if (file >= 0) ::close(file);
    if (begin != MAP_FAILED) {
        bytes_ = {static_cast<const char*>(begin), size};
    } else if (!is_open || size > 0) {
        throw core::Error(path, "cannot be read", "must be a readable file that fits in memory");
    }
}

MappedFile::~MappedFile() {
    if (!bytes_.empty()) ::munmap(const_cast<char*>(bytes_.data()), bytes_.size());
}

}  // namespace nlos
