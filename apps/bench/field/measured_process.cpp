// SPDX-License-Identifier: MIT
#include "apps/bench/field/measured_process.h"

#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace apps {
namespace {

double seconds_of(const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

// The last line with something on it.
std::string last_line_of(const std::string& path) {
    if (std::filesystem::file_size(path) == 0) return "";
    const core::MappedFile file(path, "must be readable");
    std::string_view text = file.bytes();
    const std::size_t end = text.find_last_not_of(" \r\n\t");
    if (end == std::string_view::npos) return "";
    text = text.substr(0, end + 1);
    const std::size_t begin = text.find_last_of('\n');
    return core::printable(
        std::string(text.substr(begin == std::string_view::npos ? 0 : begin + 1)));
}

// The environment of this process, numerical libraries held to one thread.
std::vector<std::string> one_thread_environment() {
    std::vector<std::string> variables;
    for (char** variable = ::environ; *variable != nullptr; ++variable) {
        if (!std::string_view(*variable).ends_with("_NUM_THREADS"))
            variables.emplace_back(*variable);
    }
    for (const char* library : {"OMP", "OPENBLAS", "MKL", "NUMBA"}) {
        variables.push_back(fmt::format("{}_NUM_THREADS=1", library));
    }
    variables.emplace_back("PYTHONDONTWRITEBYTECODE=1");
    return variables;
}

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
    std::vector<char*> pointers;
    for (std::string& text : texts) pointers.push_back(text.data());
    pointers.push_back(nullptr);
    return pointers;
}

void limit_process(pid_t process, int resource, double most) {
    const auto value = static_cast<rlim_t>(most);
    // With a little more for the hard limit, the process is told (SIGXCPU) before it is killed.
    const rlimit bounds{value, value + 5};
    ::prlimit(process, static_cast<__rlimit_resource>(resource), &bounds, nullptr);
}

pid_t start(std::vector<std::string> arguments, const std::string& output, const std::string& log) {
    posix_spawn_file_actions_t streams;
    ::posix_spawn_file_actions_init(&streams);
    constexpr int kWrite = O_WRONLY | O_CREAT | O_TRUNC;
    ::posix_spawn_file_actions_addopen(&streams, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&streams, STDOUT_FILENO, output.c_str(), kWrite, 0644);
    ::posix_spawn_file_actions_addopen(&streams, STDERR_FILENO, log.c_str(), kWrite, 0644);
    std::vector<std::string> environment = one_thread_environment();
    pid_t process = 0;
    const int status = ::posix_spawnp(&process,
                                      arguments.front().c_str(),
                                      &streams,
                                      nullptr,
                                      pointers_to(arguments).data(),
                                      pointers_to(environment).data());
    ::posix_spawn_file_actions_destroy(&streams);
    if (status != 0) {
        throw core::Failure(arguments.front(),
                            "cannot be started: " + std::string(std::strerror(status)));
    }
    return process;
}

std::string failure_of(int status, const std::string& log) {
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
    if (std::string said = last_line_of(log); !said.empty()) return said;
    return WIFSIGNALED(status)
               ? fmt::format(
                     "ended by signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)))
               : fmt::format("ended with status {}", WEXITSTATUS(status));
}

}  // namespace

MeasuredProcess run_measured(const std::vector<std::string>& arguments,
                             const std::string& log,
                             const ProcessLimits& limits) {
    const std::string output = log + ".out";
    const pid_t process = start(arguments, output, log);
    limit_process(process, RLIMIT_CPU, std::ceil(limits.cpu_seconds));
    if (limits.data_bytes) {
        limit_process(process, RLIMIT_DATA, static_cast<double>(*limits.data_bytes));
    }
    int status = 0;
    rusage usage{};
    while (::wait4(process, &status, 0, &usage) < 0) {
        if (errno != EINTR) throw core::Failure(arguments.front(), "cannot be waited for");
    }
    MeasuredProcess measured;
    measured.was_stopped = WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU;
    measured.failure = measured.was_stopped
                           ? fmt::format("stopped after {:.0f} s of CPU time", limits.cpu_seconds)
                           : failure_of(status, log);
    measured.last_line = last_line_of(output);
    measured.cpu_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
    std::filesystem::remove(output);
    return measured;
}

}  // namespace apps
