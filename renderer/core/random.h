// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace core {

/// A stream of random numbers that depends on nothing but its three indices.
///
/// Each work item has its own stream, so results do not depend on which thread runs it.
/// The generator is SplitMix64 from a hashed start (source [Steele2014]).
class Rng {
 public:
    Rng(std::uint64_t seed, std::uint64_t work_item, std::uint64_t sample)
        : state_(mix(mix(mix(seed + kStep) ^ (work_item * kItemStep)) + sample * kSampleStep)) {}

    /// A hash: all bits of the result depend on all bits of the argument.
    static constexpr std::uint64_t mix(std::uint64_t bits) {
        bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9ULL;
        bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebULL;
        return bits ^ (bits >> 31);
    }

    std::uint64_t next_bits() { return mix(state_ += kStep); }

    /// Uniform in [0, 1), all 53 bits random.
    double uniform() { return to_unit(next_bits()); }

 private:
    static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15ULL;
    static constexpr std::uint64_t kItemStep = 0xd1b54a32d192ed03ULL;
    static constexpr std::uint64_t kSampleStep = 0x8cb92ba72f3d8dd7ULL;

    static constexpr double to_unit(std::uint64_t bits) {
        return static_cast<double>(bits >> 11) * 0x1.0p-53;
    }

    std::uint64_t state_;
};

}  // namespace core
