// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace core {

/// The folder of what comes with the program, with scenes/ and data/ in it: what the environment
/// variable NLOS_DATA names; else share/nlos beside or in the folder of the program, or of the
/// Python module, that runs; else the folder of the sources that it was built from.
///
/// throws   Error when NLOS_DATA names no folder
std::string data_folder();

/// A file or folder that comes with the program, such as `scenes/letter/scene.json`.
///
/// returns   `name` where there is such a file, seen from the working folder; else its place in
///           data_folder(); else `name`
/// throws    Error as data_folder() does
std::string shipped_file(const std::string& name);

}  // namespace core
