// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/parameter.h"
#include "renderer/material/scene_geometry.h"
#include "renderer/scene/coincident_faces.h"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace calib {

/// Free numbers that belong together: a range of columns of the Jacobian.
struct ParameterBlock {
    const Parameter* row;
    std::size_t item = 0;  ///< which body or point
    int first_column = 0;
    int columns = 1;  ///< rotations turn by a vector in the world frame [rad]
    std::vector<std::string> names;
};

/// The model's surfaces as functions of the free parameters.
class SceneModel {
 public:
    /// throws   core::Error for names that the geometry lacks and materials that cannot be fitted
    SceneModel(const renderer::SceneGeometry& geometry, const FitSettings& settings);

    const std::vector<ModelBody>& bodies() const { return bodies_; }
    const std::vector<ModelFacet>& facets() const { return facets_; }
    const std::vector<ParameterBlock>& blocks() const { return blocks_; }
    int num_columns() const { return num_columns_; }
    std::size_t num_points() const { return num_points_; }
    /// The block of a row and item, or nothing when it is fixed.
    const ParameterBlock* find(const Parameter& row, std::size_t item = 0) const;
    /// The free blocks that enter as `effect` for one owner.
    std::vector<const ParameterBlock*> find(Owner owner, std::size_t item, Effect effect) const;
    bool is_free(Owner owner, std::size_t item, Effect effect) const {
        return !find(owner, item, effect).empty();
    }
    std::vector<std::string> column_names() const;

    SceneState start() const;
    FacetMotion motion(const SceneState& state, std::size_t facet) const;
    std::optional<LinearPrior> prior_of(const ParameterBlock& block,
                                        const PriorSettings& settings) const;
    /// The geometry that a state describes: moved vertices, nodes and albedos.
    renderer::SceneGeometry posed(const SceneState& state) const;

 private:
    void add_to_body(const renderer::NodeGroup& node,
                     const renderer::Object& object,
                     std::size_t index);
    void free_by_name(const FreeObject& wanted);
    /// Adds the blocks of an owner's rows that are free.
    void add_blocks(Owner owner, std::size_t item, const FreeSettings& free);

    renderer::SceneGeometry geometry_;
    std::vector<ModelBody> bodies_;
    std::vector<ModelFacet> facets_;
    std::vector<ParameterBlock> blocks_;
    int num_columns_ = 0;
    std::size_t num_points_ = 0;
};

/// Which faces of a model count where several lie at one place: those of bodies that are freed,
/// then of the others. Bodies that may move are apart from all others.
renderer::FacePrecedence face_precedence(std::span<const renderer::Object> objects,
                                         const FreeSettings& free);

/// Whether two states show a body in different places, or nearly in the same but turned by so much
/// that it covers itself only because it is nearly symmetric.
bool are_different_poses(const SceneModel& model, const SceneState& a, const SceneState& b);

/// States in which one body with free rotation is turned so that it nearly covers itself: by
/// quarters and halves about its principal axes, which is where a solve of a nearly symmetric
/// body may end by mistake. Exact symmetries are left out.
///
/// max_distance   between vertices of body and turned body that still nearly meet, over the extent
/// returns         names, such as "target turned by 90 degrees", and reports
std::vector<std::pair<std::string, SceneState>> symmetric_poses(const SceneModel& model,
                                                                const SceneState& state,
                                                                double max_distance);

}  // namespace calib
