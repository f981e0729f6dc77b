// SPDX-License-Identifier: MIT
#include "apps/run_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <memory>

namespace apps {

std::optional<int> run_program(std::vector<std::string> arguments,
                               const std::string& input,
                               const std::string& output) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), &std::fclose);
    if (!file || std::fwrite(input.data(), 1, input.size(), file.get()) != input.size()) {
        return std::nullopt;
    }
    std::rewind(file.get());

    const char* const target = output.empty() ? "/dev/null" : output.c_str();
    posix_spawn_file_actions_t streams;
    ::posix_spawn_file_actions_init(&streams);
    ::posix_spawn_file_actions_adddup2(&streams, ::fileno(file.get()), STDIN_FILENO);
    ::posix_spawn_file_actions_addopen(&streams, STDOUT_FILENO, target, O_WRONLY | O_TRUNC, 0);
    ::posix_spawn_file_actions_addopen(&streams, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    std::vector<char*> words;
    words.reserve(arguments.size() + 1);
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    pid_t process = 0;
    const int error =
        ::posix_spawnp(&process, words.front(), &streams, nullptr, words.data(), ::environ);
    ::posix_spawn_file_actions_destroy(&streams);
    if (error != 0) return std::nullopt;
    int status = 0;
    if (::waitpid(process, &status, 0) != process || !WIFEXITED(status)) return -1;
    return WEXITSTATUS(status);
}

}  // namespace apps
