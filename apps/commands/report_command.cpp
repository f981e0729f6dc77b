// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/capture_options.h"
#include "apps/outcome.h"
#include "apps/progress_bar.h"
#include "apps/report/report.h"
#include "apps/terminal.h"
#include "renderer/core/error.h"

#include <spawn.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>

namespace apps {
namespace {

struct ReportArguments {
    std::string folder;
    std::string output;
    ReportOptions options;
};

struct ViewArguments {
    std::vector<std::string> files;
    std::string output;
    bool keep_closed = false;
    std::vector<std::string> overrides;
    ReportOptions options;
};

void add_size_option(Command& command, ReportOptions& options) {
    CLI::Option& size = *command.add_option("--data-mb",
                                            options.data_mb,
                                            "Most that the page takes beside its scripts [MB]; "
                                            "what does not fit is shown smaller, or named");
    limit(*size.capture_default_str(), {0.1, true, 1e4, true});
}

/// A page in a new folder for temporary files, which nobody else writes to.
std::string temporary_page() {
    std::string folder = (std::filesystem::temp_directory_path() / "nlos-view-XXXXXX").string();
    if (::mkdtemp(folder.data()) == nullptr) {
        throw core::Failure("view", "no folder for temporary files can be made; name a page by -o");
    }
    return folder + "/view.html";
}

/// Opens a page in the browser, where there is a screen and a program that knows one.
bool open_in_browser(const std::string& path) {
    if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) {
        return false;
    }
    std::array<std::string, 2> texts{"xdg-open", std::filesystem::absolute(path).string()};
    const std::array<char*, 3> arguments{texts[0].data(), texts[1].data(), nullptr};
    pid_t process = 0;
    return ::posix_spawnp(&process, arguments[0], nullptr, nullptr, arguments.data(), ::environ) ==
           0;
}

void note_reductions(const std::string& reductions) {
    if (!reductions.empty()) print_notes("reduced", {reductions});
}

void run_report(const ReportArguments& arguments) {
    require_suffix(arguments.output, {".html", ".htm"});
    const ProgressBar bar("report");
    const ReportOptions& options = arguments.options;
    const std::string reductions = write_report(
        arguments.output, read_results_folder(arguments.folder, options.scene), options);
    print_written({arguments.output});
    note_reductions(reductions);
}

void run_view(const ViewArguments& arguments) {
    const std::string page = arguments.output.empty() ? temporary_page() : arguments.output;
    require_suffix(page, {".html", ".htm"});
    const ProgressBar bar("view");
    const nlos::CaptureReadSettings settings = capture_options(arguments.overrides).capture;
    const std::string reductions =
        write_report(page, read_result_files(arguments.files, settings), arguments.options);
    note_written({page});
    const bool opened = !arguments.keep_closed && open_in_browser(page);
    print("wrote {}{}\n", page, opened ? "" : "; open it in a browser");
    note_reductions(reductions);
}

void declare_report(Command& command) {
    auto& arguments = command.runs<ReportArguments>(run_report);
    add_folder_option(command, "DIR", arguments.folder, "Folder of captures, volumes and metrics")
        ->required();
    add_output_option(command, arguments.output, "Page to write (.html)")->required();
    add_file_option(command,
                    "--scene",
                    arguments.options.scene,
                    "Scene with the truth, if not the one that the results name (.json)");
    add_size_option(command, arguments.options);
}

void declare_view(Command& command) {
    auto& arguments = command.runs<ViewArguments>(run_view);
    command.settings = core::settings_help(CaptureOptions{});
    add_file_option(command,
                    "FILE",
                    arguments.files,
                    "Captures, volumes, fits, metrics; of a scene.json: the truth beside them")
        ->required();
    add_output_option(command, arguments.output, "Page to keep (.html); else a temporary one");
    command.add_flag("--no-browser", arguments.keep_closed, "Only write the page");
    add_size_option(command, arguments.options);
    add_capture_options(command, arguments.overrides);
}

}  // namespace

extern const CommandRow kReportCommand{"report",
                                       "Make one self-contained page of a folder of results",
                                       "nlos report data -o report.html",
                                       declare_report};
extern const CommandRow kViewCommand{
    "view",
    "Show captures, volumes and scenes as a page in the browser",
    "nlos view data/letter.h5 scenes/letter/scene.json --no-browser",
    declare_view};

}  // namespace apps
