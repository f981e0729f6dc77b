// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/error.h"
#include "renderer/core/settings/json_file.h"

#include <chrono>
#include <cstdint>
#include <cstring>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

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
///
/// failure   what an exception of the library's own, with its message, or a text that is not UTF-8
///           means; empty: the same as a crash
Json run_sandboxed(const std::string& path,
                   const std::function<Json()>& work,
                   const std::function<Error(const std::string& message)>& failure = {});

/// An answer that is a list of plain numbers, as its bytes.
template <class T>
Json to_binary(const std::vector<T>& items) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(items.data());
    return Json::binary({bytes, bytes + items.size() * sizeof(T)});
}

/// Takes such a list out of an answer.
template <class T>
void from_binary(const Json& json, std::vector<T>& items) {
    const auto& bytes = json.get_binary();
    items.resize(bytes.size() / sizeof(T));
    std::memcpy(items.data(), bytes.data(), items.size() * sizeof(T));
}

}  // namespace core
