// SPDX-License-Identifier: MIT
#pragma once

#include "apps/dataset/item_plan.h"
#include "nlos/containers/shape.h"
#include "nlos/containers/stored_number.h"
#include "nlos/formats/coordinates.h"
#include "renderer/core/progress.h"
#include "renderer/core/settings/json_file.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace apps {

/// A named array of one item, as it is stored.
struct ItemArray {
    std::string name;
    nlos::Shape shape;  ///< of one item; empty for a number
    nlos::StoredNumber number = nlos::StoredNumber::Float32;
    std::string bytes;                               ///< in the machine's order, slowest axis first
    std::optional<nlos::Coordinates> coordinates{};  ///< of places and directions
};

template <class T>
ItemArray make_item_array(std::string name,
                          nlos::Shape shape,
                          nlos::StoredNumber number,
                          std::span<const T> values,
                          const std::optional<nlos::Coordinates>& coordinates = std::nullopt) {
    return {std::move(name),
            std::move(shape),
            number,
            {reinterpret_cast<const char*>(values.data()), values.size_bytes()},
            coordinates};
}

/// Where the time of items goes: processor seconds per step.
struct ItemProfile {
    double meshes = 0.0;
    double render = 0.0;
    double detector = 0.0;
    double truths = 0.0;
    double packing = 0.0;

    /// The sum of all steps [s].
    double total() const { return meshes + render + detector + truths + packing; }
    void add(const ItemProfile& other);
};

template <class Visitor>
void for_each_field(ItemProfile& p, Visitor&& visit) {
    visit("meshes", p.meshes, "reading and simplifying surfaces");
    visit("render", p.render, "the light of the scene");
    visit("detector", p.detector, "what is counted of it");
    visit("truths", p.truths, "what is known of the scene");
    visit("packing", p.packing, "compressing and writing");
}

/// The fraction of each step, for people.
std::string fractions_text(ItemProfile profile);

/// One capture of a data set, with what is known of its scene, as it is stored.
struct Item {
    std::vector<ItemArray> arrays;
    core::Json parameters;
    std::set<std::size_t> broken_meshes;
    std::size_t clipped_counts = 0;  ///< beyond what the type of the histograms can hold
    bool interrupted = false;        ///< and then of no use
    bool is_dark = false;            ///< no light of the scene lies within the time axis
    ItemProfile profile{};
};

/// Draws and computes an item. In a dark one the detector counts for its exposure_s, or 1 s, what
/// is not signal.
///
/// Arrays: H, shaped as in a capture file, in W/(m^2 sr) per bin or counts; with float16 also
/// H_scale, by which H has to be multiplied; clean, what H is without the detector; depth [m from
/// the wall, NaN where nothing is], normals [world], albedo, mask and object_ids (-1 where nothing
/// is), all over the wall (X, Y) at scene.ground_truth.depth_resolution; poses (M, 4, 4), world
/// from a mesh whose longest side is 1, of the most objects that an item can have, NaN for those it
/// has not.
///
/// progress   asked whether to stop
/// throws     core::Error, core::Failure as renderer::render() and nlos::detect() do
Item make_item(const Recipe& recipe,
               MeshLibrary& meshes,
               std::uint64_t item,
               const core::Progress& progress);

}  // namespace apps
