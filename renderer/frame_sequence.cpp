// SPDX-License-Identifier: MIT
#include "renderer/frame_sequence.h"

#include "renderer/core/capture/sensor_footprint.h"
#include "renderer/core/random.h"
#include "renderer/estimators.h"
#include "renderer/recentred.h"
#include "renderer/render.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace renderer {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

bool anything_moves(const Scene& scene) {
    return std::any_of(scene.objects().begin(), scene.objects().end(), [](const Object& object) {
        return object.velocity_m_per_s.norm() > 0.0;
    });
}

// The first frame is what a render without frames gives; the others are independent of it, and of
// the frames of other seeds.
std::uint64_t seed_of_frame(std::uint64_t seed, int frame) {
    if (frame == 0) return seed;
    return core::Rng(seed, 0, static_cast<std::uint64_t>(frame)).next_bits();
}

// What the sensor of a scan sees in a frame; other scans stay what they are.
core::Scan pose_sensor(const core::Scan& scan, int frame) {
    const auto* zones = scan.as<core::SensorScan>();
    if (zones == nullptr || zones->setup->poses.empty()) return scan;
    core::SensorSetup setup = *zones->setup;
    setup.pose = setup.pose_of_frame(static_cast<std::size_t>(frame));
    setup.poses.clear();
    return core::scan_of_zones(setup);
}

}  // namespace

FrameRenderer make_frame_renderer(const core::Scan& scan, const RenderSettings& settings) {
    const EstimatorTraits& method = traits_of(settings.method);
    core::require(
        !settings.target_error || method.has_independent_frames,
        "render.target_error",
        fmt::format("one for a sequence of frames by {}, whose errors follow from their past",
                    method.name),
        "null, or the method " + estimators_that(&EstimatorTraits::has_independent_frames));
    const auto make = method_of(settings.method).make_frame_renderer;
    if (make != nullptr) return make_recentred_frame_renderer(scan, settings, make);
    return [](const Frame& frame, const core::Scan& frame_scan, const core::Progress& progress) {
        const core::Scan posed = pose_sensor(frame_scan, frame.index);
        return render(*frame.scene, posed, frame.axes, frame.settings, progress);
    };
}

SceneGeometry moved_by(const Scene& scene, double seconds) {
    SceneGeometry geometry;
    geometry.objects = scene.objects();
    for (Object& object : geometry.objects) {
        const core::Vec3 way = seconds * object.velocity_m_per_s;
        for (core::Vec3& vertex : object.mesh.vertices) vertex += way;
        object.world_from_node.pretranslate(way);
    }
    return geometry;
}

RenderResult render_frames(std::shared_ptr<const Scene> scene,
                           const core::Scan& scan,
                           const SceneDescription& description,
                           const FrameRenderer& render_frame,
                           const core::Progress& progress) {
    const core::HistogramAxes first_axes{description.time_axis, description.velocity_axis};
    require_possible({*scene, scan, first_axes, description.render, progress});
    const FrameSettings& frames = *description.frames;
    const bool moves = frames.frame_s > 0.0 && anything_moves(*scene);
    RenderResult sequence;
    core::FrameSequence recorded{{}, frames.gate_step_m, frames.frame_s};
    for (int i = 0; i < frames.count && !sequence.interrupted; ++i) {
        Frame frame{i, scene, first_axes, description.render};
        if (moves && i > 0) {
            frame.scene = std::make_shared<const Scene>(
                moved_by(*scene, i * frames.frame_s), scan, description.relay_wall);
        }
        frame.axes.time.opl_start_m += i * frames.gate_step_m;
        frame.settings.seed = seed_of_frame(description.render.seed, i);
        const double count = frames.count;
        core::Progress part = progress.part(i / count, (i + 1) / count);
        if (i > 0) part.warn = nullptr;  // what holds for one frame holds for the next
        RenderResult rendered = render_frame(frame, scan, part);
        rendered.num_rays += sequence.num_rays;
        rendered.seconds += sequence.seconds;
        rendered.left_out = core::widest(rendered.left_out, sequence.left_out);
        sequence = std::move(rendered);
        recorded.frames.push_back(sequence.capture.transient);
        // Of nothing but noise the relative error is not known, either.
        const double error = sequence.estimated_error.value_or(kUnknown);
        recorded.errors.push_back(std::isfinite(error) ? error : kUnknown);
        if (i + 1 < frames.count && progress.should_stop()) sequence.interrupted = true;
    }
    const auto is_unknown = [](double error) { return std::isnan(error); };
    if (std::ranges::all_of(recorded.errors, is_unknown)) recorded.errors.clear();
    sequence.capture.sequence = std::move(recorded);
    if (const auto* zones = scan.as<core::SensorScan>()) {
        core::SensorScan last = *sequence.capture.scan.as<core::SensorScan>();
        last.setup = zones->setup;  // with the poses of all frames
        sequence.capture.scan = last;
        core::observe_live_zones(*zones->setup, sequence.capture);
    }
    return sequence;
}

}  // namespace renderer
