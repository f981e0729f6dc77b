// SPDX-License-Identifier: MIT
#include "apps/arguments.h"

#include <fmt/core.h>

#include <filesystem>

namespace apps {

std::vector<std::string> expand_set_arguments(const std::vector<std::string>& arguments) {
    std::vector<std::string> expanded;
    bool in_set = false;
    for (const std::string& argument : arguments) {
        if (argument == "--set") {
            in_set = true;
            continue;
        }
        const bool is_item = argument.find('=') != std::string::npos && !argument.starts_with('-');
        if (in_set && is_item) {
            expanded.push_back("--set=" + argument);
            continue;
        }
        if (in_set && (expanded.empty() || !expanded.back().starts_with("--set="))) {
            expanded.push_back("--set=" + argument);  // no '=': reported with the others
            in_set = false;
            continue;
        }
        in_set = false;
        expanded.push_back(argument);
    }
    if (in_set && (expanded.empty() || !expanded.back().starts_with("--set="))) {
        expanded.emplace_back("--set=");
    }
    return expanded;
}

void add_set_option(CLI::App& command, std::vector<std::string>& overrides) {
    command.add_option("--set", overrides, "Change a setting; may be given several times")
        ->type_name("KEY.PATH=VALUE")
        ->allow_extra_args(false);
}

std::string settings_footer(const std::vector<core::SettingHelp>& settings,
                            const std::string& example) {
    std::string text;
    if (!settings.empty()) text += "Settings for --set, with defaults:\n";
    for (const core::SettingHelp& line : settings) {
        text += fmt::format("  {} = {}\n      {}\n", line.key, line.default_value, line.meaning);
    }
    return text + "\nExample:\n  " + example;
}

std::string& command_line() {
    static std::string text;
    return text;
}

std::string with_suffix(const std::string& path, const std::string& suffix) {
    return std::filesystem::path(path).replace_extension(suffix).string();
}

}  // namespace apps
