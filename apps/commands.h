// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>

namespace apps {

// One function per subcommand, in the file of its name. Each declares its arguments and a callback
// that reads, calls one front door, writes, and prints what was written.
void add_render_command(CLI::App& app);
void add_convert_command(CLI::App& app);
void add_simulate_noise_command(CLI::App& app);
void add_reconstruct_command(CLI::App& app);
void add_fit_command(CLI::App& app);
void add_calibrate_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_info_command(CLI::App& app);
void add_report_command(CLI::App& app);
void add_view_command(CLI::App& app);
void add_generate_command(CLI::App& app);
void add_demo_command(CLI::App& app);
void add_bench_command(CLI::App& app);
void add_sweep_command(CLI::App& app);
void add_track_command(CLI::App& app);
void add_manual_command(CLI::App& app);

// Subcommands of bench.
void add_bench_noise_command(CLI::App& bench);
void add_bench_coverage_command(CLI::App& bench);
void add_bench_weights_command(CLI::App& bench);
void add_bench_long_range_command(CLI::App& bench);
void add_bench_sequences_command(CLI::App& bench);
void add_bench_shift_command(CLI::App& bench);
void add_bench_render_command(CLI::App& bench);
void add_bench_fit_command(CLI::App& bench);
void add_bench_comparisons_command(CLI::App& bench);
void add_bench_reconstruct_command(CLI::App& bench);
void add_bench_track_command(CLI::App& bench);
void add_bench_field_command(CLI::App& bench);

}  // namespace apps
