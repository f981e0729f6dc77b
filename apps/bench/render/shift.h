// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/figures.h"
#include "renderer/core/progress.h"
#include "renderer/settings/restir_settings.h"

#include <string>
#include <vector>

namespace apps {

/// Share of the shifts tried that one reason, or none, decided.
struct ShiftShare {
    std::string name;    ///< reason of rejection
    double share = 0.0;  ///< of the shifts tried
};
NLOS_FIGURES(ShiftShare, name, share);

/// One gauge in one chart.
struct GaugeRow {
    std::string chart;        ///< coordinates
    std::string gauge;        ///< what fixes the second coordinate
    double success = 0.0;     ///< share accepted, reverse check on
    double no_return = 0.0;   ///< share of shifts accepted without the check that do not come back
    double iterations = 0.0;  ///< Newton or Runge-Kutta steps per shift tried, without the check
    double ns = 0.0;          ///< CPU time per shift tried, without the check
    double ns_checked = 0.0;  ///< the same with it
    double error_median = 0.0;  ///< of the determinant, relative, against central differences
    double error_p95 = 0.0;     ///< relative error of the determinant, 95th percentile
};
NLOS_FIGURES(GaugeRow,
             chart,
             gauge,
             success,
             no_return,
             iterations,
             ns,
             ns_checked,
             error_median,
             error_p95);

/// One chart on one scene.
struct ChartRow {
    std::string scene;                 ///< scene file
    std::string chart;                 ///< coordinates
    double accepted = 0.0;             ///< share of the shifts tried
    double by_ray = 0.0;               ///< of the shifts tried
    double ns = 0.0;                   ///< CPU time per shift tried
    std::vector<ShiftShare> rejected;  ///< reasons
};
NLOS_FIGURES(ChartRow, scene, chart, accepted, by_ray, ns, rejected);

/// Where the time of a shift goes.
struct ShiftCost {
    std::string operation;  ///< what was timed
    double ns = 0.0;        ///< CPU time [ns]
};
NLOS_FIGURES(ShiftCost, operation, ns);

/// What `nlos bench shift` measured.
struct ShiftBench {
    std::string gauge_scene;       ///< scene of the gauge comparison and of the costs
    std::vector<GaugeRow> gauges;  ///< gauge comparison
    std::vector<ChartRow> charts;  ///< chart comparison
    std::vector<ShiftCost> costs;  ///< parts of a shift
};
NLOS_FIGURES(ShiftBench, gauge_scene, gauges, charts, costs);

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
