// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings.h"

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

/// Reservoir reuse: what the estimator `restir` is told; the others leave it alone.
struct RestirSettings {
    Candidates candidates = Candidates::Shared;
    int walks = 1;
    int shared_walks = 512;
    Reuse reuse = Reuse::PathLength;
    Chart chart = Chart::Adaptive;
    Gauge gauge = Gauge::Average;
    int rounds = 1;
    int neighbours = 3;
    int confidence_cap = 20;
    double shrink_fraction = 0.0;
    bool reuse_bins = false;  // costs more than it gives, see the README
    bool reverse_check = true;
};

inline bool has_connections(Candidates kind) {
    return kind == Candidates::Ellipsoidal || kind == Candidates::All;
}
inline bool has_shared_walks(Candidates kind) {
    return kind == Candidates::Shared || kind == Candidates::All;
}

template <class Visitor>
void for_each_field(RestirSettings& s, Visitor&& visit) {
    visit("candidates", s.candidates, "what reservoirs choose from");
    visit("walks", s.walks, "walks from the sensor, per pair and frame");
    visit("shared_walks",
          s.shared_walks,
          "shared, all: walks from the light tried, per pair and frame");
    visit("reuse", s.reuse, "how paths are reused");
    visit("chart", s.chart, "coordinates in which a vertex moves");
    visit("gauge", s.gauge, "what fixes the second coordinate");
    visit("rounds", s.rounds, "rounds of spatial reuse");
    visit("neighbours", s.neighbours, "neighbours per round");
    visit("confidence_cap", s.confidence_cap, "cap of the confidence, in frames");
    visit("shrink_fraction", s.shrink_fraction, "share of walks traced against a wider gate");
    visit("reuse_bins", s.reuse_bins, "histograms: also reuse the two neighbouring bins");
    visit("reverse_check", s.reverse_check, "solve every shift backwards too");
}

}  // namespace renderer

template <>
struct core::EnumNames<renderer::Candidates> {
    static constexpr std::array<std::pair<renderer::Candidates, std::string_view>, 4> value{
        {{renderer::Candidates::Path, "path"},
         {renderer::Candidates::Ellipsoidal, "ellipsoidal"},
         {renderer::Candidates::Shared, "shared"},
         {renderer::Candidates::All, "all"}}};
};
template <>
struct core::EnumNames<renderer::Reuse> {
    static constexpr std::array<std::pair<renderer::Reuse, std::string_view>, 3> value{
        {{renderer::Reuse::PathLength, "path_length"},
         {renderer::Reuse::Naive, "naive"},
         {renderer::Reuse::None, "none"}}};
};
template <>
struct core::EnumNames<renderer::Chart> {
    static constexpr std::array<std::pair<renderer::Chart, std::string_view>, 5> value{
        {{renderer::Chart::Plane, "plane"},
         {renderer::Chart::Hemisphere, "hemisphere"},
         {renderer::Chart::Barycentric, "barycentric"},
         {renderer::Chart::Adaptive, "adaptive"},
         {renderer::Chart::Custom, "custom"}}};
};
template <>
struct core::EnumNames<renderer::Gauge> {
    static constexpr std::array<std::pair<renderer::Gauge, std::string_view>, 6> value{
        {{renderer::Gauge::Average, "average"},
         {renderer::Gauge::Start, "start"},
         {renderer::Gauge::Fixed, "fixed"},
         {renderer::Gauge::Midpoint, "midpoint"},
         {renderer::Gauge::Symmetric, "symmetric"},
         {renderer::Gauge::Flow, "flow"}}};
};
