// SPDX-License-Identifier: MIT
#include "apps/bench/program/bench.h"
#include "apps/commands.h"
#include "apps/program.h"
#include "renderer/core/system/large_memory.h"

#include <string>
#include <string_view>
#include <vector>

// `nlos` starts this program under its own name for the commands that it does not have; started by
// its own name, it takes all arguments as those of `nlos bench`.
int main(int argc, char** argv) {
    core::keep_freed_memory();
    std::vector<char*> arguments(argv, argv + argc);
    std::string bench = "bench";
    if (std::string_view(argv[0]) != "nlos") arguments.insert(arguments.begin() + 1, bench.data());
    arguments.push_back(nullptr);
    return apps::run_nlos(static_cast<int>(arguments.size()) - 1,
                          arguments.data(),
                          {{"bench", apps::declare_bench}, {"manual", apps::declare_manual}});
}
