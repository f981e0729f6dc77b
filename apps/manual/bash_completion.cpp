// SPDX-License-Identifier: MIT
#include "apps/manual/manual.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

namespace apps {
namespace {

// Names of commands, options, settings and choices hold nothing that a shell would take apart.
std::string joined(const std::vector<std::string>& names, const char* between) {
    return fmt::format("{}", fmt::join(names, between));
}

// What assigns how a value is completed.
std::string assignment(const OptionEntry& option) {
    switch (option.kind) {
        case ValueKind::Choice:
            return "kind=words words='" + joined(option.choices, " ") + "'";
        case ValueKind::File:
            return "kind=files words='" + joined(option.suffixes, " ") + "'";
        case ValueKind::Folder:
            return "kind=folders";
        case ValueKind::Setting:
            return "kind=settings";
        case ValueKind::None:
        case ValueKind::Text:
            break;
    }
    return "kind=none";
}

// The arguments of a command are told apart by their files alone: the suffixes of all.
std::string argument_assignment(const CommandEntry& command) {
    std::vector<std::string> suffixes;
    bool any_file = false;
    bool any = false;
    for (const OptionEntry& option : command.options) {
        if (!option.is_argument) continue;
        any = true;
        if (option.kind == ValueKind::Folder) return "kind=folders";
        any_file = any_file || option.suffixes.empty();
        suffixes.insert(suffixes.end(), option.suffixes.begin(), option.suffixes.end());
    }
    if (!any) return "kind=none";
    return "kind=files words='" + (any_file ? "" : joined(suffixes, " ")) + "'";
}

std::string command_case(const CommandEntry& command) {
    std::vector<std::string> options;
    std::string values;
    for (const OptionEntry& option : command.options) {
        if (option.is_argument) continue;
        options.insert(options.end(), option.names.begin(), option.names.end());
        if (option.kind == ValueKind::None) continue;
        values += fmt::format(
            "                {}) {} ;;\n", joined(option.names, " | "), assignment(option));
    }
    std::string text = fmt::format(
        "        '{}')\n            options='{}'\n", command.name, joined(options, " "));
    std::vector<std::string> names;
    for (const CommandEntry& inner : command.commands) {
        names.push_back(inner.name.substr(inner.name.rfind(' ') + 1));
    }
    if (!names.empty()) {
        text += "            kind=words words='" + joined(names, " ") + "'\n";
    } else {
        text += "            " + argument_assignment(command) + "\n";
    }
    if (!values.empty()) {
        text += "            case $option in\n" + values + "            esac\n";
    }
    return text + "            ;;\n";
}

std::string settings_case(const CommandEntry& command) {
    if (command.settings.empty()) return "";
    std::vector<std::string> keys;
    std::string choices;
    for (const core::SettingHelp& setting : command.settings) {
        keys.push_back(setting.key);
        const std::vector<std::string> names = setting_choices(setting);
        if (names.empty()) continue;
        choices +=
            fmt::format("                {}) words='{}' ;;\n", setting.key, joined(names, " "));
    }
    return fmt::format(
        "        '{}')\n            keys='{}'\n            case $2 in\n{}            esac\n"
        "            ;;\n",
        command.name,
        joined(keys, " "),
        choices);
}

constexpr const char* kHelpers = R"sh(
# _nlos_files CURRENT SUFFIXES: files with one of the suffixes, or all without any, and folders.
_nlos_files() {
    local name
    compopt -o filenames 2>/dev/null
    while IFS= read -r name; do COMPREPLY+=("$name"); done < <(compgen -d -- "$1")
    [[ $2 == - ]] && return
    while IFS= read -r name; do
        [[ -d $name ]] && continue
        [[ -z $2 || " $2 " == *" ${name##*.} "* ]] && COMPREPLY+=("$name")
    done < <(compgen -f -- "$1")
}

_nlos() {
    local IFS=$' \t\n' i word current option path=nlos kind=none words= options= keys=
    # bash takes words apart at '='; here they are one.
    local line=()
    for ((i = 0; i <= COMP_CWORD; ++i)); do
        word=${COMP_WORDS[i]}
        if ((i > 1)) && [[ $word == =* || ${line[${#line[@]} - 1]} == *= ]]; then
            line[${#line[@]} - 1]+=$word
        else
            line+=("$word")
        fi
    done
    local last=$((${#line[@]} - 1))
    current=${line[last]}
    option=${line[last - 1]}
    COMPREPLY=()
    for ((i = 1; i < last; ++i)); do
        case "$path ${line[i]}" in
@PATHS@) path="$path ${line[i]}" ;;
        esac
    done
    # The items after --set go on while they hold a '='.
    for ((i = last - 1; i > 0; --i)); do
        [[ ${line[i]} == *=* && ${line[i]} != -* ]] || break
    done
    [[ ${line[i]} == --set ]] && option=--set
    if [[ $current == --*=* ]]; then
        option=${current%%=*}
        current=${current#*=}
    fi
    case $path in
@COMMANDS@    esac
    if [[ $kind == settings ]]; then
        _nlos_setting "$path" "${current%%=*}"
        if [[ $current == *=* ]]; then
            local prefix=${current%%=*}=
            [[ $COMP_WORDBREAKS == *=* ]] && prefix=
            COMPREPLY=($(compgen -P "$prefix" -W "$words" -- "${current#*=}"))
        else
            compopt -o nospace 2>/dev/null
            COMPREPLY=($(compgen -S = -W "$keys" -- "$current"))
            ((${#COMPREPLY[@]} > 0)) || _nlos_files "$current" ''
        fi
    elif [[ $current == -* ]]; then
        COMPREPLY=($(compgen -W "$options" -- "$current"))
    else
        case $kind in
            words) COMPREPLY=($(compgen -W "$words" -- "$current")) ;;
            files) _nlos_files "$current" "$words" ;;
            folders) _nlos_files "$current" - ;;
        esac
    fi
}

complete -F _nlos nlos
)sh";

void replace(const std::string& mark, const std::string& text, std::string& script) {
    script.replace(script.find(mark), mark.size(), text);
}

}  // namespace

std::string bash_completion(const CommandEntry& program) {
    std::string paths;
    std::string commands;
    std::string settings;
    for (const CommandEntry* command : all_commands(program)) {
        if (command != &program)
            paths += (paths.empty() ? "" : " |\\\n") + ("            '" + command->name + "'");
        commands += command_case(*command);
        settings += settings_case(*command);
    }
    std::string script = kHelpers;
    replace("@PATHS@", paths, script);
    replace("@COMMANDS@", commands, script);
    return "# Completion of nlos for bash, written by `nlos manual`.\n"
           "\n# _nlos_setting COMMAND KEY: what --set knows of the command, and of the key.\n"
           "_nlos_setting() {\n    words=\n    case $1 in\n" +
           settings + "    esac\n}\n" + script;
}

}  // namespace apps
