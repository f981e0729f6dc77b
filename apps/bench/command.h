// SPDX-License-Identifier: MIT
#pragma once

#include "apps/arguments.h"
#include "apps/bench/output.h"

#include <memory>
#include <string>
#include <utility>

namespace apps {

/// Declares -o, --against and --results.
inline void add_output_options(CLI::App& command, BenchOutput& output) {
    add_output_folder_option(command, output.folder, "Folder for JSON, table and plots")
        ->required();
    add_file_option(command,
                    "--against",
                    output.against,
                    "Earlier run (.json): says what got slower or less accurate");
    add_file_option(command,
                    "--results",
                    output.results,
                    "Page (.md) whose section of this benchmark is written anew");
}

/// Declares an option that shows its default; with a range, a whole number within it.
template <class Value>
CLI::Option* add_setting(CLI::App& command,
                         const std::string& name,
                         Value& value,
                         const std::string& meaning) {
    return command.add_option(name, value, meaning)->capture_default_str();
}
inline void add_setting(CLI::App& command,
                        const std::string& name,
                        int& value,
                        const std::string& meaning,
                        std::pair<int, int> range) {
    const auto [low, high] = range;
    CLI::Option* option = add_setting(command, name, value, meaning)->type_name("N");
    limit(*option, {static_cast<double>(low), true, static_cast<double>(high), true});
}

/// Declares the options that all benchmarks have, and lets a command run one.
///
/// measure   runs it
/// returns   what its own options are to fill
template <class Settings>
Settings& add_benchmark(Command& command,
                        BenchResult (*measure)(const Settings&, const core::Progress&)) {
    const auto state = std::make_shared<std::pair<BenchOutput, Settings>>();
    add_output_options(command, state->first);
    command.callback([state, measure, name = command.get_name()] {
        run_benchmark(state->first, name, [&](const core::Progress& progress) {
            return measure(state->second, progress);
        });
    });
    return state->second;
}

}  // namespace apps
