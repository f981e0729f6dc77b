// SPDX-License-Identifier: MIT
#include "renderer/core/mapped_file.h"

#include "renderer/core/error.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

namespace core {
namespace {

/// An open file, closed again at the end.
struct Descriptor {
    int number = -1;
    ~Descriptor() {
        if (number >= 0) ::close(number);
    }
};

/// Bytes of an open file that are not in holes; all where the file system does not tell.
std::uint64_t stored_bytes(int file, off_t size) {
    std::uint64_t stored = 0;
    for (off_t at = 0; at < size;) {
        const off_t begin = ::lseek(file, at, SEEK_DATA);
        if (begin < 0) return errno == ENXIO ? stored : static_cast<std::uint64_t>(size);
        at = ::lseek(file, begin, SEEK_HOLE);
        stored += static_cast<std::uint64_t>(at - begin);
    }
    return stored;
}

}  // namespace

MappedFile::MappedFile(std::string path, std::string allowed)
    : path_(std::move(path)), allowed_(std::move(allowed)) {
    const auto refuse = [&](const std::string& found) { throw Error(path_, found, allowed_); };
    // Without O_NONBLOCK, to open a pipe waits for its writer.
    const Descriptor file{::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
    struct stat status {};
    if (file.number < 0 || ::fstat(file.number, &status) != 0) {
        refuse(std::string("cannot be opened (") + std::strerror(errno) + ")");
    }
    if (S_ISDIR(status.st_mode)) refuse("is a folder");
    if (!S_ISREG(status.st_mode)) refuse("is no regular file");
    if (status.st_size == 0) return;
    const auto size = static_cast<std::size_t>(status.st_size);
    void* const begin = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.number, 0);
    if (begin == MAP_FAILED) refuse(std::string("cannot be read (") + std::strerror(errno) + ")");
    bytes_ = {static_cast<const char*>(begin), size};
    stored_bytes_ = stored_bytes(file.number, status.st_size);
}

MappedFile::~MappedFile() {
    if (!bytes_.empty()) ::munmap(const_cast<char*>(bytes_.data()), bytes_.size());
}

void MappedFile::require_stored() const {
    constexpr std::uint64_t kLarge = 64'000'000;
    constexpr std::uint64_t kLargestRatio = 100;
    if (bytes_.size() < kLarge || bytes_.size() / kLargestRatio < stored_bytes_) return;
    throw Error(path_,
                "has " + std::to_string(bytes_.size()) + " bytes, of which " +
                    std::to_string(stored_bytes_) + " are stored",
                allowed_);
}

std::string first_bytes(const std::string& path, std::size_t count) {
    std::ifstream file(path, std::ios::binary);
    std::string bytes(count, '\0');
    file.read(bytes.data(), static_cast<std::streamsize>(count));
    bytes.resize(static_cast<std::size_t>(file.gcount()));
    return bytes;
}

}  // namespace core
