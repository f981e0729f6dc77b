// SPDX-License-Identifier: MIT
#pragma once

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
class SandboxedProcess {
 public:
    /// Answers a request with bytes, in the child. It may keep state between requests. What it
    /// throws is thrown by ask().
    using Serve = std::function<std::string(const std::string& request)>;

    /// Starts the child.
    ///
    /// path     names the file in messages; its size bounds the child's time
    /// throws   Failure when no process can be started
    SandboxedProcess(std::string path, const Serve& serve);
    ~SandboxedProcess();
    SandboxedProcess(const SandboxedProcess&) = delete;
    SandboxedProcess& operator=(const SandboxedProcess&) = delete;

    /// Sends a request and waits for the answer.
    ///
    /// throws   Error or Failure as the child does; Error when the child crashed
    ///          or did not end in time
    std::string ask(const std::string& request);

 private:
    [[noreturn]] void throw_ended();

    std::string path_;
    std::mutex one_at_a_time_;
    int process_ = -1;
    int socket_ = -1;
};

/// Bounds what the calling process may allocate from now on [bytes]; for children, which end soon.
void bound_memory(std::uint64_t bytes);

/// Runs `work` once in a SandboxedProcess and returns its answer.
std::string run_sandboxed(const std::string& path, const std::function<std::string()>& work);

}  // namespace core
