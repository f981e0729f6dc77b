// SPDX-License-Identifier: MIT
#include "apps/python/long_call.h"

#include <nanobind/stl/string.h>
#include <pthread.h>

namespace python {
namespace {

namespace nb = nanobind;

constexpr std::chrono::milliseconds kBetweenLooks{50};

std::atomic<bool> g_is_forked{false};

}  // namespace

core::ThreadLimit limit_threads(int threads) {
    // Registered once; the handler of the child sets a flag and does nothing else.
    static const int registered = ::pthread_atfork(nullptr, nullptr, [] { g_is_forked = true; });
    static_cast<void>(registered);
    return core::ThreadLimit(g_is_forked ? 1 : threads);
}

std::mutex& file_mutex() {
    static std::mutex mutex;
    return mutex;
}

template <class Call>
void CallProgress::call_python(const Call& call) {
    const nb::gil_scoped_acquire acquired;
    try {
        call();
    } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!raised_) raised_ = std::current_exception();
        stopped_ = true;
    }
}

void CallProgress::report(double fraction, const std::string& text) {
    if (callback_.is_none() || stopped_) return;
    call_python([&] {
        const nb::object answer = callback_(fraction, text);
        if (answer.ptr() == Py_False) stopped_ = true;
    });
}

// Signals are looked at a few times a second: asking takes Python's lock.
bool CallProgress::should_stop() {
    const Clock::rep now = Clock::now().time_since_epoch().count();
    Clock::rep last = last_look_;
    const auto pause = std::chrono::duration_cast<Clock::duration>(kBetweenLooks).count();
    if (!stopped_ && now - last > pause && last_look_.compare_exchange_strong(last, now)) {
        call_python([] {
            if (PyErr_CheckSignals() != 0) throw nb::python_error();
        });
    }
    return stopped_;
}

core::Progress CallProgress::progress() {
    core::Progress progress;
    progress.report = [this](double fraction, const std::string& text) { report(fraction, text); };
    progress.stop_requested = [this] { return should_stop(); };
    progress.warn = [this](const std::string& text) { doubts_.push_back(text); };
    return progress;
}

void CallProgress::raise_pending() {
    if (raised_) std::rethrow_exception(raised_);
}

void CallProgress::give_warnings() {
    for (const std::string& text : doubts_) {
        if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 2) != 0) throw nb::python_error();
    }
}

}  // namespace python
