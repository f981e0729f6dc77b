// SPDX-License-Identifier: MIT
// Random shifts in hard configurations, every accepted one checked; of 100,000 at a time the first
// wrong one is printed:
//     shift_stress <number of shifts>
// Ends with 1 when one was accepted wrongly.
#include "renderer/core/system/parallel.h"
#include "tests/support/hard_shift_cases.h"

#include <fmt/core.h>

#include <cstdlib>

int main(int argc, char** argv) {
    using test_support::HardShiftBench;
    constexpr std::uint64_t kBlock = 100'000;
    const std::uint64_t count = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : kBlock;
    const HardShiftBench bench;
    HardShiftBench::Tally total;
    std::vector<HardShiftBench::Tally> blocks((count + kBlock - 1) / kBlock);
    core::parallel_for(blocks.size(), [&](std::size_t i) {
        blocks[i] = bench.run(i * kBlock, std::min(count, (i + 1) * kBlock));
    });
    for (const auto& tally : blocks) {
        if (tally.wrong > 0) fmt::print("{}\n", tally.first_wrong);
        total += tally;
    }
    for (std::size_t i = 0; i < test_support::kHardShiftNames.size(); ++i) {
        fmt::print("{:<20} {:>12} tried {:>12} accepted\n",
                   test_support::kHardShiftNames[i],
                   total.tried[i],
                   total.accepted[i]);
    }
    fmt::print("{} without a way back at the edge of what can be shifted\n", total.at_edge);
    fmt::print("{} of {} wrong\n", total.wrong, count);
    return total.wrong == 0 ? 0 : 1;
}
