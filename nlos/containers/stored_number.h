// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/array_file.h"

#include <bit>
#include <string>

namespace nlos {

/// How a number is stored in a file.
enum class StoredNumber {
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Float16,
    Float32,
    Float64
};

std::size_t bytes_of(StoredNumber number);
ElementKind kind_of(StoredNumber number);
std::string type_name(StoredNumber number);  ///< "uint16", "float32", ...

/// The number that begins at `stored`, aligned anyhow.
double number_at(const char* stored, StoredNumber number, std::endian order);

/// Numbers as the bytes of float or double.
///
/// stored   `count` numbers, aligned anyhow, in byte order `order`
std::string convert_numbers(const char* stored,
                            std::size_t count,
                            StoredNumber number,
                            std::endian order,
                            Precision precision);

}  // namespace nlos
