// SPDX-License-Identifier: MIT
#include "apps/bench/field/rendering_task.h"

#include "apps/bench/field/bin_agreement.h"
#include "apps/bench/field/one_sided_mesh.h"
#include "apps/bench/statistics.h"
#include "nlos/containers/array_reader.h"
#include "nlos/formats/capture_file.h"
#include "renderer/core/mesh_formats/ply_writer.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/scene/load_geometry.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace apps {
namespace {

constexpr std::size_t kBlock = 4;
constexpr double kLeastFraction = 0.02;  // of a block's light, for a cell of its own
constexpr int kRuns = 32;
// Rays that start 0.02 mm off the wall see what is 0.44 m away larger by twice their ratio: what
// hidden-geometry sampling may lose of all light, known no better than that.
constexpr double kRayOffsetLoss = 1e-4;

}  // namespace

std::string RenderedScene::name() const {
    return fmt::format("{}_order_{}", scene, max_bounces);
}

std::string RenderedScene::path() const {
    return "scenes/" + scene + "/scene.json";
}

std::vector<std::string> RenderedScene::overrides() const {
    const std::string bounces = fmt::format("render.max_bounces={}", max_bounces);
    if (is_image()) {
        return {"camera.light_spot_m=null", "camera.light_m=[0.2,0.3,-0.3]", bounces};
    }
    return {"scan.pattern=single", fmt::format("scan.sensing_points=[{0},{0}]", points), bounces};
}

RenderingTask::RenderingTask(Baselines& baselines, RenderedScene task)
    : baselines_(baselines), task_(std::move(task)), scene_(task_.path(), task_.overrides()) {
    stem_ = baselines_.folder() + "/" + task_.name();
    for (std::uint64_t seed = 0; seed < 2; ++seed) {
        renderer::RenderSettings settings = scene_.settings();
        settings.method = renderer::Estimator::Auto;
        settings.target_error = task_.reference_error;
        settings.by_order = !task_.is_image();  // else it leaves small orders out
        settings.seed = 1000 + seed;
        references_.push_back(scene_.render(settings).transient);
        if (task_.max_bounces == 3) break;  // deterministic
    }
}

RenderingRow RenderingTask::run_own(const std::string& method, double target_error) {
    const std::string output = fmt::format("{}_{}.h5", stem_, method);
    std::vector<std::string> arguments{"render",
                                       core::shipped_file(task_.path()),
                                       "-o",
                                       output,
                                       "--method",
                                       method,
                                       "--set",
                                       fmt::format("render.target_error={}", target_error)};
    for (const std::string& setting : task_.overrides()) arguments.push_back(setting);
    const FieldRun run = baselines_.run_own(task_.name() + " " + method, arguments);
    RenderingRow row = row_of("nlos", method, target_error, run);
    if (!row.reason.empty()) return row;
    const int samples = run.said.value("samples_per_pair", 0);
    if (samples > 0) set_samples(samples, row);
    score(nlos::read_capture(output).transient, row);
    return row;
}

RenderingRow RenderingTask::run_peer(const PeerSampling& sampling, int samples) {
    const auto [run, runs] = ask_peer(sampling, samples, {0});
    RenderingRow row = row_of("mitransient", sampling.name, {}, run);
    if (!row.reason.empty()) return row;
    const auto compile = run.said.find("compile_cpu_s");
    if (compile != run.said.end() && compile->is_number()) row.compile_cpu_s = *compile;
    set_samples(samples, row);
    score(runs.front(), row);
    return row;
}

core::Json RenderingTask::agree(const PeerSampling& sampling) {
    std::vector<int> seeds;
    for (int seed = 1; seed <= kRuns; ++seed) seeds.push_back(seed);
    const auto [run, runs] = ask_peer(sampling, 2 * sampling.few_samples, seeds);
    core::Json row{{"scene", task_.scene},
                   {"max_bounces", task_.max_bounces},
                   {"program", "mitransient"},
                   {"method", sampling.name},
                   {"runs", 0},  // independent seeds
                   {"energy_ratio", nullptr},
                   {"energy_z", nullptr},
                   {"cells", 0},
                   {"rms_z", nullptr},
                   {"worst_z", nullptr},
                   {"worst_by_chance", nullptr},
                   {"consistent", false},
                   {"reason", run.failure}};
    if (!run.failure.empty()) return row;
    const BinAgreement found =
        bin_agreement_of(mean_reference(), runs, grid(), kBlock, kLeastFraction, kRayOffsetLoss);
    row["runs"] = kRuns;
    row["energy_ratio"] = found.energy_ratio;
    row["energy_z"] = found.energy_z;
    row["cells"] = found.num_cells;
    row["rms_z"] = found.rms_z;
    row["worst_z"] = found.worst_z;
    return row;
}

RenderingRow RenderingTask::row_of(const std::string& program,
                                   const std::string& method,
                                   std::optional<double> target_error,
                                   const FieldRun& run) const {
    RenderingRow row{task_.scene, task_.max_bounces, program, method, {}, target_error};
    enter_run(run, row);
    return row;
}

core::Transient RenderingTask::mean_reference() const {
    core::Transient mean = references_.front();
    const auto other = references_.back().values();
    for (std::size_t i = 0; i < other.size(); ++i) {
        mean.values()[i] = 0.5F * (mean.values()[i] + other[i]);
    }
    return mean;
}

void RenderingTask::score(const core::Transient& found, RenderingRow& row) const {
    const ErrorSums sums = errors_of(found, references_.front(), references_.back());
    row.rel_l2 = std::sqrt(std::max(0.0, sums.rel_mse()));
    row.energy_ratio = sums.sum / sums.reference_sum;
}

RenderingTask::PeerRuns RenderingTask::ask_peer(const PeerSampling& sampling,
                                                int samples,
                                                const std::vector<int>& seeds) {
    core::Json request = scene_request();
    request["sampling"] = sampling.name;
    request["samples"] = samples;
    request["seeds"] = seeds;
    std::vector<std::string> outputs;
    for (const int seed : seeds)
        outputs.push_back(fmt::format("{}_{}_{}.h5", stem_, sampling.name, seed));
    request["outputs"] = outputs;
    PeerRuns result;
    auto& [run, transients] = result;
    run = baselines_.run_peer(task_.name() + " " + sampling.name,
                              task_.is_image() ? "mitransient_image" : "mitransient_render",
                              request);
    if (!run.failure.empty()) return result;
    try {
        for (const std::string& output : outputs) transients.push_back(read_histograms(output));
    } catch (const std::exception& error) {
        run.failure = error.what();
    }
    return result;
}

core::Transient RenderingTask::read_histograms(const std::string& path) const {
    const auto [nx, ny] = grid();
    const auto bins = static_cast<std::size_t>(scene_.axis().num_bins);
    const std::size_t pairs = nx * ny;
    const std::vector<float> values = nlos::ArrayReader(path).read_floats("H", {bins, nx, ny});
    core::Transient transient(pairs, scene_.axis().num_bins);
    for (std::size_t b = 0; b < bins; ++b) {
        for (std::size_t p = 0; p < pairs; ++p)
            transient.values()[p * bins + b] = values[b * pairs + p];
    }
    std::filesystem::remove(path);
    return transient;
}

std::array<std::size_t, 2> RenderingTask::grid() const {
    const std::vector<std::size_t> extents = scene_.scan().pair_extents();
    return {extents[0], extents[1]};
}

void RenderingTask::set_samples(int samples, RenderingRow& row) const {
    const auto [nx, ny] = grid();
    row.samples = samples;
    row.mpaths_per_s = 1e-6 * static_cast<double>(nx * ny) * samples / *row.cpu_s;
}

core::Json RenderingTask::scene_request() const {
    const core::RelayWall& wall = scene_.description().relay_wall;
    const core::Transform pose = wall.world_from_wall();
    core::Json meshes = core::Json::array();
    for (const renderer::Object& object : renderer::load_geometry(scene_.description()).objects) {
        if (object.role == renderer::Role::RelayWall) continue;
        const std::string file = fmt::format("{}_{}.ply", stem_, meshes.size());
        core::write_ply(
            file,
            task_.is_image() ? object.mesh : turned_to_wall(object.mesh, pose.linear().col(2)));
        meshes.push_back({{"file", file}, {"albedo", object.material.albedo}});
    }
    core::Json request{{"max_bounces", task_.max_bounces},
                       {"meshes", meshes},
                       {"opl_start_m", scene_.axis().opl_start_m},
                       {"bin_width_m", scene_.axis().bin_width_m},
                       {"num_bins", scene_.axis().num_bins}};
    const auto list = [](const core::Vec3& v) { return core::Json{v.x(), v.y(), v.z()}; };
    if (const auto* image = scene_.scan().as<core::ImageScan>()) {
        request["camera"] = core::write_value(image->camera);
        request["light_m"] = list(image->camera.light_position());
        return request;
    }
    request["relay_wall"] = {{"center_m", list(wall.center_m)},
                             {"x_axis", list(pose.linear().col(0))},
                             {"y_axis", list(pose.linear().col(1))},
                             {"normal", list(pose.linear().col(2))},
                             {"size_m", wall.size_m},
                             {"albedo", wall.albedo}};
    request["illumination_m"] = list(scene_.scan().wall().illumination.positions.front());
    request["sensing_points"] = grid();
    return request;
}

}  // namespace apps
