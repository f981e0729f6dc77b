// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/progress.h"
#include "renderer/core/settings.h"
#include "renderer/settings/restir_settings.h"

#include <string>
#include <vector>

namespace apps {

/// Share of the shifts tried that one reason, or none, decided.
struct ShiftShare {
    std::string name;
    double share = 0.0;
};

template <class Visitor>
void for_each_field(ShiftShare& share, Visitor&& visit) {
    visit("name", share.name, "reason of rejection");
    visit("share", share.share, "of the shifts tried");
}

/// One gauge in one chart.
struct GaugeRow {
    std::string chart;
    std::string gauge;
    double success = 0.0;     ///< share accepted, reverse check on
    double no_return = 0.0;   ///< share of shifts accepted without the check that do not come back
    double iterations = 0.0;  ///< Newton or Runge-Kutta steps per shift tried, without the check
    double ns = 0.0;          ///< CPU time per shift tried, without the check
    double ns_checked = 0.0;  ///< the same with it
    double error_median = 0.0;  ///< of the determinant, relative, against central differences
    double error_p95 = 0.0;
};

template <class Visitor>
void for_each_field(GaugeRow& row, Visitor&& visit) {
    visit("chart", row.chart, "coordinates");
    visit("gauge", row.gauge, "what fixes the second coordinate");
    visit("success", row.success, "share accepted, reverse check on");
    visit("no_return", row.no_return, "share accepted without the check that does not come back");
    visit("iterations", row.iterations, "steps per shift, without the check");
    visit("ns", row.ns, "CPU time per shift without the check [ns]");
    visit("ns_checked", row.ns_checked, "CPU time per shift with the check [ns]");
    visit("error_median", row.error_median, "relative error of the determinant, median");
    visit("error_p95", row.error_p95, "relative error of the determinant, 95th percentile");
}

/// One chart on one scene.
struct ChartRow {
    std::string scene;
    std::string chart;
    double accepted = 0.0;  ///< share of the shifts tried
    double by_ray = 0.0;    ///< of the shifts tried
    double ns = 0.0;        ///< CPU time per shift tried
    std::vector<ShiftShare> rejected;
};

template <class Visitor>
void for_each_field(ChartRow& row, Visitor&& visit) {
    visit("scene", row.scene, "scene file");
    visit("chart", row.chart, "coordinates");
    visit("accepted", row.accepted, "share of the shifts tried");
    visit("by_ray", row.by_ray, "share accepted on the hemisphere");
    visit("ns", row.ns, "CPU time per shift tried [ns]");
    visit("rejected", row.rejected, "reasons");
}

/// Where the time of a shift goes.
struct ShiftCost {
    std::string operation;
    double ns = 0.0;
};

template <class Visitor>
void for_each_field(ShiftCost& cost, Visitor&& visit) {
    visit("operation", cost.operation, "what was timed");
    visit("ns", cost.ns, "CPU time [ns]");
}

/// What `nlos bench shift` measured.
struct ShiftBench {
    std::string gauge_scene;
    std::vector<GaugeRow> gauges;
    std::vector<ChartRow> charts;
    std::vector<ShiftCost> costs;
};

template <class Visitor>
void for_each_field(ShiftBench& bench, Visitor&& visit) {
    visit("gauge_scene", bench.gauge_scene, "scene of the gauge comparison and of the costs");
    visit("gauges", bench.gauges, "gauge comparison");
    visit("charts", bench.charts, "chart comparison");
    visit("costs", bench.costs, "parts of a shift");
}

/// Compares gauges and charts of the shift mapping, on one thread.
///
/// Shifts are those of spatial and temporal reuse: a vertex drawn by area and by the cosines at it,
/// visible from its measurement pair, goes to a pair next to it and to a length up to a bin off.
///
/// scene_paths   scene descriptions; charts are compared on all, gauges on the first
/// num_shifts    per scene
ShiftBench bench_shift(const std::vector<std::string>& scene_paths,
                       int num_shifts,
                       const core::Progress& progress);

}  // namespace apps
