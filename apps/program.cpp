// SPDX-License-Identifier: MIT
#include "apps/program.h"

#include "apps/arguments.h"
#include "apps/commands.h"
#include "apps/outcome.h"
#include "apps/run_program.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "renderer/core/error.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

namespace apps {
namespace {

constexpr int kFailed = 1;
constexpr int kBadInput = 2;

// The arguments as they were typed, and the command that they were found to name.
struct CommandLine {
    std::vector<std::string> arguments;
    std::string command;
};

// Has another program run the command, where one does.
void hand_over(const CommandLine& line) {
    const auto word = std::ranges::find_if(
        line.arguments, [](const std::string& argument) { return !argument.starts_with('-'); });
    if (word == line.arguments.end()) return;
    for (const CommandRow* row : all_commands()) {
        if (row->name != *word || row->declare != nullptr) continue;
        std::vector<std::string> words{"nlos"};
        words.insert(words.end(), line.arguments.begin(), line.arguments.end());
        become("nlos-bench", std::move(words));
    }
}

// `help COMMAND` as `COMMAND --help`.
void take_help_as_option(std::vector<std::string>& arguments) {
    const auto word = std::ranges::find_if(
        arguments, [](const std::string& argument) { return !argument.starts_with('-'); });
    if (word == arguments.end() || *word != "help") return;
    const auto asks_for_help = [](const std::string& argument) {
        return argument == "--help" || argument == "-h";
    };
    if (std::ranges::any_of(arguments, asks_for_help)) return;  // of this command itself
    arguments.erase(word);
    arguments.emplace_back("--help");
}

// Runs the command; its callback is called within parse().
void run(CommandLine& line, const std::map<std::string, void (*)(Command&)>& beside) {
    Command app("nlos",
                "Non-line-of-sight imaging: simulate, reconstruct, fit, compare",
                "nlos demo -o out/demo");
    app.set_version_flag("--version", version_text());
    app.require_subcommand(1);
    for (const CommandRow* row : all_commands()) {
        Command& command = add_command(app, *row);
        if (const auto it = beside.find(row->name); it != beside.end()) it->second(command);
    }
    reject_unknown_command(app, line.arguments);

    std::vector<std::string> reversed = expand_set_arguments(line.arguments);
    std::reverse(reversed.begin(), reversed.end());
    const auto note_command = [&] { line.command = typed_name(parsed_command(app)); };
    app.parse_complete_callback(note_command);
    try {
        app.parse(reversed);
    } catch (const CLI::ParseError& error) {
        note_command();
        if (error.get_exit_code() != 0) throw_usage_error(app, error);
        app.exit(error);  // --help, --version
    }
}

// Says what failed. Whatever a message holds, it ends up as exactly one line.
int fail(const CommandLine& line, int status, const std::string& message) {
    print_error("{}\n", message);
    print_outcome(line.command, status, message);
    return status;
}

// Names that the system refuses before anything is read: too long, in circles, not permitted.
std::string refused_path(const std::filesystem::filesystem_error& error) {
    return core::Error(error.path1().string(),
                       "cannot be reached (" + error.code().message() + ")",
                       "must be a file or folder that can be")
        .what();
}

}  // namespace

int run_nlos(int argc, char** argv, const std::map<std::string, void (*)(Command&)>& beside) {
    CommandLine line{{argv + 1, argv + argc}, "nlos"};
    command_line() = "nlos";
    for (const std::string& argument : line.arguments) {
        command_line() += " " + core::printable(argument);
        // Known now, for arguments that cannot be parsed.
        if (argument == "--json") output_settings().json = true;
    }
    try {
        take_help_as_option(line.arguments);
        if (beside.empty()) hand_over(line);
        handle_signals();
        run(line, beside);
        print_outcome(line.command, 0, "");
        flush_output();
        return 0;
    } catch (const core::Error& error) {
        return fail(line, kBadInput, error.what());
    } catch (const core::Failure& error) {
        return fail(line, kFailed, error.what());
    } catch (const std::filesystem::filesystem_error& error) {
        return fail(line, kBadInput, refused_path(error));
    } catch (const std::bad_alloc&) {
        return fail(line, kFailed, "nlos: not enough memory");
    } catch (const std::exception& error) {
        return fail(line, kFailed, std::string("nlos: ") + error.what());
    }
}

}  // namespace apps
