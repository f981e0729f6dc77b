// SPDX-License-Identifier: MIT
// Files that are often taken for captures and that nobody could read as they are.
#include "nlos/containers/array_file.h"
#include "nlos/containers/stored_number.h"
#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"

#include <fmt/core.h>

#include <array>
#include <filesystem>

namespace nlos {
namespace {

/// What Git leaves in place of a large file that was not fetched.
bool is_lfs_pointer(const std::string& path) {
    constexpr std::string_view kStart = "version https://git-lfs.github.com/spec/";
    return core::first_bytes(path, kStart.size()) == kStart;
}

std::unique_ptr<ArrayFile> refuse_lfs_pointer(const std::string& path) {
    throw core::Error(path,
                      "is a Git LFS pointer, a few lines in place of the file",
                      "must be the file itself, which `git lfs pull` fetches");
}

/// Whether the first variable of a MATLAB file of version 4 could begin here: its type, which is
/// 1000 times the byte order, 10 times the kind of numbers, and the kind of array; its rows and
/// columns; whether it is complex; and the length of its name, which ends in a 0.
bool is_mat4_header(std::string_view start, std::endian order, std::uint64_t file_bytes) {
    constexpr std::array<std::uint64_t, 6> kNumberBytes{8, 4, 4, 2, 2, 1};
    constexpr std::uint64_t kHeaderBytes = 20;
    const auto word = [&](std::size_t i) {
        return static_cast<std::uint64_t>(
            number_at(start.data() + 4 * i, StoredNumber::UInt32, order));
    };
    const std::uint64_t type = word(0);
    const std::uint64_t kind = type / 10 % 10;
    const std::uint64_t name_bytes = word(4);
    const bool is_type = type / 1000 == (order == std::endian::big ? 1U : 0U) &&
                         type / 100 % 10 == 0 && kind < kNumberBytes.size() && type % 10 <= 2;
    if (!is_type || word(3) > 1 || name_bytes < 2 || kHeaderBytes + name_bytes > start.size()) {
        return false;
    }
    const std::string_view name = start.substr(kHeaderBytes, name_bytes);
    const auto is_letter = [](char c) { return (c | 32) >= 'a' && (c | 32) <= 'z'; };
    return is_letter(name.front()) && name.find('\0') == name.size() - 1 &&
           total_bytes({word(1), word(2)}, kNumberBytes[kind]) <= file_bytes;
}

bool is_mat4_file(const std::string& path) {
    constexpr std::size_t kLongestStart = 84;  // names have at most 63 letters
    constexpr std::size_t kShortestStart = 22;
    const std::string start = core::first_bytes(path, kLongestStart);
    if (start.size() < kShortestStart) return false;
    std::error_code ignored;
    const std::uint64_t bytes = std::filesystem::file_size(path, ignored);
    return is_mat4_header(start, std::endian::little, bytes) ||
           is_mat4_header(start, std::endian::big, bytes);
}

std::unique_ptr<ArrayFile> refuse_mat4(const std::string& path) {
    throw core::Error(path,
                      "is a MATLAB file of version 4, which holds tables only",
                      "must be of version 5 or 7.3: save(..., '-v7') or save(..., '-v7.3')");
}

}  // namespace

Container lfs_pointer_refusal() {
    return {nullptr, is_lfs_pointer, refuse_lfs_pointer};
}

Container mat4_refusal() {
    return {nullptr, is_mat4_file, refuse_mat4};
}

}  // namespace nlos
