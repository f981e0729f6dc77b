// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_file.h"
#include "renderer/core/settings/settings.h"

#include <optional>
#include <string>
#include <vector>

namespace apps {

/// Keys that vary together, and their values one after another.
struct SweepAxis {
    std::vector<std::string> keys;                ///< dotted, such as reconstruct.method
    std::vector<std::vector<core::Json>> values;  ///< [value][key]; null stands for itself

    /// The keys as a sweep file has them, with commas between them.
    std::string name() const;
};

/// What varies: in a sweep file an object from keys to lists of values, the last key fastest.
struct SweepGrid {
    std::vector<SweepAxis> axes;
};

/// What is the same in all runs: an object from keys to values.
struct SweepFixed {
    core::Json values = core::Json::object();  ///< nested, as if all keys were taken apart at dots
};

/// A plot to draw of the results.
struct SweepPlot {
    std::string metric;   ///< a score of METRICS.json, or seconds_render, _noise, _reconstruct
    std::string against;  ///< a key of the grid with numbers
};

/// What a sweep file says.
struct SweepSettings {
    std::string scene;
    SweepFixed fixed;
    SweepGrid grid;
    int repeats = 1;
    std::optional<std::vector<SweepPlot>> plots;  ///< nothing: see plots_of()
};

template <class Visitor>
void for_each_field(SweepPlot& plot, Visitor&& visit) {
    visit("metric", plot.metric, "score of METRICS.json, or seconds_render, _noise, _reconstruct");
    visit("against", plot.against, "key of the grid whose values are numbers");
}

template <class Visitor>
void for_each_field(SweepSettings& sweep, Visitor&& visit) {
    visit("scene", sweep.scene, "scene.json, path relative to the sweep file");
    visit("fixed",
          sweep.fixed,
          "settings of all runs by key: scene. (as render --set), noise. (as simulate-noise --set) "
          "and reconstruct. (as reconstruct --set, and method)");
    visit("grid",
          sweep.grid,
          "settings that vary: key -> list of values, or \"key, key\" -> list of lists of values; "
          "the last varies fastest");
    visit("repeats",
          sweep.repeats,
          core::at_least(1, "runs of every point of the grid, each with a noise.seed of its own"));
    visit("plots",
          sweep.plots,
          "list of {metric, against}; null: depth_mae_m, fscore_10mm and seconds against every "
          "key with several numbers");
}

void read_value(const core::Json& json, const std::string& where, SweepPlot& plot);
void read_value(const core::Json& json, const std::string& where, SweepGrid& grid);
core::Json write_value(const SweepGrid& grid);
void read_value(const core::Json& json, const std::string& where, SweepFixed& fixed);
core::Json write_value(const SweepFixed& fixed);

/// A value as an object of objects, one for every part of the dotted key.
core::Json nested_value(const std::string& key, core::Json value);

/// Takes changes over: objects key by key, everything else in place of what was there.
void merge_values(const core::Json& changes, core::Json& values);

/// Reads a sweep file and applies `--set key.path=value` texts to it. `scene` then is a path that
/// can be opened. What the values mean to scene, detector and method is left to SweepPlan.
///
/// throws   core::Error naming file, key, what was found and what is allowed
SweepSettings read_sweep(const std::string& path, const std::vector<std::string>& overrides);

}  // namespace apps
