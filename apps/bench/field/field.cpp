// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/field/captures_table.h"
#include "apps/bench/field/losses.h"
#include "apps/bench/field/reconstruction_table.h"
#include "apps/bench/field/rendering_table.h"
#include "apps/outcome.h"
#include "apps/report/report.h"
#include "apps/terminal.h"
#include "nlos/plots/plot.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <string>
#include <vector>

namespace apps {
namespace {

void add(nlos::PlotLine& line, double x, std::optional<double> y) {
    if (y && *y > 0.0) line.add(x, *y);
}

/// Depth error against CPU time and against counts per point, for either pattern, by the end of
/// the pictures' names.
std::map<std::string, nlos::Plot> reconstruction_plots(
    const std::vector<ReconstructionSummary>& summaries) {
    std::map<std::string, nlos::Plot> plots;
    for (const ReconstructionSummary& s : summaries) {
        if (!s.cpu_s) continue;
        const std::string of = fmt::format("{}, {} x {} points", s.pattern, s.points, s.points);
        const std::string suffix = fmt::format("_{}_{}", s.pattern, s.points);
        const std::string title = s.program + " " + s.method;
        nlos::Plot& time = plots["_time" + suffix];
        time.title = "Error against time, without noise, " + of;
        time.x_label = "CPU time of the calculation [s]";
        time.y_label = "mean depth error, median of the scenes [mm]";
        add(line_named(title, time), *s.cpu_s, s.clean_mae_mm);
        if (!s.mae_mm_3) continue;
        nlos::Plot& photons = plots["_photons" + suffix];
        photons.title = "Photons against accuracy, " + of;
        photons.x_label = "counts per wall point";
        photons.y_label = time.y_label;
        photons.x_ticks = {3, 20, 100};
        nlos::PlotLine& line = line_named(title, photons);
        add(line, 3, s.mae_mm_3);
        add(line, 20, s.mae_mm_20);
        add(line, 100, s.mae_mm_100);
    }
    for (auto& [suffix, plot] : plots) {
        if (suffix.starts_with("_time")) plot.lines.push_back(pareto_front(plot.lines));
    }
    return plots;
}

/// Error against CPU time for every scene and order, likewise.
std::map<std::string, nlos::Plot> rendering_plots(const std::vector<RenderingRow>& rows) {
    std::map<std::string, nlos::Plot> plots;
    for (const RenderingRow& row : rows) {
        if (!row.cpu_s) continue;
        nlos::Plot& plot = plots[fmt::format("_render_{}_{}", row.scene, row.max_bounces)];
        plot.title =
            fmt::format("Error against time, {}, up to {} bounces", row.scene, row.max_bounces);
        plot.x_label = "CPU time of the rendering [s]";
        plot.y_label = "relative L2 error over all of H";
        add(line_named(row.program + " " + row.method, plot), *row.cpu_s, row.rel_l2);
    }
    for (auto& [suffix, plot] : plots) plot.lines.push_back(pareto_front(plot.lines));
    return plots;
}

/// What the field's table is made of.
struct FieldSettings {
    std::string part = "all";  ///< all, reconstruct, render or captures
    std::string peers;         ///< environment of install_peers.sh; empty: our methods alone
    std::string captures;      ///< folder with a captures.json; empty: none
    int sensing_points = 32;   ///< along either side of the wall
    double limit_s = 120.0;    ///< CPU time that one run may take
    bool quick = false;        ///< the letter alone, fewer points and samples
};

/// What renderers mean by the same words.
core::Json conventions() {
    const auto row = [](const char* what, const char* ours, const char* mitransient) {
        return core::Json{{"what", what}, {"ours", ours}, {"mitransient", mitransient}};
    };
    return {
        row("unit",
            "W/(m^2 sr) leaving a wall point, for 1 W on the spot",
            "for the projector's irradiance on the spot, which the adapter divides by"),
        row("bin",
            "[start + i w, start + (i+1) w), each holding the light in it",
            "the same with both filters `box`"),
        row("path length",
            "from the spot to the wall point",
            "the same without `account_first_and_last_bounces`"),
        row("bounces",
            "spot and wall point included: 3 is one hidden surface",
            "`max_depth`, the laser's own on top of what is traced"),
        row("spot",
            "a point",
            "a point, by `nlos_laser_sampling`; the projector's width does not count"),
        row("wall point", "a point, the middle of a cell", "the same"),
        row("albedo", "diffuse, one number", "`reflectance`, the same"),
        row("sides",
            "every surface reflects on both",
            "on that which its normal points to; sheets are turned to the wall"),
        row("ray offset",
            "none that shortens a path",
            "rays start 9e-5 (1 + |p|) scene units off a surface; given in millimetres, paths are "
            "0.02 mm short"),
        row("hidden-geometry sampling",
            "",
            "counts a direction once for every surface it crosses: scored by the letter alone"),
    };
}

/// Our methods and installed peers side by side on the same files: reconstruction of scenes by
/// light levels, rendering by orders of bounces with the agreement of every bin, and captures of
/// the user's. Every run is a process of its own on one thread; one that fails costs its row.
///
/// folder    gets the captures, volumes and logs of all runs
/// throws    core::Error for a folder of peers or captures that is none; core::Failure when
///           interrupted
BenchResult measure_field(const FieldSettings& settings,
                          const std::string& folder,
                          const core::Progress& progress) {
    const auto wants = [&](const std::string& part) {
        return settings.part == "all" || settings.part == part;
    };
    if (!settings.captures.empty())
        read_known_captures(settings.captures);  // before an hour has passed
    std::filesystem::create_directories(folder);
    Baselines baselines(settings.peers, folder, settings.limit_s);
    BenchResult result{core::Json::object()};
    std::vector<Loss> losses;
    if (wants("reconstruct")) {
        const std::vector<ReconstructionRow> rows = measure_reconstructions(baselines,
                                                                            settings.sensing_points,
                                                                            settings.quick,
                                                                            progress.part(0.0, 0.5),
                                                                            result.pictures);
        const std::vector<ReconstructionSummary> summaries = summarise(rows);
        result.figures["reconstruction"] = core::write_value(summaries);
        losses = find_losses(summaries);
        result.figures["reconstruction_runs"] = core::write_value(rows);
        result.plots.merge(reconstruction_plots(summaries));
    }
    if (wants("render")) {
        const RenderingTable table = measure_renderings(
            baselines, settings.sensing_points, settings.quick, progress.part(0.5, 0.9));
        result.figures["rendering"] = core::write_value(table.summaries);
        std::ranges::move(find_losses(table.summaries), std::back_inserter(losses));
        result.figures["rendering_runs"] = core::write_value(table.rows);
        result.figures["bin_agreement"] = table.agreement;
        result.figures["conventions"] = conventions();
        result.plots.merge(rendering_plots(table.rows));
    }
    result.figures["losses"] = core::write_value(losses);
    if (wants("captures") && !settings.captures.empty()) {
        result.figures["captures"] = core::write_value(measure_captures(
            baselines, settings.captures, progress.part(0.9, 1.0), result.pictures));
    }
    if (!baselines.versions().empty()) {
        result.figures["peers"] = fmt::format("{}", fmt::join(baselines.versions(), ", "));
    }
    return result;
}

struct FieldArguments {
    BenchOutput output;
    FieldSettings settings;
};

void run(const FieldArguments& arguments) {
    const auto& [output, settings] = arguments;
    const std::filesystem::path folder = output.folder;
    run_benchmark(output, "field", [&](const core::Progress& progress) {
        return measure_field(arguments.settings, (folder / "files").string(), progress);
    });
    const std::string page = (folder / "report.html").string();
    write_report(page, read_results_folder(output.folder), {});
    print_written({page});
}

void declare_field_bench(Command& command) {
    auto& [output, settings] = command.runs<FieldArguments>(run);
    add_output_options(command, output);
    add_setting(command, "--part", settings.part, "What to measure")
        ->check(one_of({"all", "reconstruct", "render", "captures"}));
    command
        .add_option("--peers",
                    settings.peers,
                    "Environment of apps/bench/field/install_peers.sh (default: no peers)")
        ->type_name("DIR");
    command
        .add_option("--captures",
                    settings.captures,
                    "Folder with captures.json: own captures and known distances")
        ->type_name("DIR");
    add_setting(command,
                "--sensing-points",
                settings.sensing_points,
                "Wall points along either side, a multiple of 4",
                {8, 256});
    add_setting(command, "--limit-s", settings.limit_s, "CPU time one run may take [s]");
    command.add_flag("--quick", settings.quick, "The letter alone: a few minutes");
}

}  // namespace

extern const CommandRow kFieldBench{"field",
                                    "Our methods and installed peers on the same files",
                                    "nlos bench field -o out/field --quick --sensing-points 16",
                                    declare_field_bench};

}  // namespace apps
