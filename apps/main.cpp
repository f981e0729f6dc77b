// SPDX-License-Identifier: MIT
#include "apps/program.h"

int main(int argc, char** argv) {
    return apps::run_nlos(argc, argv);
}
