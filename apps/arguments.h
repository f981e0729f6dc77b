// SPDX-License-Identifier: MIT
#pragma once

#include "apps/command.h"

#include <span>
#include <string>
#include <vector>

namespace apps {

/// Splits `--set a=1 b=2` into one `--set` per item, so that it may stand before other arguments.
std::vector<std::string> expand_set_arguments(const std::vector<std::string>& arguments);

/// Declares an argument or an option that names a file, or several; shells offer those with the
/// suffixes that the meaning names in parentheses, as in "Scene description (.json)".
template <class Paths>
CLI::Option* add_file_option(CLI::App& command,
                             const std::string& name,
                             Paths& paths,
                             const std::string& meaning) {
    return command.add_option(name, paths, meaning)->type_name("FILE");
}

/// The same of a folder.
template <class Paths>
CLI::Option* add_folder_option(CLI::App& command,
                               const std::string& name,
                               Paths& paths,
                               const std::string& meaning) {
    return command.add_option(name, paths, meaning)->type_name("DIR");
}

/// Declares `-o`, the file to write, which has a name if it is given.
CLI::Option* add_output_option(CLI::App& command, std::string& path, const std::string& meaning);

/// Declares `-o`, the folder to write into, likewise.
CLI::Option* add_output_folder_option(CLI::App& command,
                                      std::string& path,
                                      const std::string& meaning);

/// Declares `--picture`, for a command that writes one as .png beside its result.
CLI::Option* add_picture_option(CLI::App& command, std::string& path);

/// Declares the repeatable `--set key.path=value`; its texts go to `overrides`, before those of
/// shorthands.
void add_set_option(CLI::App& command, std::vector<std::string>& overrides);

/// A flag that stands for one `--set`, with a value, or without one for settings that are true or
/// false.
struct Shorthand {
    const char* flag;
    const char* key;
    const char* type;  ///< empty: a switch
    const char* help;
};

/// Declares the flags; those given go to `overrides` as `key=value`. Help names the choices and the
/// default that command.settings has for the key.
void add_shorthands(Command& command,
                    std::span<const Shorthand> shorthands,
                    std::vector<std::string>& overrides);

/// Declares `--threads`; 0 takes all processors.
void add_threads_option(CLI::App& command, int& threads);

/// The command line as it was typed, for provenance; set once by main().
std::string& command_line();

/// Throws core::Error when `path`, unless it is empty, ends in none of the suffixes.
void require_suffix(const std::string& path, const std::vector<std::string>& suffixes);

/// Replaces the suffix of `path`, or appends it where there is none.
std::string with_suffix(const std::string& path, const std::string& suffix);

}  // namespace apps
