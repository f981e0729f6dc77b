// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace fuzz {

/// Writes the fuzzer's bytes to a file in memory and reads it.
///
/// name   of the file, for formats told by suffix; it stands in a folder of this process
/// read   may throw core::Error with one line, or core::Failure; whatever else happens is a finding
void read_fuzzed_file(const std::uint8_t* data,
                      std::size_t size,
                      const std::string& name,
                      const std::function<void(const std::string& path)>& read);

}  // namespace fuzz
