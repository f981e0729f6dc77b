// SPDX-License-Identifier: MIT
#include "renderer/core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
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
