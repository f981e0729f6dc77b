// SPDX-License-Identifier: MIT
#include "nlos/containers/stored_number.h"

#include <Eigen/Core>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <tuple>

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

/// The types that store numbers, in the order of StoredNumber.
using StoredTypes = std::tuple<std::int8_t,
                               std::uint8_t,
                               std::int16_t,
                               std::uint16_t,
                               std::int32_t,
                               std::uint32_t,
                               std::int64_t,
                               std::uint64_t,
                               Eigen::half,
                               float,
                               double>;

/// Calls `use` with a value of the type that stores such numbers.
template <std::size_t I = 0, class Use>
auto with_type(StoredNumber number, const Use& use) {
    if constexpr (I + 1 < std::tuple_size_v<StoredTypes>) {
        if (static_cast<std::size_t>(number) != I) return with_type<I + 1>(number, use);
    }
    return use(std::tuple_element_t<I, StoredTypes>{});
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
