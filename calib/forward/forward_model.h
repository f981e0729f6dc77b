// SPDX-License-Identifier: MIT
#pragma once

#include "calib/forward/knot_derivatives.h"
#include "calib/forward/model_elements.h"
#include "calib/model/scene_model.h"
#include "renderer/core/capture/capture.h"
#include "renderer/geometry/visibility_mask.h"
#include "renderer/triangle/triangle_histogram.h"

#include <optional>
#include <vector>

namespace calib {

/// How the model's light becomes data.
struct ForwardSettings {
    core::TimeAxis axis;
    int bins_per_ambient = 1;        ///< bins of the capture in one bin of the axis
    double sigma_m = 0.0;            ///< Gaussian response and blur together, in path length
    double response_fraction = 1.0;  ///< of sigma^2 that is the response's
    std::optional<core::InstrumentResponse> measured;  ///< instead of sigma_m: filtered
    double radiance_factor = 1.0;                      ///< Phi rho_w^2 / pi^3
    double spot_m2 = 1e-4;                             ///< returned by retroreflectors
    std::vector<double> offset_m;                      ///< per pair, added to path lengths
    double tolerance = 0.02;                           ///< of elements, relative L2
};

/// Expected data of one pair and its derivatives.
struct PairModel {
    std::vector<double> mean;       ///< [bin]
    std::vector<double> gradients;  ///< [bin][column], columns of SceneModel; empty unless wanted
};

/// Expected transients of a model and their derivatives by its free parameters.
///
/// refresh() cuts the surfaces into elements; update() moves them. Path lengths and weights at the
/// corners and edge midpoints of an element, with their gradients, go through the closed-form
/// kernel of renderer/triangle.
class ForwardModel {
 public:
    /// model   must outlive this
    /// scan    the pairs to model
    /// wall    how the points of the whole scan move
    ForwardModel(const SceneModel& model,
                 core::WallScan scan,
                 const WallMotion& wall,
                 ForwardSettings settings);

    /// Cuts the surfaces into elements again and traces which parts of them the wall points see.
    void refresh(const SceneState& state);
    /// Whether the last refresh() found another visibility than the one before it.
    bool visibility_changed() const { return visibility_changed_; }

    /// Whether the edge of a shadow fell on any element at the last refresh().
    bool has_shadow_edges() const;
    /// Adds to the gradients, until the next refresh(), how the data change because the edges of
    /// shadows move; otherwise gradients hold the visibility fixed.
    /// state   of the last refresh()
    void find_shadow_edges(const SceneState& state);

    /// Moves everything to a state; visibility and cuts stay.
    void update(const SceneState& state, renderer::Gradients gradients);
    /// Thread-safe between updates.
    void evaluate(std::size_t pair, PairModel& result) const;

    const core::WallScan& scan() const { return scan_; }
    const ForwardSettings& settings() const { return settings_; }
    std::size_t num_elements() const { return elements_.size(); }
    const std::vector<ModelElement>& elements() const { return elements_; }

 private:
    /// What wall points see: [wall point][element]; empty: everything.
    using Masks = std::vector<renderer::VisibilityMask>;

    /// An element where the state puts it.
    struct PosedElement {
        std::array<core::Vec3, 6> nodes;  ///< corners, then midpoints of edges 01, 12, 20
        core::Vec3 normal;
        double weight = 0.0;  ///< area and albedo and all constants
        bool is_retroreflective = false;
        const std::vector<int>* factor_columns = nullptr;
        std::vector<int> columns;
        std::vector<std::array<core::Vec3, 6>> node_gradients;  ///< per column
        std::vector<core::Vec3> normal_gradients;
        std::vector<double> log_area_gradients;
    };

    struct PointColumns {
        int position = 0;  ///< the first of three
        std::vector<int> factors;
    };
    /// Columns of the free parameters, by what they change beside the facets.
    struct Columns {
        explicit Columns(const SceneModel& model);

        std::vector<std::pair<int, std::size_t>> wall;  ///< and where a point's gradients stand
        std::vector<int> time_shifts;
        std::vector<int> widths;
        std::vector<int> scales;
        std::vector<std::vector<int>> bodies;  ///< factors of each one's light
        std::vector<PointColumns> points;
    };
    /// How a parameter changes the knots of an element.
    struct ColumnChange {
        int column;
        KnotDerivative change;
    };

    PosedElement pose(const ModelElement& element, const FacetMotion& motion) const;
    void add_element(const PosedElement& element,
                     renderer::VisibilityMask mask,
                     std::size_t pair,
                     PairModel& result) const;
    void add_point(std::size_t point, std::size_t pair, PairModel& result) const;
    void add_gradients(const renderer::TriangleBins& bins,
                       const std::vector<ColumnChange>& changes,
                       const std::vector<int>& factors,
                       PairModel& result) const;
    void add_response(const PairModel& fine, PairModel& result) const;
    void finish(PairModel& fine, PairModel& result) const;
    core::TimeAxis fine_axis() const;
    Masks trace(const SceneState& state) const;
    std::vector<double> vertex_speeds(const SceneState& state) const;
    /// How the data change, [pair][bin], as the wall points see other parts of the elements.
    std::vector<double> change_of_light(const Masks& from, const Masks& to) const;
    void add_shadow_edges(std::size_t pair, PairModel& result) const;
    /// Where the wall points of a pair stand in wall_points_.
    std::size_t light_index(std::size_t pair) const;
    std::size_t sensor_index(std::size_t pair) const { return scan_.sensing_index(pair); }
    renderer::VisibilityMask visible_part(const Masks& masks,
                                          std::size_t element,
                                          std::size_t pair) const;

    const SceneModel& model_;
    Columns columns_;
    core::WallScan scan_;
    ForwardSettings settings_;
    WallMotion wall_;
    SceneState state_;
    renderer::Gradients gradients_ = renderer::Gradients::Without;
    double time_shift_m_ = 0.0;
    double ambient_ = 0.0;               ///< per bin
    std::vector<double> body_factors_;   ///< of each one's light
    std::vector<double> point_factors_;  ///< likewise
    double sigma_m_ = 0.0;               ///< at the present width
    double width_fraction_ = 1.0;
    std::vector<ModelElement> elements_;
    std::vector<PosedElement> posed_;
    /// Sensing points, then illumination points unless the scan is confocal.
    core::WallPoints wall_points_;
    std::vector<MovedWallPoint> moved_points_;  ///< wall_points_ where the state puts them
    Masks masks_;
    bool visibility_changed_ = false;
    std::vector<double> edge_gradients_;  ///< [pair][bin][column]; or {}
    /// Weights of the data's bins for each position of a fine bin within its bin.
    std::vector<std::vector<double>> phase_weights_;
    int first_delay_ = 0;  ///< in fine bins
    int oversampling_ = 1;
    int margin_ = 0;  ///< fine bins before and behind the axis
};

}  // namespace calib
