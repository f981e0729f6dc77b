// SPDX-License-Identifier: MIT
#pragma once

#include "apps/dataset/distribution.h"
#include "apps/shapes/shapes.h"
#include "nlos/detector/detector.h"
#include "renderer/core/settings/json_fwd.h"
#include "renderer/scene/scene_file.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// How a shard of a data set is stored.
enum class DatasetFormat { Hdf5, WebDataset };
/// How the histograms of an item are stored: counts as whole numbers, radiance as float.
enum class HistogramStorage { Float32, Float16, Uint8, Uint16 };
/// What is known of a scene and stored beside its capture.
enum class Truth { Depth, Normals, Albedo, Mask, ObjectIds, Poses, CleanHistograms };
/// How objects are turned: any way, about the vertical alone, or not.
enum class Rotation { Any, Upright, None };

/// Where the surfaces of a data set come from. Every object takes one of them, all equally likely.
struct MeshSource {
    std::string folder;              ///< all its .glb, .gltf, .obj, .ply and .stl files
    std::vector<std::string> files;  ///< beside those of the folder
    std::vector<BasicShape> shapes;  ///< beside the files
    double tolerance_bins = 0.1;
};

/// How the objects of an item are drawn.
struct ObjectDistributions {
    Distribution count = Distribution::integers(1, 3);
    Distribution size_m = Distribution::uniform(0.2, 0.5);
    Distribution stretch = Distribution::constant(1.0);
    Distribution x_m = Distribution::uniform(-0.4, 0.4);
    Distribution y_m = Distribution::uniform(-0.4, 0.4);
    Distribution z_m = Distribution::uniform(0.5, 1.2);
    Rotation rotation = Rotation::Any;
    Distribution albedo = Distribution::uniform(0.3, 0.9);
    Distribution glossy = Distribution::constant(0.0);
    Distribution roughness = Distribution::uniform(0.3, 0.7);
    bool keep_apart = true;
};

/// Everything that an item is simulated with, apart from its objects.
struct ItemSettings {
    renderer::SceneDescription scene;
    std::optional<nlos::DetectorSettings> detector;  ///< nothing: radiance is stored
};

struct StorageSettings {
    HistogramStorage histograms = HistogramStorage::Float32;
    int compression = 1;
};

/// What a data set is made by. Everything of item k follows from the recipe and k alone.
struct Recipe : ItemSettings {
    std::uint64_t items = 1000;
    std::uint64_t items_per_shard = 100;
    std::uint64_t seed = 0;
    std::uint64_t calibration_items = 0;
    DatasetFormat format = DatasetFormat::Hdf5;
    MeshSource meshes;
    ObjectDistributions objects;
    DrawTable draw;  ///< by keys of ItemSettings, for example scene.relay_wall.albedo
    std::vector<Truth> truths{Truth::Depth, Truth::Mask};
    StorageSettings storage;
};

template <class Visitor>
void for_each_field(MeshSource& s, Visitor&& visit) {
    visit("folder",
          s.folder,
          "all its .glb, .gltf, .obj, .ply and .stl files; path relative to the recipe");
    visit("files", s.files, "mesh files, beside those of the folder");
    visit("shapes",
          s.shapes,
          "surfaces made by formula, beside the files: sphere, box, plate, cylinder, cone, torus, "
          "blob");
    visit("tolerance_bins",
          s.tolerance_bins,
          core::at_least(0,
                         "triangles are taken away as long as the surface of the largest object "
                         "moves by less than this fraction of a bin; 0: all are kept"));
}

template <class Visitor>
void for_each_field(ObjectDistributions& s, Visitor&& visit) {
    visit("count", s.count, core::between(1, 100, "objects of an item"));
    visit("size_m", s.size_m, core::between(0.001, 1000, "longest side of an object's box [m]"));
    visit("stretch",
          s.stretch,
          core::between(0.001, 1000, "factor along each axis, before it is turned"));
    visit("x_m", s.x_m, "centre of an object, along wall x [m]");
    visit("y_m", s.y_m, "likewise, along wall y [m]");
    visit("z_m", s.z_m, "likewise, depth from the wall [m]");
    visit("rotation", s.rotation, "how objects are turned");
    visit("albedo", s.albedo, core::between(0, 1, "of an object"));
    visit("glossy", s.glossy, core::between(0, 1, "chance of a metal instead of a diffuse object"));
    visit("roughness", s.roughness, core::between(0, 1, "of a metal"));
    visit("keep_apart",
          s.keep_apart,
          "leave out objects that find no place beside the others and in front of the wall; false: "
          "only in front of the wall");
}

template <class Visitor>
void for_each_field(ItemSettings& s, Visitor&& visit) {
    visit("scene", s.scene, "wall, scan, time axis and effort, as in a scene file");
    visit("detector", s.detector, "what records, as in simulate-noise; null: radiance is stored");
}

template <class Visitor>
void for_each_field(StorageSettings& s, Visitor&& visit) {
    visit("histograms", s.histograms, "type of the numbers of H");
    visit("compression", s.compression, core::between(0, 9, "of deflate; 0: none"));
}

template <class Visitor>
void for_each_field(Recipe& s, Visitor&& visit) {
    visit("items", s.items, core::between(1, 1e12, "captures of the whole data set"));
    visit("items_per_shard",
          s.items_per_shard,
          core::between(1, 1e6, "captures of a file; at most a million files"));
    visit("seed", s.seed, "seed of the random numbers");
    visit(
        "calibration_items",
        s.calibration_items,
        core::between(
            0,
            1000,
            "for large data sets: first items that tell, once, how finely surfaces must be cut for "
            "scene.render.target_error; 0: every item finds that out for itself, in longer time"));
    visit("format", s.format, "how a shard is stored");
    visit("meshes", s.meshes, "where surfaces come from");
    visit("objects", s.objects, "how objects are drawn");
    for_each_field(static_cast<ItemSettings&>(s), visit);
    visit("draw",
          s.draw,
          "distributions by key of scene and detector, for example scene.relay_wall.albedo");
    visit("truths",
          s.truths,
          "stored beside H: depth, normals, albedo, mask, object_ids, poses, clean");
    visit("storage", s.storage, "types and compression");
}

/// Reads a recipe and applies `--set key.path=value` texts to it. Paths are then relative to the
/// current folder.
/// throws   core::Error naming file, key, what was found and what is allowed: also for a value that
///          only some items would get
Recipe read_recipe(const std::string& path, const std::vector<std::string>& overrides);

/// What items follow from besides the meshes: the recipe without the number of items and without
/// paths.
core::Json write_identity(const Recipe& recipe);

/// Puts drawn values, by dotted keys, into an item's settings.
/// throws   core::Error naming the key
void apply_values(const core::Json& values, ItemSettings& settings);

/// The bytes of a name as a number, which keeps streams of random numbers apart.
std::uint64_t stream_of(std::string_view name);

}  // namespace apps

template <>
struct core::EnumNames<apps::DatasetFormat> {
    static constexpr auto value = names_from_zero<apps::DatasetFormat>("hdf5", "webdataset");
};
template <>
struct core::EnumNames<apps::HistogramStorage> {
    static constexpr auto value =
        names_from_zero<apps::HistogramStorage>("float32", "float16", "uint8", "uint16");
};
template <>
struct core::EnumNames<apps::Truth> {
    static constexpr auto value = names_from_zero<apps::Truth>(
        "depth", "normals", "albedo", "mask", "object_ids", "poses", "clean");
};
template <>
struct core::EnumNames<apps::Rotation> {
    static constexpr auto value = names_from_zero<apps::Rotation>("any", "upright", "none");
};
