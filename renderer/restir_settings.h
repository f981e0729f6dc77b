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

/// Reservoir reuse. Part of the scene format, so that every scene file reads; `auto`, `path` and
/// `third_bounce` reuse nothing and leave it alone.
struct RestirSettings {
    Reuse reuse = Reuse::PathLength;
    Chart chart = Chart::Adaptive;
    Gauge gauge = Gauge::Average;
    int rounds = 1;
    int neighbours = 3;
    int confidence_cap = 20;
    double shrink_fraction = 0.0;
};

template <class Visitor>
void for_each_field(RestirSettings& s, Visitor&& visit) {
    visit("reuse", s.reuse, "how paths are reused");
    visit("chart", s.chart, "coordinates in which a vertex moves");
    visit("gauge", s.gauge, "what fixes the second coordinate");
    visit("rounds", s.rounds, "rounds of spatial reuse");
    visit("neighbours", s.neighbours, "neighbours per round");
    visit("confidence_cap", s.confidence_cap, "cap of the confidence, in frames");
    visit("shrink_fraction", s.shrink_fraction, "share of walks traced against a wider gate");
}

}  // namespace renderer

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
