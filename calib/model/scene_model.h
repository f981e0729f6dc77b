// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/fit_settings.h"
#include "renderer/material/scene_geometry.h"

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace calib {

/// Where a fit stands with one body, relative to the model's start.
struct BodyState {
    core::Vec3 position_m = core::Vec3::Zero();                    ///< of the node's origin, world
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< about that origin
    double log_size = 0.0;
    double log_albedo = 0.0;        ///< of the body's first surface
    std::vector<double> heights_m;  ///< along the start's vertex normals; empty unless free
};

/// A small isotropic scatterer; albedo in m^2: albedo times area.
struct PointState {
    core::Vec3 position_m = core::Vec3::Zero();
    double log_albedo = 0.0;
};

/// Everything a fit can change.
struct SceneState {
    std::vector<BodyState> bodies;
    std::vector<PointState> points;
    double time_zero_m = 0.0;     ///< path length that the axis reads at true length 0
    double log_ambient = 0.0;     ///< per bin, in the data's unit
    double log_width = 0.0;       ///< of the response, relative to the model's
    double bow_m = 0.0;           ///< how far the wall's centre stands before its corners
    double log_wall_scale = 0.0;  ///< of wall points about their centre
    double log_scale = 0.0;       ///< data per model radiance
    bool has_ambient = false;
};

enum class ParameterKind {
    Translation,
    Rotation,
    Size,
    Albedo,
    Heights,
    PointPosition,
    PointAlbedo,
    TimeZero,
    Ambient,
    ResponseWidth,
    WallBow,
    WallScale,
    Scale
};

/// Free numbers that belong together: a range of columns of the Jacobian.
struct ParameterBlock {
    ParameterKind kind;
    std::size_t item = 0;  ///< which body or point
    int first_column = 0;
    int columns = 1;  ///< rotations turn by a vector in the world frame [rad]
    std::vector<std::string> names;
};

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
};

/// A facet in the world, and how its corners move with each parameter that reaches them.
struct FacetMotion {
    std::array<core::Vec3, 3> corners;
    std::vector<int> columns;
    std::vector<std::array<core::Vec3, 3>> by_column;  ///< d corner / d parameter
};

/// The model's surfaces as functions of the free parameters.
class SceneModel {
 public:
    /// throws   core::Error for names that the geometry lacks and materials that cannot be fitted
    SceneModel(const renderer::SceneGeometry& geometry,
               const FitSettings& settings,
               bool scale_is_free);

    const std::vector<ModelBody>& bodies() const { return bodies_; }
    const std::vector<ModelFacet>& facets() const { return facets_; }
    const std::vector<ParameterBlock>& blocks() const { return blocks_; }
    int num_columns() const { return num_columns_; }
    /// The block of a kind and item, or nothing when it is fixed.
    const ParameterBlock* find(ParameterKind kind, std::size_t item = 0) const;
    std::vector<std::string> column_names() const;

    SceneState start() const;
    core::Vec3 vertex_world(const BodyState& state, std::size_t body, std::size_t vertex) const;
    FacetMotion motion(const SceneState& state, std::size_t facet) const;
    /// The geometry that a state describes: moved vertices, nodes and albedos.
    renderer::SceneGeometry posed(const SceneState& state) const;

 private:
    void add_to_body(const renderer::NodeGroup& node,
                     const renderer::Object& object,
                     std::size_t index);
    void add_block(ParameterKind kind, std::size_t item, std::vector<std::string> names);
    void free_bodies(const FreeSettings& free);
    void free_rest(const FreeSettings& free, bool scale_is_free);

    renderer::SceneGeometry geometry_;
    std::vector<ModelBody> bodies_;
    std::vector<ModelFacet> facets_;
    std::vector<ParameterBlock> blocks_;
    int num_columns_ = 0;
    int num_points_ = 0;
    bool ambient_is_free_ = false;
};

/// Whether two states show a body in different places, or nearly in the same but turned by so much
/// that it covers itself only because it is nearly symmetric.
bool are_different_poses(const SceneModel& model, const SceneState& a, const SceneState& b);

/// States in which one body with free rotation is turned so that it nearly covers itself: by
/// quarters and halves about its principal axes, which is where a solve of a nearly symmetric
/// body may end by mistake. Exact symmetries are left out.
///
/// max_distance   between vertices of body and turned body that still nearly meet, over the extent
/// returns         names, such as "target turned by 90 degrees", and states
std::vector<std::pair<std::string, SceneState>> symmetric_poses(const SceneModel& model,
                                                                const SceneState& state,
                                                                double max_distance);

}  // namespace calib
