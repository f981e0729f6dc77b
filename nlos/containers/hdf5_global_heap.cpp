// SPDX-License-Identifier: MIT
#include "nlos/containers/hdf5_global_heap.h"

#include "renderer/core/error.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <string_view>
#include <vector>

namespace nlos {
namespace {

// A collection: signature, version 1, three zeros, its size; then objects, which fill it exactly.
// An object: index (2 bytes), reference count (2), zeros (4), size (8), data padded to 8 bytes.
// Index 0 is the free space at the end, whose size counts its own header.
constexpr std::string_view kSignature{"GCOL\1\0\0\0", 8};
constexpr std::uint64_t kHeapHeaderBytes = 16;
constexpr std::uint64_t kLargestCollection = std::uint64_t{1} << 28;

template <class T>
T value_at(const std::vector<char>& bytes, std::uint64_t position) {
    T value{};
    std::memcpy(&value, bytes.data() + position, sizeof(T));
    return value;
}

bool is_sound(const std::vector<char>& collection) {
    std::uint64_t position = kHeapHeaderBytes;
    while (position < collection.size()) {
        const std::uint64_t left = collection.size() - position;
        if (left < kHeapHeaderBytes) return true;  // too little for an object: unused
        const auto index = value_at<std::uint16_t>(collection, position);
        const auto zeros = value_at<std::uint32_t>(collection, position + 4);
        const auto bytes = value_at<std::uint64_t>(collection, position + 8);
        if (index == 0) return bytes == left;
        if (zeros != 0 || bytes > left - kHeapHeaderBytes) return false;
        position += kHeapHeaderBytes + (bytes + 7) / 8 * 8;
    }
    return position == collection.size();
}

/// Reads the collection that begins at `begin`; empty when it does not lie within the file.
std::vector<char> read_collection(std::ifstream& file, std::uint64_t begin) {
    std::array<char, kHeapHeaderBytes> header{};
    if (begin > static_cast<std::uint64_t>(std::numeric_limits<std::streamoff>::max())) return {};
    file.clear();
    file.seekg(static_cast<std::streamoff>(begin));
    if (!file.read(header.data(), header.size())) return {};
    std::uint64_t bytes = 0;
    std::memcpy(&bytes, header.data() + 8, sizeof(bytes));
    if (bytes < kHeapHeaderBytes || bytes > kLargestCollection) return {};
    std::vector<char> collection(bytes);
    file.seekg(static_cast<std::streamoff>(begin));
    if (!file.read(collection.data(), static_cast<std::streamsize>(bytes))) return {};
    return collection;
}

/// True when a sound collection holds an object `index` of at least `bytes` bytes.
bool has_object(const std::vector<char>& collection, std::uint32_t index, std::uint64_t bytes) {
    std::uint64_t position = kHeapHeaderBytes;
    while (position + kHeapHeaderBytes <= collection.size()) {
        const auto found = value_at<std::uint16_t>(collection, position);
        const auto size = value_at<std::uint64_t>(collection, position + 8);
        if (found == 0) return false;
        if (found == index) return size >= bytes;
        position += kHeapHeaderBytes + (size + 7) / 8 * 8;
    }
    return false;
}

[[noreturn]] void throw_damaged_texts(const std::string& path) {
    throw core::Error(path, "has damaged texts", "must be an undamaged HDF5 file");
}

}  // namespace

void check_text_reference(const std::string& path, std::uint64_t position) {
    // A reference: length (4 bytes), address of the collection (8), index of the object (4).
    std::ifstream file(path, std::ios::binary);
    std::vector<char> reference(16);
    file.seekg(static_cast<std::streamoff>(position));
    if (!file.read(reference.data(), static_cast<std::streamsize>(reference.size()))) {
        throw_damaged_texts(path);
    }
    const auto bytes = value_at<std::uint32_t>(reference, 0);
    const auto address = value_at<std::uint64_t>(reference, 4);
    if (bytes == 0 && address == 0) return;  // an empty text
    const std::vector<char> collection = read_collection(file, address);
    if (collection.empty() || !is_sound(collection) ||
        !has_object(collection, value_at<std::uint32_t>(reference, 12), bytes)) {
        throw_damaged_texts(path);
    }
}

void check_text_heaps(const std::string& path) {
    constexpr std::size_t kBlock = std::size_t{1} << 20;
    constexpr std::size_t kOverlap = kSignature.size() - 1;
    std::ifstream file(path, std::ios::binary);
    std::vector<char> block(kBlock);
    for (std::uint64_t begin = 0;; begin += kBlock - kOverlap) {
        file.clear();
        file.seekg(static_cast<std::streamoff>(begin));
        file.read(block.data(), kBlock);
        const auto count = static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount()));
        const std::string_view text(block.data(), count);
        for (std::size_t at = text.find(kSignature); at != std::string_view::npos;
             at = text.find(kSignature, at + 1)) {
            const std::vector<char> collection = read_collection(file, begin + at);
            if (collection.empty() || !is_sound(collection)) {
                throw_damaged_texts(path);
            }
        }
        if (count < kBlock) return;
    }
}

}  // namespace nlos
