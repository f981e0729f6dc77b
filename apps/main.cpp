// SPDX-License-Identifier: MIT
#include "apps/program.h"
#include "renderer/core/system/large_memory.h"

int main(int argc, char** argv) {
    core::keep_freed_memory();
    return apps::run_nlos(argc, argv);
}
