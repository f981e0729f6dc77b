// SPDX-License-Identifier: MIT
#include "nlos/containers/deflated_bytes.h"

#include <isa-l/igzip_lib.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

namespace nlos {

std::optional<std::size_t> unpack(std::string_view packed,
                                  DeflateFrame frame,
                                  const std::function<void(std::string_view piece)>& take) {
    constexpr std::size_t kMostIn = std::size_t{1} << 30;  // the library counts in 32 bits
    constexpr std::size_t kPieceBytes = std::size_t{1} << 18;
    const auto state = std::make_unique<inflate_state>();
    ::isal_inflate_init(state.get());
    state->crc_flag = frame == DeflateFrame::Zlib ? ISAL_ZLIB : ISAL_GZIP;
    std::vector<std::uint8_t> piece(kPieceBytes);
    std::size_t given = 0;
    while (state->block_state != ISAL_BLOCK_FINISH) {
        if (state->avail_in == 0) {
            state->next_in =
                reinterpret_cast<std::uint8_t*>(const_cast<char*>(packed.data())) + given;
            state->avail_in = static_cast<std::uint32_t>(std::min(kMostIn, packed.size() - given));
            given += state->avail_in;
        }
        state->next_out = piece.data();
        state->avail_out = static_cast<std::uint32_t>(piece.size());
        const bool is_fed = state->avail_in > 0;
        if (::isal_inflate(state.get()) != ISAL_DECOMP_OK) return std::nullopt;
        const std::size_t size = piece.size() - state->avail_out;
        if (!is_fed && size == 0 && state->block_state != ISAL_BLOCK_FINISH) return std::nullopt;
        take({reinterpret_cast<const char*>(piece.data()), size});
    }
    // What was read ahead belongs to what follows.
    return given - state->avail_in - static_cast<std::size_t>(state->read_in_length / 8);
}

}  // namespace nlos
