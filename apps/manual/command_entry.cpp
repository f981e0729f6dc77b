// SPDX-License-Identifier: MIT
#include "apps/manual/manual.h"

#include <algorithm>
#include <regex>
#include <sstream>

namespace apps {
namespace {

// The names in "{a,b}", as help shows closed sets.
std::vector<std::string> choices_in(const std::string& type) {
    const std::size_t open = type.find('{');
    const std::size_t close = type.find('}');
    if (open == std::string::npos || close == std::string::npos) return {};
    std::vector<std::string> names;
    std::istringstream list(type.substr(open + 1, close - open - 1));
    for (std::string name; std::getline(list, name, ',');) names.push_back(name);
    return names;
}

// The suffixes in the first parentheses that hold any, as in "Capture to write (.h5, .npz)".
std::vector<std::string> suffixes_in(const std::string& meaning) {
    static const std::regex list(R"(\((\.\w+(?:, \.\w+)*)\))");
    static const std::regex suffix(R"(\.(\w+))");
    std::vector<std::string> suffixes;
    std::smatch found;
    if (!std::regex_search(meaning, found, list)) return suffixes;
    const std::string inner = found.str(1);
    for (std::sregex_iterator i(inner.begin(), inner.end(), suffix), end; i != end; ++i) {
        suffixes.push_back(i->str(1));
    }
    return suffixes;
}

ValueKind kind_of(const OptionEntry& entry) {
    if (!entry.choices.empty()) return ValueKind::Choice;
    if (entry.value == "FILE") return ValueKind::File;
    if (entry.value == "DIR") return ValueKind::Folder;
    if (entry.value == "KEY.PATH=VALUE") return ValueKind::Setting;
    return ValueKind::Text;
}

// What a value is called: not as of which type CLI11 keeps it.
std::string value_name(const std::string& type, const std::vector<std::string>& choices) {
    std::string name = type.substr(0, type.find_first_of(":{"));
    if (name == "TEXT" || name == "INT" || name == "UINT" || name == "FLOAT" || name.empty()) {
        name = name == "TEXT" || !choices.empty() ? "NAME" : "N";
    }
    return name;
}

OptionEntry describe_option(const CLI::Option& option) {
    OptionEntry entry;
    entry.is_argument = option.get_positional();
    entry.meaning = option.get_description();
    entry.is_required = option.get_required();
    if (entry.is_argument) entry.names.push_back(option.get_name(true));
    for (const std::string& name : option.get_snames()) entry.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
    if (option.get_expected_max() == 0) return entry;
    const std::string type = option.get_type_name();
    entry.may_repeat = option.get_expected_max() == CLI::detail::expected_max_vector_size ||
                       option.get_expected_max() > 2;
    entry.choices = choices_in(type);
    entry.value = value_name(type, entry.choices);
    entry.kind = kind_of(entry);
    entry.default_value = option.get_default_str();
    if (entry.kind == ValueKind::File) entry.suffixes = suffixes_in(entry.meaning);
    return entry;
}

}  // namespace

CommandEntry describe_command(const CLI::App& command) {
    CommandEntry entry;
    entry.name = typed_name(command);
    entry.description = command.get_description();
    std::vector<const CLI::Option*> options = command.get_options();
    std::ranges::stable_partition(
        options, [](const auto* option) { return option->get_group() != kGroupOfAll; });
    std::ranges::stable_partition(options, &CLI::Option::get_positional);
    for (const CLI::Option* option : options) entry.options.push_back(describe_option(*option));
    if (const auto* ours = dynamic_cast<const Command*>(&command)) {
        entry.settings = ours->settings;
        entry.example = ours->example;
    }
    for (const CLI::App* inner : command.get_subcommands({})) {
        entry.commands.push_back(describe_command(*inner));
    }
    return entry;
}

std::vector<const CommandEntry*> all_commands(const CommandEntry& command) {
    std::vector<const CommandEntry*> list{&command};
    for (const CommandEntry& inner : command.commands) {
        const auto below = all_commands(inner);
        list.insert(list.end(), below.begin(), below.end());
    }
    return list;
}

std::vector<std::string> setting_choices(const core::SettingHelp& setting) {
    const bool is_switch = setting.default_value == "true" || setting.default_value == "false";
    return is_switch ? std::vector<std::string>{"true", "false"} : setting.choices;
}

std::string with_backslashes(const std::string& text, std::string_view characters) {
    std::string shown;
    for (const char c : text) {
        if (characters.find(c) != std::string_view::npos) shown += '\\';
        shown += c;
    }
    return shown;
}

}  // namespace apps
