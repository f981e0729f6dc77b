// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/settings.h"

#include <optional>

namespace renderer {

/// How a reused path is made to fit its new place: by its path length, without it, or not at all.
enum class Reuse { PathLength, Naive, None };
/// Coordinates in which a path vertex moves.
enum class Chart { Plane, Hemisphere, Barycentric, Adaptive, Custom };
/// What fixes the second coordinate of the moved vertex.
enum class Gauge { Average, Start, Fixed, Midpoint, Symmetric, Flow };

/// Where the paths that reservoirs choose from come from. Walks always take part; the other kinds
/// are weighted against them by the balance heuristic.
enum class Candidates {
    Path,         ///< independent walks from the sensor
    Ellipsoidal,  ///< these, and from each of their vertices an ellipsoidal connection to the light
    Shared,  ///< walks from the light, shared by all pairs and tested for length before any ray
    All      ///< both
};

/// Reservoir reuse; only the estimator `restir` uses these.
struct RestirSettings {
    std::optional<Candidates> candidates;
    int walks = 1;
    int shared_walks = 512;
    int connections = 256;
    Reuse reuse = Reuse::PathLength;
    Chart chart = Chart::Adaptive;
    Gauge gauge = Gauge::Average;
    std::optional<int> rounds;
    int neighbours = 3;
    int confidence_cap = 20;
    double shrink_fraction = 0.0;
    bool reuse_bins = false;  // costs more than it gives, see the README
    bool reverse_check = true;
};

inline bool has_connections(std::optional<Candidates> kind) {
    return kind == Candidates::Ellipsoidal || kind == Candidates::All;
}
inline bool has_shared_walks(std::optional<Candidates> kind) {
    return !kind || kind == Candidates::Shared || kind == Candidates::All;
}

template <class Visitor>
void for_each_field(RestirSettings& s, Visitor&& visit) {
    visit("candidates",
          s.candidates,
          "what reservoirs choose from; null: connections for third bounces on narrow axes, else "
          "shared");
    visit("walks", s.walks, core::at_least(1, "walks from the sensor, per pair and frame"));
    visit("shared_walks",
          s.shared_walks,
          core::at_least(1, "shared, all: walks from the light tried, per pair and frame"));
    visit("connections",
          s.connections,
          core::at_least(1, "ellipsoidal, all: connections from a wall point, per pair and frame"));
    visit("reuse", s.reuse, "how paths are reused");
    visit("chart", s.chart, "coordinates in which a vertex moves");
    visit("gauge", s.gauge, "what fixes the second coordinate");
    visit("rounds",
          s.rounds,
          core::at_least(0, "rounds of spatial reuse per frame; null: one where it pays"));
    visit("neighbours", s.neighbours, core::at_least(0, "neighbours per round"));
    visit("confidence_cap",
          s.confidence_cap,
          core::at_least(1, "frames that the past counts at most where scene or gate change"));
    // Shifted walks do not reach all paths of the gate: some must be drawn in it.
    visit("shrink_fraction",
          s.shrink_fraction,
          core::Ranged{"fraction of walks traced against a wider gate", {0, true, 1, false}});
    visit("reuse_bins", s.reuse_bins, "histograms: also reuse the two neighbouring bins");
    visit("reverse_check", s.reverse_check, "solve every shift backwards too");
}

}  // namespace renderer

template <>
struct core::EnumNames<renderer::Candidates> {
    static constexpr auto value =
        names_from_zero<renderer::Candidates>("path", "ellipsoidal", "shared", "all");
};
template <>
struct core::EnumNames<renderer::Reuse> {
    static constexpr auto value = names_from_zero<renderer::Reuse>("path_length", "naive", "none");
};
template <>
struct core::EnumNames<renderer::Chart> {
    static constexpr auto value = names_from_zero<renderer::Chart>(
        "plane", "hemisphere", "barycentric", "adaptive", "custom");
};
template <>
struct core::EnumNames<renderer::Gauge> {
    static constexpr auto value = names_from_zero<renderer::Gauge>(
        "average", "start", "fixed", "midpoint", "symmetric", "flow");
};
