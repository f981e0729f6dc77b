// SPDX-License-Identifier: MIT
#include "nlos/containers/stored_number.h"

#include <Eigen/Core>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace nlos {
namespace {

template <class Stored>
Stored load(const char* bytes, std::endian order) {
    std::array<char, sizeof(Stored)> own;
    std::copy_n(bytes, own.size(), own.begin());
    if (order != std::endian::native) std::reverse(own.begin(), own.end());
    return std::bit_cast<Stored>(own);
}

template <class Stored, class Wanted>
std::string convert(const char* stored, std::size_t count, std::endian order) {
    std::string bytes(count * sizeof(Wanted), '\0');
    for (std::size_t i = 0; i < count; ++i) {
        const auto value = static_cast<Wanted>(load<Stored>(stored + i * sizeof(Stored), order));
        std::memcpy(bytes.data() + i * sizeof(Wanted), &value, sizeof(Wanted));
    }
    return bytes;
}

/// Calls `use` with a value of the type that stores such numbers.
template <class Use>
auto with_type(StoredNumber number, Use&& use) {
    switch (number) {
        case StoredNumber::Int8:
            return use(std::int8_t{});
        case StoredNumber::UInt8:
            return use(std::uint8_t{});
        case StoredNumber::Int16:
            return use(std::int16_t{});
        case StoredNumber::UInt16:
            return use(std::uint16_t{});
        case StoredNumber::Int32:
            return use(std::int32_t{});
        case StoredNumber::UInt32:
            return use(std::uint32_t{});
        case StoredNumber::Int64:
            return use(std::int64_t{});
        case StoredNumber::UInt64:
            return use(std::uint64_t{});
        case StoredNumber::Float16:
            return use(Eigen::half{});
        case StoredNumber::Float32:
            return use(float{});
        case StoredNumber::Float64:
            break;
    }
    return use(double{});
}

}  // namespace

std::size_t bytes_of(StoredNumber number) {
    return with_type(number, [](auto value) { return sizeof(value); });
}

ElementKind kind_of(StoredNumber number) {
    return number < StoredNumber::Float16 ? ElementKind::Integer : ElementKind::Real;
}

std::string type_name(StoredNumber number) {
    return with_type(number, [](auto value) {
        using Value = decltype(value);
        const char* base = std::is_unsigned_v<Value>   ? "uint"
                           : std::is_integral_v<Value> ? "int"
                                                       : "float";
        return fmt::format("{}{}", base, 8 * sizeof(Value));
    });
}

double number_at(const char* stored, StoredNumber number, std::endian order) {
    return with_type(number, [&](auto value) {
        return static_cast<double>(load<decltype(value)>(stored, order));
    });
}

std::string convert_numbers(const char* stored,
                            std::size_t count,
                            StoredNumber number,
                            std::endian order,
                            Precision precision) {
    return with_type(number, [&](auto value) {
        using Stored = decltype(value);
        return precision == Precision::Double ? convert<Stored, double>(stored, count, order)
                                              : convert<Stored, float>(stored, count, order);
    });
}

}  // namespace nlos
