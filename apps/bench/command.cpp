// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"

namespace apps {

void add_output_options(CLI::App& command, BenchOutput& output) {
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

}  // namespace apps
