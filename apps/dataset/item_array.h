// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/shape.h"
#include "nlos/containers/stored_number.h"

#include <cstring>
#include <span>
#include <string>

namespace apps {

/// A named array of one item, as it is stored.
struct ItemArray {
    std::string name;
    nlos::Shape shape;  ///< of one item; empty for a number
    nlos::StoredNumber number = nlos::StoredNumber::Float32;
    std::string bytes;  ///< in the machine's order, slowest axis first
};

template <class T>
ItemArray make_item_array(std::string name,
                          nlos::Shape shape,
                          nlos::StoredNumber number,
                          std::span<const T> values) {
    return {std::move(name),
            std::move(shape),
            number,
            {reinterpret_cast<const char*>(values.data()), values.size_bytes()}};
}

}  // namespace apps
