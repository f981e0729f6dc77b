// SPDX-License-Identifier: MIT
#include "apps/commands/compare_job.h"

#include "apps/arguments.h"
#include "apps/commands/fit_pictures.h"
#include "apps/file_kind.h"
#include "apps/scene_truth.h"
#include "calib/fit_file.h"
#include "calib/track/compare_tracks.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "nlos/pictures/picture.h"
#include "nlos/pictures/pictures.h"
#include "renderer/core/mesh_formats/mesh_formats.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/output_file.h"
#include "renderer/scene/load_geometry.h"

#include <filesystem>

namespace apps {
namespace {

constexpr int kPictureColumns = 3;
constexpr std::size_t kSurfaceSamples = 100'000;
constexpr std::uint64_t kSurfaceSeed = 0;

core::PointCloud points_of_file(const std::string& path) {
    if (std::filesystem::path(path).extension() != ".ply") {
        return surface_samples(renderer::load_geometry(path));
    }
    const core::TriangleMesh mesh = core::read_mesh_file(path).mesh;
    if (mesh.triangles.empty()) return {mesh.vertices, mesh.normals};
    return core::sample_surface(mesh, kSurfaceSamples, kSurfaceSeed);
}

Comparison compare_volume_to_scene(const std::string& a,
                                   const std::string& b,
                                   std::optional<double> threshold_m) {
    const nlos::Reconstruction result = nlos::read_volume(a);
    const core::TrueSurface truth = SceneTruth(b).surface(result.volume.axes);
    Comparison comparison{nlos::compare_to_truth(result, truth, threshold_m),
                          {},
                          nlos::comparison_panels(result, truth)};
    if (auto text = nlos::coarse_truth_warning(truth)) {
        comparison.warnings.push_back(std::move(*text));
    }
    return comparison;
}

// `b` is a scene, or a fit with its scene beside it.
Comparison compare_fit_to_scene(const std::string& a, const std::string& b, double threshold_m) {
    const bool is_fit = kind_of_file(b) == FileKind::Fit;
    const renderer::SceneDescription scene =
        renderer::read_scene_description(is_fit ? with_suffix(b, ".scene.json") : b, {});
    const calib::FitResult fit = calib::read_fit(a);
    const calib::FitErrors errors =
        calib::compare_fit(fit,
                           renderer::load_geometry(with_suffix(a, ".glb")),
                           renderer::load_geometry(scene),
                           is_fit ? calib::read_fit(b).points : std::vector<calib::FittedPoint>());
    return {score_fit(fit, errors, threshold_m),
            {},
            overlay_panels(errors, scene.relay_wall.world_from_wall())};
}

nlos::Metrics compare_tracks(const std::string& a, const std::string& b) {
    calib::TrackScorer scorer;
    scorer.add(calib::read_track(a), calib::read_track(b), a);
    const calib::TrackScores scores = scorer.scores();
    nlos::Metrics metrics;
    metrics.track_rmse_m = scores.rmse_m;
    metrics.track_median_m = scores.median_m;
    metrics.track_coverage = scores.coverage;
    metrics.track_latency_s = scores.latency_s;
    metrics.track_false_alarms = scores.false_alarms;
    metrics.track_missed = scores.missed;
    return metrics;
}

bool is_surface(FileKind kind) {
    return kind == FileKind::Geometry || kind == FileKind::PointCloud;
}

Comparison compare_kinds(const std::string& a,
                         const std::string& b,
                         std::optional<double> threshold_m,
                         const nlos::CaptureReadSettings& settings) {
    const FileKind kind_a = kind_of_file(a);
    const FileKind kind_b = kind_of_file(b);
    const double between_points = threshold_m.value_or(kDefaultThreshold_m);
    if (kind_a == FileKind::Volume && kind_b == FileKind::Scene) {
        return compare_volume_to_scene(a, b, threshold_m);
    }
    if (kind_a == FileKind::Fit && (kind_b == FileKind::Scene || kind_b == FileKind::Fit)) {
        return compare_fit_to_scene(a, b, between_points);
    }
    if (is_surface(kind_a) && kind_b == FileKind::Scene) {
        return {nlos::compare_points(
                    points_of_file(a), SceneTruth(b).surface().samples, between_points),
                {}};
    }
    if (kind_a == FileKind::Volume && kind_b == FileKind::Volume) {
        return {nlos::compare_volumes(nlos::read_volume(a), nlos::read_volume(b), threshold_m), {}};
    }
    if (is_surface(kind_a) && is_surface(kind_b)) {
        return {nlos::compare_points(points_of_file(a), points_of_file(b), between_points), {}};
    }
    if (kind_a == FileKind::Capture && kind_b == FileKind::Capture) {
        const core::Capture result = nlos::read_capture(a, settings);
        const core::Capture reference = nlos::read_capture(b);
        return {nlos::compare_captures(result, reference),
                nlos::comparison_warnings(result, reference)};
    }
    if (kind_a == FileKind::Track && kind_b == FileKind::Track) {
        return {compare_tracks(a, b), {}};
    }
    throw core::Error(
        a,
        "cannot be compared with " + b,
        "must be a volume, mesh, point cloud or fit against a scene.json, or two files of "
        "one kind");
}

}  // namespace

core::PointCloud surface_samples(const renderer::SceneGeometry& geometry) {
    core::TriangleMesh mesh;
    for (const renderer::Object& object : geometry.objects) core::append_mesh(object.mesh, mesh);
    return core::sample_surface(mesh, kSurfaceSamples, kSurfaceSeed);
}

nlos::Metrics score_fit(const calib::FitResult& fit,
                        const calib::FitErrors& errors,
                        double threshold_m) {
    nlos::Metrics metrics;
    if (!errors.fitted_points.positions.empty()) {
        metrics = nlos::compare_points(errors.fitted_points, errors.true_points, threshold_m);
    }
    metrics.position_error_m = errors.position_m;
    metrics.rotation_error_deg = errors.rotation_deg;
    metrics.size_error = errors.size;
    metrics.albedo_error = errors.albedo;
    metrics.seconds = fit.seconds;
    return metrics;
}

Comparison compare_files(const std::string& a,
                         const std::string& b,
                         const std::string& metrics_path,
                         std::optional<double> fscore_threshold_m,
                         const nlos::CaptureReadSettings& settings,
                         const std::string& picture) {
    const std::string own_picture = metrics_path.empty() ? "" : with_suffix(metrics_path, ".png");
    require_suffix(metrics_path, {".json"});
    nlos::check_picture_suffix(picture);
    core::check_targets({metrics_path, own_picture, picture}, {a, b});
    Comparison comparison = compare_kinds(a, b, fscore_threshold_m, settings);
    if (!picture.empty() && comparison.panels.empty()) {
        throw core::Error("--picture",
                          "found two files whose scores have no picture",
                          "must come with a volume or a fit against a scene");
    }
    if (!metrics_path.empty()) {
        core::Json json = core::write_value(comparison.metrics);
        json["result"] = core::printable(a);
        json["reference"] = core::printable(b);
        if (!comparison.warnings.empty()) json["warnings"] = comparison.warnings;
        core::write_text_file(metrics_path, core::json_text(json));
    }
    for (const std::string& path : {own_picture, picture}) {
        if (path.empty() || comparison.panels.empty()) continue;
        nlos::write_panels(path, comparison.panels, kPictureColumns);
    }
    return comparison;
}

}  // namespace apps
