// SPDX-License-Identifier: MIT
#include "nlos/containers/writers/packed_chunk.h"

#include "renderer/core/error.h"

#include <zlib.h>

namespace nlos {
namespace {

/// All first bytes, then all second ones, and so on: what the filter shuffle does.
std::string shuffle(const std::string& numbers, std::size_t number_bytes) {
    const std::size_t count = numbers.size() / number_bytes;
    std::string shuffled(numbers.size(), '\0');
    for (std::size_t byte = 0; byte < number_bytes; ++byte) {
        char* target = shuffled.data() + byte * count;
        const char* source = numbers.data() + byte;
        for (std::size_t i = 0; i < count; ++i) target[i] = source[i * number_bytes];
    }
    return shuffled;
}

}  // namespace

std::string pack_chunk(const std::string& numbers, std::size_t number_bytes, int level) {
    if (level == 0) return numbers;
    const std::string shuffled = shuffle(numbers, number_bytes);
    uLongf size = ::compressBound(static_cast<uLong>(shuffled.size()));
    std::string packed(size, '\0');
    const int status = ::compress2(reinterpret_cast<Bytef*>(packed.data()),
                                   &size,
                                   reinterpret_cast<const Bytef*>(shuffled.data()),
                                   static_cast<uLong>(shuffled.size()),
                                   level);
    if (status != Z_OK) throw core::Failure("deflate", "not enough memory");
    packed.resize(size);
    return packed;
}

}  // namespace nlos
