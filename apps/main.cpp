// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/commands.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "renderer/core/error.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <new>
#include <span>

namespace {

constexpr int kFailed = 1;
constexpr int kBadInput = 2;

// Whatever a message holds, it ends up as exactly one line.
int fail(int status, const std::string& message) {
    apps::print_error("{}\n", message);
    return status;
}

// Names that the system refuses before anything is read: too long, in circles, not permitted.
int refuse_path(const std::filesystem::filesystem_error& error) {
    const std::string reason = error.code().message();
    return fail(kBadInput,
                core::Error(error.path1().string(),
                            "cannot be reached (" + reason + ")",
                            "must be a file or folder that can be")
                    .what());
}

// CLI11 would only say that a command is missing.
void reject_unknown_command(const CLI::App& app, std::span<const std::string> arguments) {
    const auto commands = app.get_subcommands({});
    if (commands.empty() || arguments.empty() || arguments.front().starts_with('-')) return;
    std::string known;
    for (const CLI::App* command : commands) {
        if (command->get_name() == arguments.front()) {
            return reject_unknown_command(*command, arguments.subspan(1));
        }
        known += (known.empty() ? "" : ", ") + command->get_name();
    }
    throw core::Error(app.get_parent() ? "nlos " + app.get_name() : app.get_name(),
                      "found unknown command '" + arguments.front() + "'",
                      "known are " + known);
}

int run(const std::vector<std::string>& arguments) {
    CLI::App app("Non-line-of-sight imaging: simulate, reconstruct, fit, compare.", "nlos");
    app.set_version_flag("--version", apps::version_text());
    app.require_subcommand(1);
    app.footer("Example:\n  nlos demo -o out/demo");
    apps::add_render_command(app);
    apps::add_convert_command(app);
    apps::add_simulate_noise_command(app);
    apps::add_reconstruct_command(app);
    apps::add_fit_command(app);
    apps::add_calibrate_command(app);
    apps::add_compare_command(app);
    apps::add_info_command(app);
    apps::add_report_command(app);
    apps::add_bench_command(app);
    apps::add_generate_command(app);
    apps::add_sweep_command(app);
    apps::add_track_command(app);
    apps::add_demo_command(app);

    reject_unknown_command(app, arguments);

    std::vector<std::string> reversed = apps::expand_set_arguments(arguments);
    std::reverse(reversed.begin(), reversed.end());
    try {
        app.parse(reversed);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        return fail(kBadInput, std::string("nlos: ") + error.what() + "; see nlos --help");
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    apps::command_line() = "nlos";
    for (const std::string& argument : arguments) {
        apps::command_line() += " " + core::printable(argument);
    }
    apps::handle_signals();
    try {
        const int status = run(arguments);
        apps::flush_output();
        return status;
    } catch (const core::Error& error) {
        return fail(kBadInput, error.what());
    } catch (const core::Failure& error) {
        return fail(kFailed, error.what());
    } catch (const std::filesystem::filesystem_error& error) {
        return refuse_path(error);
    } catch (const std::bad_alloc&) {
        return fail(kFailed, "nlos: not enough memory");
    } catch (const std::exception& error) {
        return fail(kFailed, std::string("nlos: ") + error.what());
    }
}
