// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/settings/json_fwd.h"
#include "renderer/core/settings/settings.h"

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace calib {

enum class Owner;
struct Parameter;

/// What may move of one object of the model.
struct FreeObject {
    std::string name;                  ///< of the glTF node
    std::set<std::string> parameters;  ///< names of rows or of their groups, see parameter.h

    bool frees(const Parameter& row) const;
};

/// How residuals are formed: `auto` takes poisson for integer-valued data.
enum class ResidualKind { Auto, Poisson, LeastSquares };

/// Robust loss on whole wall points.
enum class LossKind { None, Huber, Cauchy };

/// The free quantities of MODEL.json.
struct FreeSettings {
    std::vector<FreeObject> objects;
    int point_scatterers = 0;
    std::set<std::string> parameters{"ambient"};  ///< names of rows of the scene as a whole
    std::map<std::string, double> prior_sigma;    ///< by row
};

/// MODEL.json: what is fitted, from where and how.
struct FitSettings {
    std::string scene;
    FreeSettings free;
    core::ResponseSettings response;
    std::string start = "given";
    std::vector<double> blur_schedule_m{0.12, 0.04, 0.0};
    ResidualKind residual = ResidualKind::Auto;
    LossKind loss = LossKind::None;
    double loss_scale = 1.5;
    double laplacian_weight = 1e-3;
    std::optional<double> element_tolerance;
    std::optional<std::array<double, 2>> window_m;
    std::optional<int> max_pairs;
    int search_rotations = 10;
    int max_iterations = 60;
};

/// Keys of `free` and names in its lists that belong to quantities of these owners.
std::vector<std::string> free_names(Owner owner);
/// What `free` may hold, in words.
const char* free_help();

void read_value(const core::Json& json, const std::string& where, FreeSettings& free);
core::Json write_value(const FreeSettings& free);
void read_value(const core::Json& json, const std::string& where, LossKind& loss);

template <class Visitor>
void for_each_field(FitSettings& s, Visitor&& visit) {
    visit("scene", s.scene, "scene.json whose geometry, wall and poses are the start");
    visit("free", s.free, free_help());
    visit("response", s.response, "instrument response of the data");
    visit("start", s.start, "given, search, or a VOLUME.h5");
    visit("blur_schedule_m", s.blur_schedule_m, "blur of the stages, in path length [m]");
    visit("residual", s.residual, "how data and model are compared");
    visit("loss", s.loss, "robust loss on whole wall points, or null");
    visit("loss_scale",
          s.loss_scale,
          core::above(0, "where the loss sets in, in median misfits of wall points"));
    visit("laplacian_weight",
          s.laplacian_weight,
          core::at_least(0, "cost of 1 mm of roughness of free vertices"));
    visit(
        "element_tolerance",
        s.element_tolerance,
        core::above(
            0, "relative L2 error of the model's elements; null: small against the data's noise"));
    visit("window_m", s.window_m, core::Ranged{"path lengths that count [m]; null: all", {}});
    visit("max_pairs",
          s.max_pairs,
          core::at_least(1, "pairs that are used, spread over the wall; null: all"));
    visit("search_rotations",
          s.search_rotations,
          core::at_least(1, "rotations that start: search tries"));
    visit("max_iterations", s.max_iterations, core::at_least(1, "of one stage"));
}

/// Throws core::Error naming the setting that is out of range.
void validate(const FitSettings& settings, const std::string& where);

/// Reads MODEL.json; `scene` becomes a path relative to the working folder.
FitSettings read_fit_settings(const std::string& path, const std::vector<std::string>& overrides);

}  // namespace calib

template <>
struct core::EnumNames<calib::ResidualKind> {
    static constexpr auto value =
        names_from_zero<calib::ResidualKind>("auto", "poisson", "least_squares");
};
template <>
struct core::EnumNames<calib::LossKind> {
    static constexpr auto value = names_from_zero<calib::LossKind>("none", "huber", "cauchy");
};
