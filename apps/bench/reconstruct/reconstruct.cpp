// SPDX-License-Identifier: MIT
#include "apps/bench/reconstruct/reconstruct.h"

#include "apps/bench/command.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/parallel.h"

namespace apps {
namespace {

nlos::PlotLine scaling_line(const ReconstructScaling& curve, double ScalingPoint::*value) {
    return nlos::line_of(curve.of == "voxels" ? curve.method + ", voxels" : curve.method,
                         curve.points,
                         &ScalingPoint::values,
                         value);
}

nlos::Plot scaling_plot(const std::vector<ReconstructScaling>& curves,
                        const std::string& title,
                        double ScalingPoint::*value) {
    nlos::Plot plot{title + " against size", "values of the capture, or voxels", title, {}};
    for (const ReconstructScaling& curve : curves) {
        plot.lines.push_back(scaling_line(curve, value));
    }
    return plot;
}

void add_limits(const std::vector<ReconstructScaling>& curves, nlos::Plot& plot) {
    for (std::size_t i = 0; i < curves.size(); ++i) {
        nlos::PlotLine& line =
            plot.lines.emplace_back(scaling_line(curves[i], &ScalingPoint::limit_seconds));
        line.title += ", FFTs or sums alone";
        line.style = nlos::LineStyle::Limit;
        line.limit_of = static_cast<int>(i);
    }
}

void declare_reconstruct_bench(Command& command) {
    auto& settings = add_benchmark(command, measure_reconstruct);
    add_setting(command, "--scenes", settings.scenes_folder, "Folder of the scenes")
        ->type_name("DIR");
    add_setting(command, "--part", settings.part, "What to measure")
        ->check(one_of({"all", "time", "accuracy", "scaling"}));
    add_setting(command, "--repeats", settings.repeats, "Runs per median", {1, 1000});
    add_threads_option(command, settings.threads);
    add_setting(
        command, "--largest", settings.largest, "Largest side of the scaling curves", {32, 256});
}

}  // namespace

BenchResult measure_reconstruct(const ReconstructBenchSettings& settings,
                                const core::Progress& progress) {
    const core::ThreadLimit threads(settings.threads);
    const auto wants = [&](const char* part) {
        return settings.part == "all" || settings.part == part;
    };
    BenchResult result{{{"threads", core::thread_count()},
                        {"repeats", settings.repeats},
                        {"costs", core::Json::array()},
                        {"accuracies", core::Json::array()},
                        {"scaling", core::Json::array()}}};
    core::Json& figures = result.figures;
    if (wants("time")) figures["costs"] = measure_costs(settings, progress.part(0.0, 0.3));
    if (wants("accuracy")) {
        figures["accuracies"] = measure_accuracies(settings, progress.part(0.3, 0.6));
    }
    if (wants("scaling")) {
        const auto scaling = measure_scaling(settings, progress.part(0.6, 1.0));
        figures["scaling"] = core::write_value(scaling);
        nlos::Plot& time = result.plots["_time"];
        time = scaling_plot(scaling, "CPU time [s]", &ScalingPoint::cpu_seconds);
        add_limits(scaling, time);
        result.plots["_memory"] = scaling_plot(scaling, "memory [bytes]", &ScalingPoint::bytes);
    }
    return result;
}

extern const CommandRow kReconstructBench{"reconstruct",
                                          "Time, memory and accuracy of every method",
                                          "nlos bench reconstruct -o out/bench",
                                          declare_reconstruct_bench};

}  // namespace apps
