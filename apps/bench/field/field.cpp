// SPDX-License-Identifier: MIT
#include "apps/bench/field/field.h"

#include "apps/bench/field/captures_table.h"
#include "apps/bench/field/field_plots.h"
#include "apps/bench/field/losses.h"
#include "apps/bench/field/reconstruction_table.h"
#include "apps/bench/field/rendering_table.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

namespace apps {
namespace {

/// What renderers mean by the same words.
struct Convention {
    std::string what;
    std::string ours;
    std::string mitransient;
};
NLOS_FIGURES(Convention, what, ours, mitransient);

std::vector<Convention> conventions() {
    return {
        {"unit",
         "W/(m^2 sr) leaving a wall point, for 1 W on the spot",
         "for the projector's irradiance on the spot, which the adapter divides by"},
        {"bin",
         "[start + i w, start + (i+1) w), each holding the light in it",
         "the same with both filters `box`"},
        {"path length",
         "from the spot to the wall point",
         "the same without `account_first_and_last_bounces`"},
        {"bounces",
         "spot and wall point included: 3 is one hidden surface",
         "`max_depth`, the laser's own on top of what is traced"},
        {"spot",
         "a point",
         "a point, by `nlos_laser_sampling`; the projector's width does not count"},
        {"wall point", "a point, the middle of a cell", "the same"},
        {"albedo", "diffuse, one number", "`reflectance`, the same"},
        {"sides",
         "every surface reflects on both",
         "on that which its normal points to; sheets are turned to the wall"},
        {"ray offset",
         "none that shortens a path",
         "rays start 9e-5 (1 + |p|) scene units off a surface; given in millimetres, paths are "
         "0.02 mm short"},
        {"hidden-geometry sampling",
         "",
         "counts a direction once for every surface it crosses: scored by the letter alone"},
    };
}

}  // namespace

BenchResult measure_field(const FieldSettings& settings,
                          const std::string& folder,
                          const core::Progress& progress) {
    const auto wants = [&](const std::string& part) {
        return settings.part == "all" || settings.part == part;
    };
    if (!settings.captures.empty())
        read_known_captures(settings.captures);  // before an hour has passed
    std::filesystem::create_directories(folder);
    Contenders contenders(settings.peers, folder, settings.limit_s);
    BenchResult result{core::Json::object()};
    std::vector<Loss> losses;
    if (wants("reconstruct")) {
        ReconstructionTable table = measure_reconstructions(
            contenders, settings.sensing_points, settings.quick, progress.part(0.0, 0.5));
        const std::vector<ReconstructionSummary> summaries = summarise(table.rows);
        result.figures["reconstruction"] = core::write_value(summaries);
        losses = find_losses(summaries);
        result.figures["reconstruction_runs"] = core::write_value(table.rows);
        result.pictures.merge(table.pictures);
        result.plots.merge(reconstruction_plots(summaries));
    }
    if (wants("render")) {
        const RenderingTable table = measure_renderings(
            contenders, settings.sensing_points, settings.quick, progress.part(0.5, 0.9));
        result.figures["rendering"] = core::write_value(table.summaries);
        std::ranges::move(find_losses(table.summaries), std::back_inserter(losses));
        result.figures["rendering_runs"] = core::write_value(table.rows);
        result.figures["bin_agreement"] = core::write_value(table.agreement);
        result.figures["conventions"] = core::write_value(conventions());
        result.plots.merge(rendering_plots(table.rows));
    }
    result.figures["losses"] = core::write_value(losses);
    if (wants("captures") && !settings.captures.empty()) {
        CapturesTable table =
            measure_captures(contenders, settings.captures, progress.part(0.9, 1.0));
        result.figures["captures"] = core::write_value(table.rows);
        result.pictures.merge(table.pictures);
    }
    if (!contenders.versions().empty()) {
        result.figures["peers"] = fmt::format("{}", fmt::join(contenders.versions(), ", "));
    }
    return result;
}

}  // namespace apps
