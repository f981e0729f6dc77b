// SPDX-License-Identifier: MIT
#include "apps/bench/reconstruct/reconstruct.h"

#include "renderer/core/parallel.h"

#include <fmt/core.h>

namespace apps {
namespace {

std::string costs_text(const ReconstructBench& bench) {
    if (bench.costs.empty()) return "";
    std::string text = fmt::format("{:<32} {:>8} {:>8} {:>8} {:>7} {:>9} {:>8} {:>8}  {:<24} {}\n",
                                   fmt::format("time, {} thread(s)", bench.threads),
                                   "CPU s",
                                   "wall s",
                                   "limit s",
                                   "ratio",
                                   "G pairs/s",
                                   "peak GB",
                                   "said GB",
                                   "target",
                                   "met");
    for (const ReconstructCost& cost : bench.costs) {
        const bool has_limit = cost.limit_seconds > 0.0;
        text +=
            fmt::format("{:<32} {:>8.3f} {:>8.3f} {:>8} {:>7} {:>9} {:>8.3f} {:>8.3f}  {:<24} {}\n",
                        cost.name,
                        cost.cpu_seconds,
                        cost.seconds,
                        has_limit ? fmt::format("{:.3f}", cost.limit_seconds) : "",
                        has_limit ? fmt::format("{:.2f}", cost.ratio) : "",
                        cost.gpairs_per_s > 0.0 ? fmt::format("{:.2f}", cost.gpairs_per_s) : "",
                        1e-9 * cost.peak_bytes,
                        1e-9 * cost.stated_bytes,
                        cost.target,
                        cost.met);
    }
    return text;
}

std::string accuracies_text(const ReconstructBench& bench) {
    if (bench.accuracies.empty()) return "";
    std::string text =
        fmt::format("{:<26} {:<14} {:>8} {:>8} {:>8} {:>6} {:>6} {:>8} {:>8}  {:<28} {}\n",
                    "accuracy",
                    "method",
                    "MAE mm",
                    "median",
                    "RMSE mm",
                    "IoU 20",
                    "best",
                    "normals",
                    "CPU s",
                    "target",
                    "met");
    for (const ReconstructAccuracy& row : bench.accuracies) {
        text += fmt::format(
            "{:<26} {:<14} {:>8.2f} {:>8.2f} {:>8.2f} {:>6.2f} {:>6.2f} {:>8.1f} {:>8.2f}  {:<28} "
            "{}\n",
            row.scene,
            row.method,
            1e3 * row.depth_mae_m,
            1e3 * row.depth_median_m,
            1e3 * row.depth_rmse_m,
            row.mask_iou,
            row.mask_iou_best,
            row.normal_median_deg,
            row.cpu_seconds,
            row.target,
            row.met);
    }
    return text;
}

std::string scaling_text(const ReconstructBench& bench) {
    std::string text;
    std::string of;
    for (const ReconstructScaling& curve : bench.scaling) {
        if (curve.of != of) {
            of = curve.of;
            text += fmt::format("\n{:<50}", "scaling with " + of + ": CPU s, of the limit, GB");
            for (const ScalingPoint& point : curve.points)
                text += fmt::format("{:>23}", point.size);
            text += fmt::format("{:>16}\n", "exponents");
        }
        text += fmt::format("{:<50}", curve.method);
        for (const ScalingPoint& point : curve.points) {
            text += fmt::format("{:>10.3f} {:>4.1f} {:>7.3f}",
                                point.cpu_seconds,
                                point.cpu_seconds / point.limit_seconds,
                                1e-9 * point.bytes);
        }
        text += fmt::format("{:>10.2f} {:>5.2f}\n", curve.time_exponent, curve.memory_exponent);
    }
    return text;
}

PlotLine scaling_line(const ReconstructScaling& curve, double ScalingPoint::*value) {
    PlotLine line{curve.of == "voxels" ? curve.method + ", voxels" : curve.method, {}, {}};
    for (const ScalingPoint& point : curve.points) {
        line.x.push_back(point.values);
        line.y.push_back(point.*value);
    }
    return line;
}

LogPlot scaling_plot(const ReconstructBench& bench,
                     const std::string& title,
                     double ScalingPoint::*value) {
    LogPlot plot{title + " against size", "values of the capture, or voxels", title, {}};
    for (const ReconstructScaling& curve : bench.scaling) {
        plot.lines.push_back(scaling_line(curve, value));
    }
    return plot;
}

void add_limits(const ReconstructBench& bench, LogPlot& plot) {
    for (std::size_t i = 0; i < bench.scaling.size(); ++i) {
        PlotLine& line =
            plot.lines.emplace_back(scaling_line(bench.scaling[i], &ScalingPoint::limit_seconds));
        line.title += ", FFTs or sums alone";
        line.style = LineStyle::Limit;
        line.limit_of = static_cast<int>(i);
    }
}

}  // namespace

ReconstructBench bench_reconstruct(const ReconstructBenchSettings& settings,
                                   const core::Progress& progress) {
    const core::ThreadLimit threads(settings.threads);
    ReconstructBench bench;
    bench.threads = core::thread_count();
    bench.repeats = settings.repeats;
    const auto wants = [&](const char* part) {
        return settings.part == "all" || settings.part == part;
    };
    if (wants("time")) bench.costs = measure_costs(settings, progress.part(0.0, 0.3));
    if (wants("accuracy")) bench.accuracies = measure_accuracies(settings, progress.part(0.3, 0.6));
    if (wants("scaling")) bench.scaling = measure_scaling(settings, progress.part(0.6, 1.0));
    return bench;
}

BenchResult reconstruct_result(const ReconstructBench& bench) {
    BenchResult result{core::write_value(bench),
                       costs_text(bench) + "\n" + accuracies_text(bench) + scaling_text(bench),
                       {},
                       {}};
    if (!bench.scaling.empty()) {
        LogPlot& time = result.plots["_time"];
        time = scaling_plot(bench, "CPU time [s]", &ScalingPoint::cpu_seconds);
        add_limits(bench, time);
        result.plots["_memory"] = scaling_plot(bench, "memory [bytes]", &ScalingPoint::bytes);
    }
    return result;
}

}  // namespace apps
