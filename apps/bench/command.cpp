// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"

namespace apps {

void add_output_options(CLI::App& command, BenchOutput& output) {
    add_output_option(command, output.folder, "Folder for JSON, table and plots")->required();
    command.add_option("--against",
                       output.against,
                       "JSON of an earlier run: says what got slower or less accurate");
    command.add_option("--results",
                       output.results,
                       "Markdown file whose section of this benchmark is written anew");
}

}  // namespace apps
