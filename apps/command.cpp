// SPDX-License-Identifier: MIT
#include "apps/command.h"

#include "apps/terminal.h"
#include "renderer/core/nearest_name.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>

namespace apps {
namespace {

std::vector<std::string> names_of_options(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
    return names;
}

// Help that ends with the settings and the example.
class HelpFormatter : public CLI::Formatter {
 public:
    std::string make_footer(const CLI::App* app) const override {
        const auto* command = dynamic_cast<const Command*>(app);
        if (command == nullptr) return "";
        std::string text;
        if (!command->settings.empty()) text += "Settings for --set, with defaults:\n";
        for (const core::SettingHelp& line : command->settings) {
            text += fmt::format("  {} = {}\n      {}\n", line.key, line.default_value, line.text());
        }
        return text + "\nExample:\n  " + command->example + "\n";
    }
};

}  // namespace

Command::Command(const std::string& name,
                 const std::string& summary,
                 const std::string& example_line)
    : CLI::App(summary, name), example(example_line) {
    // Last in help, behind what the command adds.
    add_flag("--quiet", output_settings().quiet, "Print no more than warnings and errors")
        ->group(kGroupOfAll);
    add_flag("--json",
             output_settings().json,
             "End with a line of JSON: what was written, and the numbers of the text")
        ->group(kGroupOfAll);
    formatter(std::make_shared<HelpFormatter>());
}

Command& add_command(CLI::App& parent, const CommandRow& row) {
    const auto command = std::make_shared<Command>(row.name, row.summary, row.example);
    parent.add_subcommand(command);
    if (row.declare != nullptr) row.declare(*command);
    return *command;
}

std::string typed_name(const CLI::App& command) {
    const CLI::App* parent = command.get_parent();
    return (parent == nullptr ? "" : typed_name(*parent) + " ") + command.get_name();
}

const CLI::App& parsed_command(const CLI::App& app) {
    const auto parsed = app.get_subcommands();
    return parsed.empty() ? app : parsed_command(*parsed.back());
}

void reject_unknown_command(const CLI::App& app, std::span<const std::string> arguments) {
    const auto commands = app.get_subcommands({});
    while (!arguments.empty() && arguments.front().starts_with('-')) {
        arguments = arguments.subspan(1);
    }
    if (commands.empty() || arguments.empty()) return;
    std::vector<std::string> known;
    for (const CLI::App* command : commands) {
        if (command->get_name() == arguments.front()) {
            return reject_unknown_command(*command, arguments.subspan(1));
        }
        known.push_back(command->get_name());
    }
    throw core::Error(typed_name(app),
                      "found unknown command '" + arguments.front() + "'",
                      core::did_you_mean(arguments.front(), known) +
                          fmt::format("known are {}", fmt::join(known, ", ")));
}

void throw_usage_error(const CLI::App& app, const CLI::ParseError& error) {
    const CLI::App& command = parsed_command(app);
    const std::string name = typed_name(command);
    for (const std::string& argument : command.remaining()) {
        if (!argument.starts_with('-') || argument == "-") continue;
        const std::string option = argument.substr(0, argument.find('='));
        const std::vector<std::string> known = names_of_options(command);
        throw core::Error(name,
                          "found unknown option '" + option + "'",
                          core::did_you_mean(option, known) +
                              fmt::format("known are {}", fmt::join(known, ", ")));
    }
    const std::vector<std::string> left = command.remaining();
    if (left.empty()) throw core::Error(name, error.what(), "see " + name + " --help");
    throw core::Error(name,
                      "found '" + left.front() + "', an argument too many",
                      left.front().find('=') == std::string::npos
                          ? "see " + name + " --help"
                          : "settings follow --set, up to the next option");
}

CLI::Validator one_of(const std::vector<std::string>& names) {
    return CLI::Validator(
        [names](std::string& found) {
            if (std::ranges::find(names, found) != names.end()) return std::string();
            return "found '" + found + "'; " + core::did_you_mean(found, names) + "must be " +
                   core::choices_text(names);
        },
        "{" + fmt::format("{}", fmt::join(names, ",")) + "}");
}

void limit(CLI::Option& option, const core::Range& range) {
    const std::string allowed = core::range_text(range);
    option.description(option.get_description() + " (" + allowed + ")");
    option.check([range, allowed](const std::string& text) {
        try {
            core::check_range(std::stod(text), range, "");
        } catch (const std::exception&) {
            return "found " + text + "; must be " + allowed;
        }
        return std::string();
    });
}

}  // namespace apps
