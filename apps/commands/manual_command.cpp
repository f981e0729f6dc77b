// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/commands.h"
#include "apps/manual/manual.h"
#include "apps/outcome.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "renderer/core/output_file.h"

#include <filesystem>
#include <memory>
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

void write_manual(const CLI::App& program, const std::string& folder) {
    const CommandEntry commands = describe_command(program);
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

void add_manual_command(CLI::App& app) {
    Command& command =
        add_command(app,
                    "manual",
                    "Write manual pages, completion for bash and zsh, and a reference of settings");
    const auto folder = std::make_shared<std::string>();
    add_output_folder_option(command, *folder, "Folder for man1/, bash/, zsh/ and reference.md")
        ->required();
    command.example = "nlos manual -o out/manual";
    command.callback([&app, folder] { write_manual(app, *folder); });
}

}  // namespace apps
