// SPDX-License-Identifier: MIT
#include "apps/manual/manual.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace apps {
namespace {

// A text within a cell of a table.
std::string cell(const std::string& text) {
    std::string shown = with_backslashes(text, "|*_<>[]`\\");
    std::ranges::replace(shown, '\n', ' ');
    return shown;
}

std::string code(const std::string& text) {
    return text.empty() ? "" : "`" + with_backslashes(text, "|") + "`";
}

std::string option_row(const OptionEntry& option) {
    std::string names;
    for (const std::string& name : option.names) {
        names +=
            (names.empty() ? "" : ", ") +
            code(name + (option.is_argument || option.value.empty() ? "" : " " + option.value));
    }
    const std::string limits = cell(fmt::format("{}", fmt::join(option.choices, ", ")));
    return fmt::format("| {}{} | {} | {} | {} |\n",
                       names,
                       option.is_required ? " (required)" : "",
                       code(option.default_value),
                       limits,
                       cell(option.meaning));
}

std::string setting_row(const core::SettingHelp& setting) {
    const std::vector<std::string> choices = setting_choices(setting);
    return fmt::format(
        "| {} | {} | {} | {} |\n",
        code(setting.key),
        code(setting.default_value),
        choices.empty() ? cell(setting.range) : cell(fmt::format("{}", fmt::join(choices, ", "))),
        cell(setting.meaning));
}

std::string section(const CommandEntry& command) {
    std::string text = fmt::format(
        "\n## {}\n\n{}.\n\n    {}\n\n| option | default | allowed | meaning |\n|---|---|---|---|\n",
        command.name,
        command.description,
        command.example);
    for (const OptionEntry& option : command.options) text += option_row(option);
    if (command.settings.empty()) return text;
    text += "\n| setting | default | allowed | meaning |\n|---|---|---|---|\n";
    for (const core::SettingHelp& setting : command.settings) text += setting_row(setting);
    return text;
}

}  // namespace

std::string reference_page(const CommandEntry& program, const std::string& version) {
    std::string page = fmt::format(
        "# Commands and settings\n\nEvery command, option and setting of {}, written by `nlos "
        "manual`. Settings are changed by `--set KEY=VALUE` or stand, nested at the dots, in the "
        "JSON file that the command reads. Units stand in the names: `_m` metres, of path lengths "
        "too, `_s` seconds, `_ps` picoseconds, `_deg` degrees.\n\n",
        version);
    for (const CommandEntry* command : all_commands(program)) {
        page += fmt::format(
            "* [{}](#{}): {}\n", command->name, page_name(*command), command->description);
    }
    for (const CommandEntry* command : all_commands(program)) page += section(*command);
    return page;
}

}  // namespace apps
