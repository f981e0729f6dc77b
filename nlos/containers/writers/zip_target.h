// SPDX-License-Identifier: MIT
#pragma once

#include <string>

struct zip_source;

namespace nlos {

/// A file that libzip writes an archive to, in place: by itself libzip writes to a name of its own
/// beside the target, which nobody removes when the program is ended.
///
/// path      of an empty file that exists
/// returns   a source for zip_open_from_source(), to which it belongs then; null when the file
///           cannot be opened
zip_source* zip_target(const std::string& path);

}  // namespace nlos
