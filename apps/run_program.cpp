// SPDX-License-Identifier: MIT
#include "apps/run_program.h"

#include "renderer/core/error.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>

namespace apps {
namespace {

/// What the system takes for arguments.
std::vector<char*> words_of(std::vector<std::string>& arguments) {
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    return words;
}

}  // namespace

std::optional<int> run_program(std::vector<std::string> arguments, const std::string& input) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), &std::fclose);
    if (!file || std::fwrite(input.data(), 1, input.size(), file.get()) != input.size()) {
        return std::nullopt;
    }
    std::rewind(file.get());

    posix_spawn_file_actions_t streams;
    ::posix_spawn_file_actions_init(&streams);
    ::posix_spawn_file_actions_adddup2(&streams, ::fileno(file.get()), STDIN_FILENO);
    ::posix_spawn_file_actions_addopen(&streams, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    ::posix_spawn_file_actions_addopen(&streams, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    std::vector<char*> words = words_of(arguments);
    pid_t process = 0;
    const int error =
        ::posix_spawnp(&process, words.front(), &streams, nullptr, words.data(), ::environ);
    ::posix_spawn_file_actions_destroy(&streams);
    if (error != 0) return std::nullopt;
    int status = 0;
    if (::waitpid(process, &status, 0) != process || !WIFEXITED(status)) return -1;
    return WEXITSTATUS(status);
}

std::string program_beside(const std::string& name) {
    std::error_code is_missing;
    const auto folder = std::filesystem::read_symlink("/proc/self/exe", is_missing).parent_path();
    const std::string path = (folder / name).string();
    if (std::filesystem::exists(path, is_missing)) return path;
    throw core::Failure(path, "is missing; it is built and installed together with nlos");
}

void become(const std::string& name, std::vector<std::string> arguments) {
    const std::string path = program_beside(name);
    ::execv(path.c_str(), words_of(arguments).data());
    throw core::Failure(path, "cannot be started");
}

}  // namespace apps
