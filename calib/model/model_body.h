// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/fit_settings.h"
#include "calib/model/scene_state.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace calib {

/// A surface vertex of a body at its start, relative to the node's origin.
struct ModelVertex {
    core::Vec3 position_m;
    core::Vec3 normal;  ///< mean of its facets', by area
};

struct ModelFacet {
    std::uint32_t body = 0;
    std::array<std::uint32_t, 3> vertices{};
    double albedo_ratio = 1.0;  ///< to the body's first surface
    bool is_retroreflective = false;
};

/// Objects that move as one: those of one glTF node, and where that node is freed by name, those of
/// all nodes below it.
struct ModelBody {
    std::string name;
    core::Mat3 turn = core::Mat3::Identity();  ///< of the node, at the start: its rotation
    core::Vec3 origin_m;                       ///< of the node, at the start
    std::vector<std::size_t> objects;          ///< of the geometry
    std::vector<ModelVertex> vertices;
    std::vector<std::vector<std::uint32_t>> neighbours;  ///< of each vertex, along edges
    double albedo = 1.0;                                 ///< at the start
    FreeObject free;

    core::Vec3 vertex_world(const BodyState& state, std::size_t vertex) const;
};

/// A facet in the world, and how its corners move with each parameter that reaches them.
struct FacetMotion {
    std::array<core::Vec3, 3> corners;
    std::vector<int> columns;
    std::vector<std::array<core::Vec3, 3>> by_column;  ///< d corner / d parameter

    void add(int column, const std::array<core::Vec3, 3>& by_parameter) {
        columns.push_back(column);
        by_column.push_back(by_parameter);
    }
};

}  // namespace calib
