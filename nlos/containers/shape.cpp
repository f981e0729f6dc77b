// SPDX-License-Identifier: MIT
#include "nlos/containers/shape.h"

#include <fmt/ranges.h>

#include <limits>

namespace nlos {

std::string shape_text(const Shape& shape) {
    return shape.size() == 1 ? fmt::format("({},)", shape[0])
                             : fmt::format("({})", fmt::join(shape, ", "));
}

std::uint64_t total_bytes(const Shape& shape, std::uint64_t bytes) {
    std::uint64_t total = bytes;
    for (const std::size_t extent : shape) {
        if (extent != 0 && total > std::numeric_limits<std::uint64_t>::max() / extent) {
            return std::numeric_limits<std::uint64_t>::max();
        }
        total *= extent;
    }
    return total;
}

std::uint64_t values_per_row(const Shape& shape) {
    return shape.empty() ? 1 : total_bytes({shape.begin() + 1, shape.end()}, 1);
}

}  // namespace nlos
