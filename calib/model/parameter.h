// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/fitted_values.h"
#include "calib/model/model_body.h"
#include "calib/model/wall_motion.h"

#include <Eigen/Dense>

#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

// What a fit can free. Each quantity is a row of facts and functions in a file of its own in
// parameters/; parameters/parameters.cpp lists them all. Nothing else names one: states, settings,
// Jacobian, priors, checks and FIT.json follow from the rows.
namespace calib {

/// What there is one quantity of.
enum class Owner { Body, Point, Scene };

/// How a quantity enters the model, which is all that the forward model knows of it.
enum class Effect {
    Translates,  ///< a body or a point
    Rotates,     ///< a body, by a quaternion; its columns are turns about the world's axes [rad]
    Scales,      ///< a body about its origin
    Deforms,     ///< a body
    MovesWall,   ///< wall points
    ShiftsTime,  ///< is added to all path lengths [m]
    WidensResponse,  ///< logarithm of a factor of the response's width
    Multiplies,      ///< logarithm of a factor of its owner's light
    AddsLight        ///< logarithm of light in every bin
};

/// Of a block's numbers p: rows p / sigma is normal.
struct LinearPrior {
    Eigen::MatrixXd rows;
    double sigma = 1.0;
};

/// What priors weigh.
struct PriorSettings {
    double laplacian_weight = 0.0;
    std::map<std::string, double> sigma;  ///< by the name of the parameter
};

/// A body where a state puts it, and one of its facets, which moves in columns from `column` on.
struct BodyPosition {
    const ModelBody& body;
    const BodyState& state;
};
struct FacetPosition : BodyPosition {
    const ModelFacet& facet;
    int column;
};

/// How a score test of a fixed quantity is put into words: name, and unit of its steps.
struct MisfitWords {
    const char* name = nullptr;  ///< none: it is not tested
    double unit = 1.0;
    const char* unit_name = "";
};

/// One quantity that a fit can free: facts first, then functions, empty where the facts say it all.
struct Parameter {
    const char* name;  ///< in `free` of MODEL.json; "wall.bow" is bow in the list wall
    Owner owner;
    Effect effect;
    const char* group = nullptr;  ///< another name in `free`, shared with other rows
    bool is_setting = true;       ///< whether `free` takes it; else the fit decides
    bool is_logarithm = false;    ///< of what results hold
    double start = 0.0;           ///< number of one that is free
    double fixed = 0.0;           ///< number of one that is not
    const char* key = nullptr;    ///< in FIT.json; "wall.bow_m" is bow_m of the object wall
    const char* prior = nullptr;  ///< key of its standard deviation in `free`; none: no prior
    double highest = std::numeric_limits<double>::infinity();  ///< value above which a fit warns
    MisfitWords misfit{};
    std::vector<std::string> columns{};  ///< names behind the owner's; empty: `name`

    /// Names of columns that depend on the body, in place of `columns`.
    std::vector<std::string> (*body_columns)(const ModelBody& body) = nullptr;
    /// Where a state keeps its numbers, which lie side by side: its owner's `numbers` if empty.
    std::span<double> (*storage)(SceneState& state, std::size_t item) = nullptr;
    /// The start of a body's numbers, in place of `start` and `fixed`.
    void (*start_body)(const ModelBody& body, bool is_free, BodyState& state) = nullptr;
    /// Adds the derivatives of a facet's corners.
    void (*move_facet)(const FacetPosition& at, FacetMotion& motion) = nullptr;
    /// Moves a wall point and adds the derivative to it.
    void (*move_wall)(double number, const WallPosition& at, MovedWallPoint& point) = nullptr;
    /// A prior that depends on the body.
    std::optional<LinearPrior> (*body_prior)(const ModelBody& body,
                                             const PriorSettings& settings) = nullptr;
    /// Why it cannot be free with this response: what was found, what is allowed; or nothing.
    std::optional<std::pair<const char*, const char*>> (*refusal)(
        const core::ResponseSettings& response) = nullptr;
    /// What results hold of a number 1, or of a logarithm 0; 1 if empty.
    double (*unit)(const FitSettings& settings) = nullptr;
    /// Writes itself, with standard deviations per column, in place of `key`.
    void (*report_body)(const BodyPosition& at,
                        std::span<const double> sigma,
                        FittedObject& object) = nullptr;

    std::span<double> numbers(SceneState& state, std::size_t item = 0) const;
    std::span<const double> numbers(const SceneState& state, std::size_t item = 0) const;
    /// Of its number with a standard deviation, as results hold it.
    Estimate estimate(double number, double sigma, const FitSettings& settings) const;
};

/// All rows, in the order of their columns.
const std::vector<const Parameter*>& parameters();

/// The sum of the numbers that enter as `effect` for one owner.
double sum_of(const SceneState& state, Owner owner, std::size_t item, Effect effect);

/// Light that every bin gets beside the model's: the sum over Effect::AddsLight.
double added_light(const SceneState& state);
/// The state without it.
SceneState without_added_light(SceneState state);

}  // namespace calib
