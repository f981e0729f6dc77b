// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/error.h"
#include "renderer/core/progress.h"
#include "renderer/core/system/parallel.h"

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <string>
#include <vector>

namespace python {

/// How a long call reports to Python while other threads hold its lock.
///
/// Ctrl-C, and exceptions of the callback, stop the work at its next pass and are raised by
/// raise_pending().
class CallProgress {
 public:
    /// callback   None, or called as callback(fraction, text) from the calling thread; if it
    ///            returns False, the work stops with what it has
    explicit CallProgress(nanobind::object callback) : callback_(std::move(callback)) {}

    core::Progress progress();
    /// Needs Python's lock.
    void raise_pending();
    /// Hands what was doubted to Python's `warnings`. Needs Python's lock.
    void give_warnings();

 private:
    using Clock = std::chrono::steady_clock;

    void report(double fraction, const std::string& text);
    bool should_stop();
    template <class Call>
    void call_python(const Call& call);

    nanobind::object callback_;
    std::vector<std::string> doubts_;
    std::mutex mutex_;
    std::exception_ptr raised_;
    std::atomic<bool> stopped_{false};
    std::atomic<Clock::rep> last_look_{0};
};

/// Threads of a call: as many as asked for, and one alone after a fork, which keeps no other.
core::ThreadLimit limit_threads(int threads);

/// Runs work(progress) without Python's lock, on up to `threads` threads (0: all).
template <class Work>
auto run_long(const nanobind::object& callback, int threads, Work&& work) {
    CallProgress reporter(callback);
    const core::Progress progress = reporter.progress();
    const auto run = [&] {
        const nanobind::gil_scoped_release released;
        const core::ThreadLimit limit = limit_threads(threads);
        return work(progress);
    };
    try {
        auto result = run();
        reporter.raise_pending();
        reporter.give_warnings();
        return result;
    } catch (const core::Failure&) {
        reporter.raise_pending();
        throw;
    }
}

/// Held while files are read or written. Readers fork a process, which must not happen while
/// another thread is within HDF5: the child would wait for a lock that nobody holds.
std::mutex& file_mutex();

/// Reads or writes a file where Python's lock is released already; one at a time.
template <class Work>
auto with_files_locked(Work&& work) {
    const std::lock_guard lock(file_mutex());
    return work();
}

/// The same, and releases Python's lock.
template <class Work>
auto with_files(Work&& work) {
    const nanobind::gil_scoped_release released;
    return with_files_locked(work);
}

}  // namespace python
