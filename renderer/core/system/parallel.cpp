// SPDX-License-Identifier: MIT
#include "renderer/core/system/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>

namespace core {

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
    tbb::parallel_for(std::size_t{0}, count, body);
}

void parallel_blocks(std::size_t count,
                     std::size_t block,
                     const std::function<void(std::size_t, std::size_t)>& body) {
    const std::size_t blocks = (count + block - 1) / block;
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t i) {
        body(i * block, std::min(count, (i + 1) * block));
    });
}

bool parallel_pointers_in_order(std::size_t count,
                                const std::function<std::shared_ptr<void>(std::size_t)>& make,
                                const std::function<bool(std::size_t, void*)>& use) {
    // What is thrown in a pipeline leaves behind what is on its way, so that nothing may be.
    struct Made {
        std::size_t index = 0;
        std::shared_ptr<void> result{};
        std::exception_ptr error{};
    };
    const auto try_to_make = [&](std::size_t i) -> Made {
        try {
            return {i, make(i)};
        } catch (...) {
            return {i, nullptr, std::current_exception()};
        }
    };
    std::atomic<bool> is_ended = false;
    std::exception_ptr error;
    std::size_t next = 0;
    const auto try_to_use = [&](const Made& made) {
        try {
            if (made.error) std::rethrow_exception(made.error);
            is_ended = !use(made.index, made.result.get());
        } catch (...) {
            error = std::current_exception();
            is_ended = true;
        }
    };
    tbb::parallel_pipeline(
        2 * static_cast<std::size_t>(thread_count()),
        tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order,
                                            [&](tbb::flow_control& control) {
                                                if (next < count && !is_ended) return next++;
                                                control.stop();
                                                return count;
                                            }) &
            tbb::make_filter<std::size_t, Made>(
                tbb::filter_mode::parallel,
                [&](std::size_t i) { return is_ended ? Made{i} : try_to_make(i); }) &
            tbb::make_filter<Made, void>(tbb::filter_mode::serial_in_order, [&](const Made& made) {
                if (!is_ended) try_to_use(made);
            }));
    if (error) std::rethrow_exception(error);
    return !is_ended;
}

void run_on_one_thread(const std::function<void()>& body) {
    tbb::task_arena(1).execute(body);
}

ThreadLimit::ThreadLimit(int count)
    : control_(std::make_shared<tbb::global_control>(
          tbb::global_control::max_allowed_parallelism,
          count > 0 ? static_cast<std::size_t>(count)
                    : std::max<std::size_t>(1, std::thread::hardware_concurrency()))) {}

int thread_count() {
    return static_cast<int>(
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

}  // namespace core
