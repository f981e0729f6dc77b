// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/commands.h"
#include "apps/outcome.h"
#include "apps/progress_bar.h"
#include "apps/report/report.h"
#include "apps/terminal.h"

#include <fmt/core.h>

#include <memory>

namespace apps {
namespace {

struct ReportArguments {
    std::string folder;
    std::string output;
};

}  // namespace

void add_report_command(CLI::App& app) {
    Command& command =
        add_command(app, "report", "Make one self-contained page of a folder of results");
    const auto arguments = std::make_shared<ReportArguments>();
    add_folder_option(command, "DIR", arguments->folder, "Folder of captures, volumes and metrics")
        ->required();
    add_output_option(command, arguments->output, "Page to write (.html)")->required();
    command.example = "nlos report data -o report.html";
    command.callback([arguments] {
        require_suffix(arguments->output, {".html", ".htm"});
        const ProgressBar bar("report");
        write_report(arguments->folder, arguments->output);
        note_written({arguments->output});
        print("wrote {}\n", arguments->output);
    });
}

}  // namespace apps
