// SPDX-License-Identifier: MIT
#include "apps/manual/manual.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace apps {
namespace {

// Long lists of names may be broken after a comma or a bar.
constexpr std::array<std::pair<char, std::string_view>, 8> kEscapes{{{'\\', "\\e"},
                                                                     {'-', "\\-"},
                                                                     {'\'', "\\(aq"},
                                                                     {'`', "\\(ga"},
                                                                     {'^', "\\(ha"},
                                                                     {'~', "\\(ti"},
                                                                     {',', ",\\:"},
                                                                     {'|', "|\\:"}}};

// A text as roff shows it unchanged: hyphens can be copied as the minus that options begin with,
// and no line is taken for a request.
std::string roff(const std::string& text) {
    std::string shown;
    for (const char c : text) {
        const auto escape =
            std::ranges::find(kEscapes, c, &std::pair<char, std::string_view>::first);
        shown += escape == kEscapes.end() ? std::string_view(&c, 1) : escape->second;
    }
    return text.starts_with('.') ? "\\&" + shown : shown;
}

std::string bold(const std::string& text) {
    return "\\fB" + roff(text) + "\\fR";
}

std::string italic(const std::string& text) {
    return "\\fI" + roff(text) + "\\fR";
}

std::string lower_first(std::string text) {
    if (text.size() > 1 && std::islower(static_cast<unsigned char>(text[1])) != 0) {
        text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
    }
    return text;
}

std::string value_text(const OptionEntry& option) {
    return option.value.empty() ? "" : italic(option.value);
}

std::string synopsis(const CommandEntry& command) {
    std::string text = bold(command.name);
    if (!command.commands.empty()) text += " " + italic("COMMAND");
    for (const OptionEntry& option : command.options) {
        const std::string several = option.may_repeat ? " ..." : "";
        if (option.is_argument) {
            const std::string name = italic(option.names.front());
            text += " " + (option.is_required ? name : "[" + name + "]") + several;
        } else if (option.is_required) {
            text += " " + bold(option.names.front()) + " " + value_text(option);
        }
    }
    return text + " [" + italic("OPTION") + "] ...";
}

std::string details(const OptionEntry& option) {
    std::string text = roff(option.meaning);
    if (!option.choices.empty()) {
        text +=
            fmt::format("; one of {}", roff(fmt::format("{}", fmt::join(option.choices, ", "))));
    }
    if (!option.default_value.empty()) text += "; default " + roff(option.default_value);
    return text;
}

void add_options(const CommandEntry& command, bool arguments, std::string& page) {
    for (const OptionEntry& option : command.options) {
        if (option.is_argument != arguments) continue;
        std::string names;
        for (const std::string& name : option.names) {
            names += (names.empty() ? "" : ", ") + (arguments ? italic(name) : bold(name));
        }
        if (!arguments && !option.value.empty()) names += " " + value_text(option);
        page += ".TP\n" + names + "\n" + details(option) + "\n";
    }
}

void add_settings(const CommandEntry& command, std::string& page) {
    if (command.settings.empty()) return;
    page += ".SH SETTINGS\nKeys for " + bold("--set") + " with their defaults.\n";
    for (const core::SettingHelp& setting : command.settings) {
        page += fmt::format(".TP\n{} = {}\n{}\n",
                            bold(setting.key),
                            roff(setting.default_value),
                            roff(setting.text()));
    }
}

void add_commands(const CommandEntry& command, std::string& page) {
    if (command.commands.empty()) return;
    page += ".SH COMMANDS\n";
    for (const CommandEntry& inner : command.commands) {
        page += fmt::format(".TP\n{}(1)\n{}\n", bold(page_name(inner)), roff(inner.description));
    }
}

constexpr const char* kExitStatus = R"(.SH EXIT STATUS
.TP
0
success
.TP
1
a failure that other arguments would not mend, such as a full disk, or an interruption
.TP
2
wrong usage or wrong input; one line says where, what was found and what is allowed
)";

constexpr const char* kEnvironment = R"(.SH ENVIRONMENT
.TP
.B NLOS_DATA
folder of the scenes and captures that come with the program, with scenes/ and data/ in it
.TP
.B NO_COLOR
when set, progress is shown in plain lines instead of a bar that is drawn again and again
)";

}  // namespace

std::string page_name(const CommandEntry& command) {
    std::string name = command.name;
    std::ranges::replace(name, ' ', '-');
    return name;
}

std::string man_page(const CommandEntry& command, const std::string& version) {
    const std::string name = page_name(command);
    std::string title = name;
    for (char& c : title) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    // Neither adjusted nor hyphenated: names stay whole.
    std::string page = fmt::format(
        ".TH {} 1 \"\" \"{}\" \"Non\\-line\\-of\\-sight imaging\"\n.ad l\n.nh\n"
        ".SH NAME\n{} \\- {}\n.SH SYNOPSIS\n{}\n.SH DESCRIPTION\n{}.\n",
        roff(title),
        roff(version),
        roff(name),
        roff(lower_first(command.description)),
        synopsis(command),
        roff(command.description));
    add_commands(command, page);
    if (std::ranges::any_of(command.options, &OptionEntry::is_argument)) page += ".SH ARGUMENTS\n";
    add_options(command, true, page);
    page += ".SH OPTIONS\n";
    add_options(command, false, page);
    add_settings(command, page);
    page += kExitStatus;
    page += kEnvironment;
    page += fmt::format(".SH EXAMPLE\n.nf\n{}\n.fi\n", roff(command.example));
    if (command.name != "nlos") page += ".SH SEE ALSO\n" + bold("nlos") + "(1)\n";
    return page;
}

}  // namespace apps
