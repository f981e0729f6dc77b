// SPDX-License-Identifier: MIT
#include "apps/arguments.h"

#include "renderer/core/file_suffix.h"
#include "renderer/core/settings/json_file.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

namespace apps {

std::vector<std::string> expand_set_arguments(const std::vector<std::string>& arguments) {
    const auto is_item = [](const std::string& argument) {
        return argument.find('=') != std::string::npos && !argument.starts_with('-');
    };
    std::vector<std::string> expanded;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        if (arguments[i] != "--set") {
            expanded.push_back(arguments[i]);
            continue;
        }
        // The first item is taken as it is; without '=' it is reported as malformed later.
        const bool has_first = i + 1 < arguments.size() && !arguments[i + 1].starts_with('-');
        expanded.push_back("--set=" + (has_first ? arguments[++i] : std::string()));
        while (has_first && i + 1 < arguments.size() && is_item(arguments[i + 1])) {
            expanded.push_back("--set=" + arguments[++i]);
        }
    }
    return expanded;
}

namespace {

std::string check_name(const std::string& name) {
    return name.empty() ? "found no name; must be one" : "";
}

// Has help state the choices and the default that a setting has.
void describe_value(const core::SettingHelp& setting, CLI::Option& option) {
    if (!setting.choices.empty()) {
        option.type_name(fmt::format("{{{}}}", fmt::join(setting.choices, ",")));
    }
    const core::Json value = core::Json::parse(setting.default_value);
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (!value.is_null() && !text.empty()) option.default_str(text);
}

}  // namespace

CLI::Option* add_output_option(CLI::App& command, std::string& path, const std::string& meaning) {
    return add_file_option(command, "-o,--output", path, meaning)->check(check_name);
}

CLI::Option* add_output_folder_option(CLI::App& command,
                                      std::string& path,
                                      const std::string& meaning) {
    return add_folder_option(command, "-o,--output", path, meaning)->check(check_name);
}

CLI::Option* add_picture_option(CLI::App& command, std::string& path) {
    return add_file_option(
        command, "--picture", path, "Also write the picture for print (.svg, .pdf, .png)");
}

void add_set_option(CLI::App& command, std::vector<std::string>& overrides) {
    command
        .add_option_function<std::vector<std::string>>(
            "--set",
            [&overrides](const std::vector<std::string>& texts) {
                overrides.insert(overrides.begin(), texts.begin(), texts.end());
            },
            "Change a setting; may be given several times")
        ->type_name("KEY.PATH=VALUE")
        ->allow_extra_args(false);
}

void add_shorthands(Command& command,
                    std::span<const Shorthand> shorthands,
                    std::vector<std::string>& overrides) {
    for (const Shorthand& shorthand : shorthands) {
        const std::string prefix = std::string(shorthand.key) + "=";
        if (*shorthand.type == '\0') {
            command.add_flag_callback(
                shorthand.flag,
                [&overrides, prefix] { overrides.push_back(prefix + "true"); },
                shorthand.help);
            continue;
        }
        CLI::Option* option = command.add_option_function<std::string>(
            shorthand.flag,
            [&overrides, prefix](const std::string& value) { overrides.push_back(prefix + value); },
            shorthand.help);
        option->type_name(shorthand.type);
        const auto setting =
            std::ranges::find(command.settings, shorthand.key, &core::SettingHelp::key);
        if (setting != command.settings.end()) describe_value(*setting, *option);
    }
}

void add_threads_option(CLI::App& command, int& threads) {
    constexpr double kMost = 1024;
    CLI::Option* option =
        command.add_option("--threads", threads, "Threads; 0 takes all processors");
    limit(*option->capture_default_str()->type_name("N"), {0, true, kMost, true});
}

std::string& command_line() {
    static std::string text;
    return text;
}

void require_suffix(const std::string& path, const std::vector<std::string>& suffixes) {
    const std::string found = core::file_suffix(path);
    if (path.empty() || std::find(suffixes.begin(), suffixes.end(), found) != suffixes.end())
        return;
    throw core::Error(path,
                      "has the suffix '" + found + "'",
                      fmt::format("must be one of {}", fmt::join(suffixes, ", ")));
}

std::string with_suffix(const std::string& path, const std::string& suffix) {
    return std::filesystem::path(path).replace_extension(suffix).string();
}

}  // namespace apps
