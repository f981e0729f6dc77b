// SPDX-License-Identifier: MIT
#include "apps/commands/render_job.h"
#include "apps/sweep/sweep.h"
#include "nlos/compare/compare.h"
#include "nlos/reconstruct.h"
#include "renderer/core/error.h"
#include "renderer/core/stopwatch.h"
#include "renderer/scene/load_geometry.h"

#include <memory>
#include <new>
#include <utility>

namespace apps {
namespace {

constexpr double kRenderFraction = 0.5;  // of a run, for the bar

/// Collects warnings in place of showing them, and announces nothing.
core::Progress collecting(const core::Progress& progress, std::vector<std::string>& warnings) {
    core::Progress quiet = progress;
    quiet.announce = {};
    quiet.warn = [&warnings](const std::string& text) { warnings.push_back(text); };
    return quiet;
}

void append(const std::vector<std::string>& from, std::vector<std::string>& to) {
    to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

std::optional<SweepResult> SweepRunner::do_run(const SweepRun& run,
                                               const core::Progress& progress) {
    SweepResult result;
    try {
        if (!rendered_ || rendered_->changes != run.scene_changes) {
            render(run, progress.part(0.0, kRenderFraction));
        }
        if (progress.should_stop()) return std::nullopt;
        draw_noise(run);
        result = score(run, progress.part(kRenderFraction, 1.0));
    } catch (const core::Error& error) {
        result.failed = error.what();
    } catch (const core::Failure& failure) {
        result.failed = failure.what();
    } catch (const std::bad_alloc&) {
        result.failed = "not enough memory";
    }
    // What stops early has no result, or none that a later run would find again.
    if (progress.should_stop()) return std::nullopt;
    return result;
}

void SweepRunner::render(const SweepRun& run, const core::Progress& progress) {
    rendered_.reset();
    noisy_.reset();
    truth_.reset();
    renderer::SceneGeometry geometry = renderer::load_geometry(run.scene);
    RenderInput input;
    input.scene_name = renderer::geometry_name(run.scene);
    input.description = run.scene;
    input.scan = renderer::make_scan(run.scene);
    input.scene = std::make_shared<const renderer::Scene>(
        renderer::make_scene(geometry, run.scene, input.scan));
    Recorded recorded{run.scene_changes, {}};
    renderer::RenderResult result =
        render_input(std::move(input), collecting(progress, recorded.warnings));
    if (result.interrupted) return;
    recorded.capture = std::move(result.capture);
    recorded.seconds = result.seconds;
    recorded.estimated_error = result.estimated_error;
    truth_.emplace(run.scene, std::move(geometry));
    rendered_ = std::move(recorded);
}

void SweepRunner::draw_noise(const SweepRun& run) {
    if (!run.noise || (noisy_ && noisy_->changes == run.noise_changes)) return;
    noisy_.reset();
    const core::Stopwatch watch;
    Recorded noisy{run.noise_changes, {}};
    if (const auto warning = nlos::coarse_bins_warning(rendered_->capture, *run.noise)) {
        noisy.warnings.push_back(*warning);
    }
    noisy.capture = nlos::detect(rendered_->capture, *run.noise);
    noisy.seconds = watch.seconds();
    noisy_ = std::move(noisy);
}

SweepResult SweepRunner::score(const SweepRun& run, const core::Progress& progress) {
    SweepResult result;
    result.seconds_render = rendered_->seconds;
    result.estimated_error = rendered_->estimated_error;
    result.warnings = rendered_->warnings;
    if (run.noise) {
        result.seconds_noise = noisy_->seconds;
        append(noisy_->warnings, result.warnings);
    }
    const nlos::Reconstruction found =
        nlos::reconstruct(run.noise ? noisy_->capture : rendered_->capture,
                          run.reconstruct,
                          collecting(progress, result.warnings));
    append(found.warnings, result.warnings);
    result.seconds_reconstruct = found.seconds;
    result.method = found.method;
    const core::TrueSurface truth = truth_->surface(found.volume.axes);
    if (const auto warning = nlos::coarse_truth_warning(truth)) result.warnings.push_back(*warning);
    result.metrics = nlos::compare_to_truth(found, truth);
    return result;
}

}  // namespace apps
