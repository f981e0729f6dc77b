// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings.h"

#include <CLI/CLI.hpp>

#include <span>
#include <string>
#include <vector>

namespace apps {

/// Splits `--set a=1 b=2` into one `--set` per item, so that it may stand before other arguments.
std::vector<std::string> expand_set_arguments(const std::vector<std::string>& arguments);

/// Declares `-o`, the file or folder to write, which has a name if it is given.
CLI::Option* add_output_option(CLI::App& command, std::string& path, const std::string& meaning);

/// Declares the repeatable `--set key.path=value`; its texts go to `overrides`.
void add_set_option(CLI::App& command, std::vector<std::string>& overrides);

/// A flag that stands for one `--set`, with a value, or without one for settings that are true or
/// false.
struct Shorthand {
    const char* flag;
    const char* key;
    const char* type;  ///< empty: a switch
    const char* help;
};

/// Declares the flags; those given go to `overrides` as `key=value`.
void add_shorthands(CLI::App& command,
                    std::span<const Shorthand> shorthands,
                    std::vector<std::string>& overrides);

/// Declares `--threads`; 0 takes all processors.
void add_threads_option(CLI::App& command, int& threads);

/// The settings as help text: key, default, meaning.
std::string settings_footer(const std::vector<core::SettingHelp>& settings,
                            const std::string& example);

/// The command line as it was typed, for provenance; set once by main().
std::string& command_line();

/// Throws core::Error when `path`, unless it is empty, ends in none of the suffixes.
void require_suffix(const std::string& path, const std::vector<std::string>& suffixes);

/// Replaces the suffix of `path`, or appends it where there is none.
std::string with_suffix(const std::string& path, const std::string& suffix);

}  // namespace apps
