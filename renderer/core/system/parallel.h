// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace core {

/// Calls `body(i)` for every i in [0, count), on all threads allowed; order unspecified.
/// The first exception thrown by a body is rethrown here.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

/// Calls `body(begin, end)` for consecutive blocks of at most `block` items, on all threads
/// allowed. The blocks depend on `count` and `block` only, never on the number of threads.
void parallel_blocks(std::size_t count,
                     std::size_t block,
                     const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Sums `term(i)` over [0, count): blocks in parallel, partial sums merged in index order, so the
/// result has the same bits for any number of threads.
///
/// zero   the neutral element; T needs +=
template <class T>
T parallel_sum(std::size_t count, T zero, const std::function<T(std::size_t)>& term) {
    constexpr std::size_t kBlock = 1024;
    std::vector<T> partial((count + kBlock - 1) / kBlock, zero);
    parallel_blocks(count, kBlock, [&](std::size_t begin, std::size_t end) {
        T& sum = partial[begin / kBlock];
        for (std::size_t i = begin; i < end; ++i) sum += term(i);
    });
    T total = zero;
    for (const T& sum : partial) total += sum;
    return total;
}

/// Calls `make(i)` for i from 0 to count - 1 on all threads allowed, and `use(i, result)` for the
/// results one by one, in order, while later ones are still being made. No more than two results
/// per thread exist at a time.
///
/// use       returns false to end the work, be it at the last result
/// returns   whether all results were used and none ended the work
bool parallel_pointers_in_order(std::size_t count,
                                const std::function<std::shared_ptr<void>(std::size_t)>& make,
                                const std::function<bool(std::size_t, void*)>& use);
template <class T>
bool parallel_in_order(std::size_t count,
                       const std::function<T(std::size_t)>& make,
                       const std::function<bool(std::size_t, T)>& use) {
    return parallel_pointers_in_order(
        count,
        [&](std::size_t i) -> std::shared_ptr<void> { return std::make_shared<T>(make(i)); },
        [&](std::size_t i, void* result) { return use(i, std::move(*static_cast<T*>(result))); });
}

/// Runs `body` on the calling thread alone: parallel loops inside it are serial. For work of which
/// many pieces run side by side.
void run_on_one_thread(const std::function<void()>& body);

/// Limits parallel loops to `count` threads while it (or a copy) lives; 0 means all processors.
class ThreadLimit {
 public:
    explicit ThreadLimit(int count);

 private:
    std::shared_ptr<void> control_;
};

/// Threads that a parallel loop may use now.
int thread_count();

}  // namespace core
