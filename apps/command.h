// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/settings_help.h"

#include <CLI/CLI.hpp>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace apps {

/// Where --help lists the options that all commands have.
inline constexpr const char* kGroupOfAll = "Options of every command";

/// A command of the program: its arguments, and what --help, the manual and the completion of
/// shells say beside them.
class Command : public CLI::App {
 public:
    Command(const std::string& name, const std::string& summary, const std::string& example);

    /// Makes arguments for options to fill, and lets the command run on them.
    template <class Arguments>
    Arguments& runs(void (*run)(const Arguments&)) {
        const auto arguments = std::make_shared<Arguments>();
        callback([arguments, run] { run(*arguments); });
        return *arguments;
    }

    std::vector<core::SettingHelp> settings;  ///< what --set reaches
    std::string example;                      ///< a command line that works in the checkout
};

/// A command as its file describes it.
struct CommandRow {
    const char* name;
    const char* summary;          ///< what help says of it
    const char* example;          ///< a command line that works in the checkout
    void (*declare)(Command&){};  ///< adds its options, and what runs; null: `nlos-bench` knows
};

/// Adds a command to the program or to another command, with the options that all have.
Command& add_command(CLI::App& parent, const CommandRow& row);

/// The name of a command as it is typed, as in "nlos bench render".
std::string typed_name(const CLI::App& command);

/// The deepest command that has been parsed: this one or one below it.
const CLI::App& parsed_command(const CLI::App& app);

/// Throws core::Error, with the nearest name, where a command must stand and an unknown one does;
/// CLI11 would only say that one is missing.
void reject_unknown_command(const CLI::App& app, std::span<const std::string> arguments);

/// Throws core::Error for arguments that could not be parsed: an unknown option, with the nearest
/// one, or else what CLI11 says.
[[noreturn]] void throw_usage_error(const CLI::App& app, const CLI::ParseError& error);

/// A check that a text is one of these names.
CLI::Validator one_of(const std::vector<std::string>& names);

/// Lets an option take numbers of a range alone, and says so in its help.
void limit(CLI::Option& option, const core::Range& range);

}  // namespace apps
