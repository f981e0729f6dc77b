// SPDX-License-Identifier: MIT
#pragma once

#include "apps/command.h"

#include <string>
#include <string_view>
#include <vector>

namespace apps {

/// What stands after an option or in the place of an argument.
enum class ValueKind {
    None,     ///< nothing: a switch
    Text,     ///< a number or a name
    Choice,   ///< one of a closed set
    File,     ///< a file
    Folder,   ///< a folder
    Setting,  ///< KEY.PATH=VALUE
};

/// An option, or an argument without a name before it.
struct OptionEntry {
    std::vector<std::string> names;  ///< "-o", "--output"; of an argument the one that help shows
    bool is_argument = false;
    bool is_required = false;
    bool may_repeat = false;
    ValueKind kind = ValueKind::None;
    std::string value;  ///< as help names it, such as FILE; empty of a switch
    std::string meaning;
    std::string default_value;            ///< empty: none
    std::vector<std::string> choices;     ///< of a closed set
    std::vector<std::string> suffixes{};  ///< of files, without the dot; empty: any
};

/// A command: what --help says of it, as data. From this the manual pages, the completion of
/// shells and the reference are written.
struct CommandEntry {
    std::string name;  ///< as it is typed, "nlos bench render"
    std::string description;
    std::vector<OptionEntry> options;  ///< arguments first
    std::vector<core::SettingHelp> settings;
    std::string example;
    std::vector<CommandEntry> commands;
};

CommandEntry describe_command(const CLI::App& command);

/// A command and all below it, each before its own.
std::vector<const CommandEntry*> all_commands(const CommandEntry& command);

/// The choices of a setting: those of its closed set, or true and false; empty: anything.
std::vector<std::string> setting_choices(const core::SettingHelp& setting);

/// A text with a backslash before each of these characters.
std::string with_backslashes(const std::string& text, std::string_view characters);

/// The manual page of a command, in man(7).
///
/// version   as "nlos 0.1.0"
std::string man_page(const CommandEntry& command, const std::string& version);

/// The name of a command's page without the section, "nlos-bench-render".
std::string page_name(const CommandEntry& command);

/// Completion of the program and all its commands for bash and zsh: commands, options, files by
/// suffix, names of closed sets, keys and values of settings. Nothing of it starts the program.
std::string bash_completion(const CommandEntry& program);
std::string zsh_completion(const CommandEntry& program);

/// All commands, options and settings with defaults, ranges and meanings, in Markdown.
std::string reference_page(const CommandEntry& program, const std::string& version);

}  // namespace apps
