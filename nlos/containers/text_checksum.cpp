// SPDX-License-Identifier: MIT
#include "nlos/containers/text_checksum.h"

#include <zlib.h>

namespace nlos {

double text_checksum(std::string_view text) {
    return static_cast<double>(
        ::crc32_z(0, reinterpret_cast<const Bytef*>(text.data()), text.size()));
}

}  // namespace nlos
