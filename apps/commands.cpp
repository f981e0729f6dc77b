// SPDX-License-Identifier: MIT
#include "apps/commands.h"

#include <array>

namespace apps {

// Each stands in the file of its name.
extern const CommandRow kRenderCommand, kConvertCommand, kSimulateNoiseCommand, kReconstructCommand,
    kFitCommand, kCalibrateCommand, kCompareCommand, kInfoCommand, kReportCommand, kViewCommand,
    kGenerateCommand, kSweepCommand, kTrackCommand, kDemoCommand, kHelpCommand, kSceneCommand;

namespace {

// What runs these is no part of `nlos`: the benchmarks, and what describes them too.
constexpr CommandRow kBenchCommand{
    "bench",
    "Measure speed against error",
    "nlos bench reconstruct -o out/bench --part scaling --largest 32"};
constexpr CommandRow kManualCommand{
    "manual",
    "Write manual pages, completion for bash and zsh, and a reference of settings",
    "nlos manual -o out/manual"};

constexpr std::array kCommands{&kRenderCommand,
                               &kSceneCommand,
                               &kConvertCommand,
                               &kSimulateNoiseCommand,
                               &kReconstructCommand,
                               &kFitCommand,
                               &kCalibrateCommand,
                               &kCompareCommand,
                               &kInfoCommand,
                               &kReportCommand,
                               &kViewCommand,
                               &kBenchCommand,
                               &kGenerateCommand,
                               &kSweepCommand,
                               &kTrackCommand,
                               &kDemoCommand,
                               &kManualCommand,
                               &kHelpCommand};

}  // namespace

std::span<const CommandRow* const> all_commands() {
    return kCommands;
}

}  // namespace apps
