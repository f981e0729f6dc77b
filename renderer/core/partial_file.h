// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace core {

// The temporary files of OutputFile: `.NAME.PROCESS-MACHINE.partial.SUFFIX` beside NAME.SUFFIX.

/// The file that this process writes on the way to `target`; ends in the target's suffix.
std::string partial_file_of(const std::string& target);

/// Removes the partial files of `target` whose process has ended on this machine; not those of
/// other machines or containers that share the folder, which may live. A folder that takes long to
/// list is not looked at every time.
void remove_stale_partial_files(const std::string& target);

/// Until forgotten, remove_partial_files() removes the file.
void announce_partial_file(const std::string& path);
void forget_partial_file(const std::string& path);

}  // namespace core
