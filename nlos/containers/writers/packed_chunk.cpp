// SPDX-License-Identifier: MIT
#include "nlos/containers/writers/packed_chunk.h"

#include "renderer/core/error.h"

#include <zlib.h>

#include <algorithm>
#include <cstdint>

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

std::string deflate(const std::string& bytes, int level) {
    uLongf size = ::compressBound(static_cast<uLong>(bytes.size()));
    std::string packed(size, '\0');
    const int status = ::compress2(reinterpret_cast<Bytef*>(packed.data()),
                                   &size,
                                   reinterpret_cast<const Bytef*>(bytes.data()),
                                   static_cast<uLong>(bytes.size()),
                                   level);
    if (status != Z_OK) throw core::Failure("deflate", "not enough memory");
    packed.resize(size);
    return packed;
}

/// What the filter fletcher32 appends: the sum of all words of two bytes, the first of them the
/// more significant, and the sum of these sums, carries added below; least significant byte first.
std::string fletcher32(const std::string& bytes) {
    constexpr std::size_t kBlockBytes = 720;  // after so many the library adds the carries
    std::uint32_t sum = 0;
    std::uint32_t sum_of_sums = 0;
    const auto byte = [&](std::size_t i) -> std::uint32_t {
        return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0;
    };
    const auto add_carries = [&] {
        sum = (sum & 0xffffU) + (sum >> 16);
        sum_of_sums = (sum_of_sums & 0xffffU) + (sum_of_sums >> 16);
    };
    for (std::size_t begin = 0; begin < bytes.size(); begin += kBlockBytes) {
        const std::size_t end = std::min(bytes.size(), begin + kBlockBytes);
        for (std::size_t i = begin; i < end; i += 2) {
            sum += byte(i) << 8 | byte(i + 1);
            sum_of_sums += sum;
        }
        add_carries();
    }
    add_carries();
    std::string appended;
    for (const std::uint32_t part : {sum, sum_of_sums}) {
        appended += static_cast<char>(part & 0xffU);
        appended += static_cast<char>(part >> 8);
    }
    return appended;
}

}  // namespace

std::string pack_chunk(const std::string& numbers, std::size_t number_bytes, int level) {
    const std::string packed =
        level == 0 ? numbers : deflate(shuffle(numbers, number_bytes), level);
    return packed + fletcher32(packed);
}

}  // namespace nlos
