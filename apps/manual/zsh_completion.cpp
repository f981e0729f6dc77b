// SPDX-License-Identifier: MIT
#include "apps/manual/manual.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

namespace apps {
namespace {

std::string spaced(const std::vector<std::string>& names) {
    return fmt::format("{}", fmt::join(names, " "));
}

// Within single quotes.
std::string quoted(const std::string& text) {
    std::string shown = "'";
    for (const char c : text) shown += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return shown + "'";
}

// A text within a specification of _arguments or _describe.
std::string plain(const std::string& text) {
    return with_backslashes(text, "[]:\\");
}

std::string function_name(const CommandEntry& command) {
    std::string name = "_" + command.name;
    for (char& c : name) c = c == ' ' || c == '-' ? '_' : c;
    return name;
}

// One suffix stands without parentheses, which zsh would take for qualifiers.
std::string files(const std::vector<std::string>& suffixes) {
    if (suffixes.empty()) return "_files";
    if (suffixes.size() == 1) return "_files -g \"*." + suffixes.front() + "\"";
    return fmt::format("_files -g \"*.({})\"", fmt::join(suffixes, "|"));
}

// How a value is completed.
std::string action(const CommandEntry& command, const OptionEntry& option) {
    switch (option.kind) {
        case ValueKind::Choice:
            return "(" + spaced(option.choices) + ")";
        case ValueKind::File:
            return files(option.suffixes);
        case ValueKind::Folder:
            return "_files -/";
        case ValueKind::Setting:
            return function_name(command) + "_settings";
        case ValueKind::None:
        case ValueKind::Text:
            break;
    }
    return " ";
}

std::string specification(const CommandEntry& command, const OptionEntry& option) {
    const std::string value = option.kind == ValueKind::None
                                  ? ""
                                  : ":" + plain(option.value) + ":" + action(command, option);
    if (option.is_argument) {
        return quoted((option.may_repeat ? "*:" : ":") + plain(option.names.front()) + ":" +
                      action(command, option));
    }
    const std::string meaning = "[" + plain(option.meaning) + "]";
    const bool may_repeat = option.may_repeat || option.kind == ValueKind::Setting;
    if (option.names.size() == 1) {
        return quoted((may_repeat ? "*" : "") + option.names.front() + meaning + value);
    }
    return fmt::format("'({})'{{{}}}{}",
                       spaced(option.names),
                       fmt::join(option.names, ","),
                       quoted(meaning + value));
}

std::string settings_function(const CommandEntry& command) {
    if (command.settings.empty()) return "";
    std::string keys;
    std::string choices;
    for (const core::SettingHelp& setting : command.settings) {
        keys += " " + setting.key;
        const std::vector<std::string> names = setting_choices(setting);
        if (names.empty()) continue;
        choices += fmt::format("      {}) compadd -- {} ;;\n", setting.key, spaced(names));
    }
    return fmt::format(
        "{}_settings() {{\n  if compset -P 1 '*='; then\n    case ${{IPREFIX%=}} in\n{}    esac\n"
        "  else\n    compadd -S = --{}\n  fi\n}}\n\n",
        function_name(command),
        choices,
        keys);
}

std::string options_of(const CommandEntry& command) {
    std::string text;
    for (const OptionEntry& option : command.options) {
        text += " \\\n    " + specification(command, option);
    }
    return text;
}

// A command with commands below it.
std::string group_function(const CommandEntry& command) {
    std::string names;
    std::string cases;
    for (const CommandEntry& inner : command.commands) {
        const std::string name = inner.name.substr(inner.name.rfind(' ') + 1);
        names += "        " + quoted(plain(name) + ":" + inner.description) + "\n";
        cases += fmt::format("        {}) {} ;;\n", name, function_name(inner));
    }
    return fmt::format(
        "{0}() {{\n  local state line\n  local -a commands\n  _arguments -C{1} \\\n"
        "    ':command:->command' \\\n    '*::argument:->argument'\n  case $state in\n"
        "    command)\n      commands=(\n{2}      )\n      _describe command commands\n      ;;\n"
        "    argument)\n      case $line[1] in\n{3}      esac\n      ;;\n  esac\n}}\n\n",
        function_name(command),
        options_of(command),
        names,
        cases);
}

std::string command_function(const CommandEntry& command) {
    if (!command.commands.empty()) return group_function(command);
    return fmt::format(
        "{}() {{\n  _arguments{}\n}}\n\n", function_name(command), options_of(command));
}

}  // namespace

std::string zsh_completion(const CommandEntry& program) {
    std::string script =
        "#compdef nlos\n# Completion of nlos for zsh, written by `nlos manual`.\n\n";
    for (const CommandEntry* command : all_commands(program)) {
        script += settings_function(*command) + command_function(*command);
    }
    return script + "_nlos \"$@\"\n";
}

}  // namespace apps
