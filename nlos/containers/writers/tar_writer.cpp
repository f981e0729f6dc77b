// SPDX-License-Identifier: MIT
#include "nlos/containers/writers/tar_writer.h"

#include "renderer/core/error.h"

#include <fmt/core.h>

#include <cassert>
#include <numeric>

namespace nlos {
namespace {

constexpr std::size_t kBlock = 512;
constexpr std::size_t kLongestName = 100;
constexpr std::size_t kChecksumBegin = 148;
constexpr std::size_t kChecksumBytes = 8;

std::string octal(std::size_t digits, std::size_t number) {
    return fmt::format("{:0{}o}", number, digits) + '\0';
}

std::string padding(std::size_t bytes) {
    return std::string((kBlock - bytes % kBlock) % kBlock, '\0');
}

/// Name, mode, owner, group, size, time, checksum, type, link, magic and version; the rest is 0.
std::string header(const std::string& name, std::size_t bytes) {
    std::string text = name;
    text.resize(kLongestName, '\0');
    text += octal(7, 0644) + octal(7, 0) + octal(7, 0) + octal(11, bytes) + octal(11, 0);
    text += std::string(kChecksumBytes, ' ') + '0' + std::string(kLongestName, '\0');
    text += std::string("ustar\00000", 8);
    text.resize(kBlock, '\0');
    const unsigned sum =
        std::accumulate(text.begin(), text.end(), 0U, [](unsigned total, char byte) {
            return total + static_cast<unsigned char>(byte);
        });
    text.replace(kChecksumBegin, kChecksumBytes, octal(6, sum) + ' ');
    return text;
}

}  // namespace

TarWriter::TarWriter(std::string target)
    : target_(std::move(target)),
      output_(target_),
      stream_(output_.temporary(), std::ios::binary) {}

void TarWriter::write(const std::string& bytes) {
    stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!stream_) throw core::Failure(target_, "cannot be written (disk full?)");
}

void TarWriter::add(const std::string& name, const std::string& bytes) {
    assert(name.size() <= kLongestName);
    constexpr std::size_t kMostBytes = std::size_t{1} << 33;  // eleven octal digits
    if (bytes.size() >= kMostBytes) {
        throw core::Failure(target_, fmt::format("{} is too large for a tar archive", name));
    }
    write(header(name, bytes.size()));
    write(bytes);
    write(padding(bytes.size()));
}

void TarWriter::finish() {
    write(std::string(2 * kBlock, '\0'));
    stream_.close();
    if (!stream_) throw core::Failure(target_, "cannot be written (disk full?)");
    output_.commit();
}

}  // namespace nlos
