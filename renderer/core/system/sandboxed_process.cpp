// SPDX-License-Identifier: MIT
#include "renderer/core/system/sandboxed_process.h"

#include "renderer/core/error.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <optional>
#include <sstream>

namespace core {
namespace {

// The address sanitizer reserves more addresses than any limit would allow.
#if defined(__SANITIZE_ADDRESS__)
constexpr bool kReservesAddresses = true;
#elif defined(__has_feature)
constexpr bool kReservesAddresses = __has_feature(address_sanitizer);
#else
constexpr bool kReservesAddresses = false;
#endif

// A message is a kind, the number of its bytes, and these.
enum class Kind : char { Bytes = 'b', Error = 'e', Failure = 'f', OutOfMemory = 'm' };
constexpr std::size_t kMessageHeaderBytes = 1 + sizeof(std::uint64_t);
constexpr std::uint64_t kLongestMessage = std::uint64_t{1} << 40;

/// Calls `move(bytes, count)`, which sends or receives some of them, until all are through.
template <class Byte, class Move>
bool move_all(Byte* bytes, std::size_t count, const Move& move) {
    while (count > 0) {
        const ssize_t moved = move(bytes, count);
        if (moved < 0 && errno == EINTR) continue;
        if (moved <= 0) return false;
        bytes += moved;
        count -= static_cast<std::size_t>(moved);
    }
    return true;
}

bool send_all(int socket, const char* bytes, std::size_t count) {
    return move_all(bytes, count, [&](const char* next, std::size_t rest) {
        return ::send(socket, next, rest, MSG_NOSIGNAL);
    });
}

bool receive_all(int socket, char* bytes, std::size_t count) {
    return move_all(
        bytes, count, [&](char* next, std::size_t rest) { return ::recv(socket, next, rest, 0); });
}

bool send_message(int socket, Kind kind, const std::string& bytes) {
    std::array<char, kMessageHeaderBytes> header{};
    const std::uint64_t count = bytes.size();
    header[0] = static_cast<char>(kind);
    std::memcpy(header.data() + 1, &count, sizeof(count));
    return send_all(socket, header.data(), header.size()) &&
           send_all(socket, bytes.data(), bytes.size());
}

struct Message {
    Kind kind = Kind::Bytes;
    std::string bytes;
};

std::optional<Message> receive_message(int socket) {
    std::array<char, kMessageHeaderBytes> header{};
    if (!receive_all(socket, header.data(), header.size())) return std::nullopt;
    Message message;
    std::uint64_t count = 0;
    message.kind = static_cast<Kind>(header[0]);
    std::memcpy(&count, header.data() + 1, sizeof(count));
    if (count > kLongestMessage) return std::nullopt;
    message.bytes.resize(count);
    if (!receive_all(socket, message.bytes.data(), count)) return std::nullopt;
    return message;
}

void limit(__rlimit_resource resource, std::uint64_t most) {
    rlimit limits{};
    ::getrlimit(resource, &limits);
    limits.rlim_cur = std::min<rlim_t>(most, limits.rlim_max);
    ::setrlimit(resource, &limits);
}

/// Address space in use now [bytes].
std::uint64_t used_address_space() {
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// CPU time that reading a file may take [s].
std::uint64_t cpu_limit_s(std::uint64_t file_bytes) {
    constexpr std::uint64_t kSeconds = 5;
    constexpr std::uint64_t kBytesPerSecond = 250'000;  // slower than to inflate a file of zeros
    return kSeconds + file_bytes / kBytesPerSecond;
}

/// What a request may take by the clock [s], on a machine that is shared with many.
unsigned request_limit_s(std::uint64_t file_bytes) {
    constexpr std::uint64_t kLongest = 100'000;
    return static_cast<unsigned>(std::min(kLongest, 30 * cpu_limit_s(file_bytes)));
}

void bound_resources(std::uint64_t file_bytes) {
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, cpu_limit_s(file_bytes));
    bound_memory(available_memory_bytes());
}

/// A crash is silent and ends the child; to be interrupted is left to the parent.
void isolate() {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU, SIGALRM}) {
        std::signal(signal, SIG_DFL);
    }
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_IGN);
    const int nowhere = ::open("/dev/null", O_RDWR);
    if (nowhere < 0) return;
    for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        ::dup2(nowhere, standard);
    }
}

[[noreturn]] void run_child(int socket,
                            std::uint64_t file_bytes,
                            const SandboxedProcess::Serve& serve) {
    isolate();
    bound_resources(file_bytes);
    while (const std::optional<Message> request = receive_message(socket)) {
        bool is_sent = false;
        ::alarm(request_limit_s(file_bytes));
        try {
            is_sent = send_message(socket, Kind::Bytes, serve(request->bytes));
        } catch (const Error& error) {
            is_sent = send_message(socket, Kind::Error, error.what());
        } catch (const Failure& failure) {
            is_sent = send_message(socket, Kind::Failure, failure.what());
        } catch (const std::bad_alloc&) {
            is_sent = send_message(socket, Kind::OutOfMemory, "");
        } catch (...) {
            break;  // as a crash
        }
        if (!is_sent) break;
        ::alarm(0);
    }
    ::_exit(0);  // nothing of the parent's is cleaned up here
}

/// Throws an error again that the child wrote as `where: found; allowed`.
[[noreturn]] void throw_error(const std::string& line) {
    const std::size_t where_end = line.find(": ");
    const std::size_t found_end = line.rfind("; ");
    if (where_end == std::string::npos || found_end == std::string::npos || found_end < where_end) {
        throw Error(line, "was found", "must be mended");
    }
    throw Error(line.substr(0, where_end),
                line.substr(where_end + 2, found_end - where_end - 2),
                line.substr(found_end + 2));
}

[[noreturn]] void throw_failure(const std::string& line) {
    const std::size_t where_end = std::min(line.find(": "), line.size());
    throw Failure(line.substr(0, where_end), line.substr(std::min(where_end + 2, line.size())));
}

/// The CPU time of a process that sleeps [clock ticks]; nothing when it runs or waits for a disk.
std::optional<std::uint64_t> cpu_ticks_if_asleep(pid_t process) {
    std::ifstream file("/proc/" + std::to_string(process) + "/stat");
    const std::string text(std::istreambuf_iterator<char>(file), {});
    // After the name, which may hold anything: the state, 10 other fields, user and system time.
    std::istringstream fields(text.substr(std::min(text.rfind(')'), text.size() - 1) + 1));
    std::string state;
    std::string other;
    std::uint64_t user = 0;
    std::uint64_t system = 0;
    fields >> state;
    for (int i = 0; i < 10; ++i) fields >> other;
    if (!(fields >> user >> system) || state != "S") return std::nullopt;
    return user + system;
}

std::uint64_t file_bytes_of(const std::string& path) {
    std::error_code error;
    const std::uint64_t bytes = std::filesystem::file_size(path, error);
    return error ? 0 : bytes;
}

}  // namespace

SandboxedProcess::SandboxedProcess(std::string path, Serve serve)
    : path_(std::move(path)), serve_(std::move(serve)), file_bytes_(file_bytes_of(path_)) {
    start();
}

SandboxedProcess::~SandboxedProcess() {
    end();
}

void SandboxedProcess::start() {
    std::array<int, 2> sockets{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0) {
        throw Failure(path_, "cannot be read: no socket for a child process");
    }
    // No child may inherit the other end of a sibling's socket, or its end would go unnoticed.
    static std::mutex starting;
    const std::lock_guard lock(starting);
    process_ = ::fork();
    if (process_ == 0) {
        ::close(sockets[0]);
        run_child(sockets[1], file_bytes_, serve_);
    }
    ::close(sockets[1]);
    socket_ = sockets[0];
    if (process_ < 0) {
        end();
        throw Failure(path_, "cannot be read: no child process can be started");
    }
}

void SandboxedProcess::end() {
    ::close(socket_);
    socket_ = -1;
    if (process_ < 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
}

/// Waits for an answer or the child's end; false when the child meanwhile slept without working.
bool SandboxedProcess::has_answer_in(std::chrono::milliseconds patience) const {
    constexpr int kLooks = 10;
    std::optional<std::uint64_t> asleep_at;
    for (int looks_asleep = 0; looks_asleep < kLooks; ++looks_asleep) {
        pollfd answer{socket_, POLLIN, 0};
        const int ready = ::poll(&answer, 1, static_cast<int>(patience.count() / kLooks));
        if (ready > 0) return true;
        const std::optional<std::uint64_t> now_at = cpu_ticks_if_asleep(process_);
        if (!now_at || now_at != asleep_at) looks_asleep = 0;
        asleep_at = now_at;
    }
    return false;
}

void SandboxedProcess::throw_ended() {
    int status = 0;
    if (process_ >= 0) ::waitpid(process_, &status, 0);
    process_ = -1;
    const bool took_too_long =
        WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGALRM);
    throw Error(path_,
                took_too_long ? "is damaged: reading it does not end"
                              : "is damaged: reading it crashes the library for its format",
                "must be an undamaged, complete file");
}

std::string SandboxedProcess::ask(const std::string& request) {
    const std::lock_guard lock(one_at_a_time_);
    for (std::chrono::milliseconds patience(1000);; patience *= 4) {
        if (!send_message(socket_, Kind::Bytes, request)) throw_ended();
        if (has_answer_in(patience)) break;
        end();
        start();
    }
    std::optional<Message> answer = receive_message(socket_);
    if (!answer) throw_ended();
    switch (answer->kind) {
        case Kind::Bytes:
            return std::move(answer->bytes);
        case Kind::Failure:
            throw_failure(answer->bytes);
        case Kind::OutOfMemory:
            throw Failure(path_, "needs more memory than is free");
        case Kind::Error:
            break;
    }
    throw_error(answer->bytes);
}

void bound_memory(std::uint64_t bytes) {
    if (!kReservesAddresses) limit(RLIMIT_AS, used_address_space() + bytes);
}

Json run_sandboxed(const std::string& path,
                   const std::function<Json()>& work,
                   const std::function<Error(const std::string& message)>& failure) {
    const auto serve = [&](const std::string&) {
        std::string bytes;
        try {
            Json::to_cbor(work(), bytes);
        } catch (const std::exception& error) {
            const bool is_ours = dynamic_cast<const Error*>(&error) != nullptr ||
                                 dynamic_cast<const Failure*>(&error) != nullptr ||
                                 dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
            if (is_ours || !failure) throw;
            throw failure(error.what());
        }
        return bytes;
    };
    return Json::from_cbor(SandboxedProcess(path, serve).ask(""));
}

}  // namespace core
