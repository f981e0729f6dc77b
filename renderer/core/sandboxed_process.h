// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

namespace core {

/// A child of this process that runs a library on a file which may be damaged.
///
/// Libraries for file formats take much of what a file says for granted: some damaged files make
/// them overrun memory or never end, however carefully they are asked. In a child with bounded time
/// and memory that ends nothing but the child.
///
/// A child holds the locks that other threads held when it was started, and nobody there releases
/// them. One that waits for such a lock is replaced by another, so answers may depend on earlier
/// requests only in how fast they come.
class SandboxedProcess {
 public:
    /// Answers a request with bytes, in the child. What it throws is thrown by ask().
    using Serve = std::function<std::string(const std::string& request)>;

    /// Starts the child.
    ///
    /// path     names the file in messages; its size bounds the child's time
    /// throws   Failure when no process can be started
    SandboxedProcess(std::string path, Serve serve);
    ~SandboxedProcess();
    SandboxedProcess(const SandboxedProcess&) = delete;
    SandboxedProcess& operator=(const SandboxedProcess&) = delete;

    /// Sends a request and waits for the answer.
    ///
    /// throws   Error or Failure as the child does; Error when the child crashed
    ///          or did not end in time
    std::string ask(const std::string& request);

 private:
    void start();
    void end();
    bool has_answer_in(std::chrono::milliseconds patience) const;
    [[noreturn]] void throw_ended();

    std::string path_;
    Serve serve_;
    std::uint64_t file_bytes_;
    std::mutex one_at_a_time_;
    int process_ = -1;
    int socket_ = -1;
};

/// Bounds what the calling process may allocate from now on [bytes]; for children, which end soon.
void bound_memory(std::uint64_t bytes);

/// Runs `work` once in a SandboxedProcess and returns its answer.
std::string run_sandboxed(const std::string& path, const std::function<std::string()>& work);

}  // namespace core
