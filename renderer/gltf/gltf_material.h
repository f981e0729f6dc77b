// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_fwd.h"
#include "renderer/gltf/gltf_document.h"
#include "renderer/material/scene_geometry.h"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace renderer {

/// What glTF writes for each TextureWrap.
inline constexpr std::array<int, 3> kGltfWraps{10497, 33071, 33648};

/// Our own entries in the extras of a node or material; empty where nothing is said.
struct NlosExtras {
    std::optional<Role> role;
    std::optional<bool> ellipsoidal_exclude;
    std::optional<core::Vec3> velocity_m_per_s;
    std::optional<bool> retroreflective;
    std::optional<SurfaceModel> surface_model;

    /// The model of a surface that is `otherwise` where these extras say nothing of it.
    SurfaceModel model_or(SurfaceModel otherwise) const;
    /// These values, and those of `fallback` where this has none.
    NlosExtras or_else(const NlosExtras& fallback) const;
};

template <class Visitor>
void for_each_field(NlosExtras& extras, Visitor&& visit) {
    visit("nlos_role", extras.role, "what the surface is to the measurement");
    visit("nlos_ellipsoidal_exclude", extras.ellipsoidal_exclude, "no ellipsoidal connection here");
    visit("nlos_velocity_m_per_s", extras.velocity_m_per_s, "velocity, world [m/s]");
    visit("nlos_retroreflective", extras.retroreflective, "reflects light back where it came from");
    visit("nlos_surface_model", extras.surface_model, "how it reflects, for what glTF cannot say");
}

/// Reads the nlos_ entries of the extras of `owner`, a node or material; others are left alone.
/// Throws core::Error for unknown nlos_ keys, for wrong types, and for keys of ours without the
/// prefix, which would be overlooked.
NlosExtras read_nlos_extras(const core::Json& owner, const std::string& where);

/// A material of the file, with what it says about its surfaces.
struct LoadedMaterial {
    Material material;
    NlosExtras extras;
    std::array<double, 3> colour{1.0, 1.0, 1.0};  ///< linear, whose mean is the albedo
    std::vector<std::string> warnings;            ///< what the file says of it that is not modelled
    int texture_coordinate_set = 0;  ///< the n of TEXCOORD_n that the albedo texture uses
    Eigen::Affine2d uv_transform = Eigen::Affine2d::Identity();  ///< from these to the texture's
};

/// Reads materials and decodes their textures, each once.
class MaterialReader {
 public:
    explicit MaterialReader(const GltfDocument& document) : document_(document) {}

    /// index    of the material; -1 is the material of primitives without one
    /// throws   core::Error for extras that are wrong and images that cannot be decoded
    const LoadedMaterial& read(int index);

 private:
    const GltfDocument& document_;
    std::map<int, LoadedMaterial> loaded_;
};

}  // namespace renderer
