// SPDX-License-Identifier: MIT
#include "apps/command.h"

#include <string>
#include <vector>

namespace apps {
namespace {

// `nlos help COMMAND` is `nlos COMMAND --help`, see program.cpp; nothing is left to run.
void declare_help(Command& command) {
    command.add_option_function<std::vector<std::string>>(
        "COMMAND",
        [](const std::vector<std::string>&) {},
        "Command to describe, as in `bench render`; none: all commands in short");
}

}  // namespace

extern const CommandRow kHelpCommand{
    "help", "Show what a command does, its options and settings", "nlos help render", declare_help};

}  // namespace apps
