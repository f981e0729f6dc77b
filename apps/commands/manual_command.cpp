// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/commands.h"
#include "apps/manual/manual.h"
#include "apps/outcome.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "renderer/core/system/output_file.h"

#include <filesystem>
#include <sstream>

namespace apps {
namespace {

namespace fs = std::filesystem;

// Name and number, without what identifies the build.
std::string release_text() {
    std::istringstream words(version_text());
    std::string name;
    std::string number;
    words >> name >> number;
    return name + " " + number;
}

struct ManualArguments {
    const CLI::App* program = nullptr;
    std::string folder;
};

void run(const ManualArguments& arguments) {
    const std::string& folder = arguments.folder;
    const CommandEntry commands = describe_command(*arguments.program);
    const auto write = [&](const fs::path& name, const std::string& text) {
        const fs::path path = fs::path(folder) / name;
        std::error_code error;
        fs::create_directories(path.parent_path(), error);
        if (error) throw core::Error(folder, "cannot be made", "must be a writable folder");
        core::write_text_file(path.string(), text);
    };
    const std::string release = release_text();
    const std::vector<const CommandEntry*> all = all_commands(commands);
    for (const CommandEntry* command : all) {
        write(fs::path("man1") / (page_name(*command) + ".1"), man_page(*command, release));
    }
    write("bash/nlos", bash_completion(commands));
    write("zsh/_nlos", zsh_completion(commands));
    write("reference.md", reference_page(commands, release));
    note_written({folder});
    outcome()["pages"] = all.size();
    print("wrote {} ({} manual pages, completion for bash and zsh, reference.md)\n",
          folder,
          all.size());
}

}  // namespace

void declare_manual(Command& command) {
    auto& arguments = command.runs<ManualArguments>(run);
    arguments.program = command.get_parent();
    add_output_folder_option(
        command, arguments.folder, "Folder for man1/, bash/, zsh/ and reference.md")
        ->required();
}

}  // namespace apps
