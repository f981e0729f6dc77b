// SPDX-License-Identifier: MIT
#include "renderer/sensor_render.h"

#include "renderer/core/capture/sensor_footprint.h"
#include "renderer/core/random.h"
#include "renderer/estimators.h"
#include "renderer/pass_render.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::SensorFootprints;
using core::Vec3;
using core::ZoneFootprint;

// Histograms of pairs that are held at a time.
constexpr std::size_t kMostValues = std::size_t{1} << 26;

// Lit points stand this far from those that are seen: pairs that coincide return the light of
// retroreflectors, which is weighed apart.
constexpr double kHair_m = 1e-9;

// The direct return is sampled this finely per zone and axis.
constexpr int kDirectSubsamples = 32;

/// Pairs of points, and how they make up the histograms of zones.
struct PairSum {
    core::WallScan scan;
    std::vector<double> lit;         ///< weights of illumination points
    std::vector<double> seen;        ///< weights of sensing points
    std::vector<std::size_t> zones;  ///< of the sensing points
};

PairSum empty_sum(const core::WallScan& zones, core::ScanPattern pattern) {
    PairSum sum;
    sum.scan.pattern = pattern;
    sum.scan.opl_origin = core::OplOrigin::Device;
    sum.scan.laser_position = zones.laser_position;
    sum.scan.detector_position = zones.detector_position;
    return sum;
}

void append(const core::PatchPoints& points, const Vec3& normal, core::WallPoints& wall) {
    wall.positions.insert(wall.positions.end(), points.positions.begin(), points.positions.end());
    wall.normals.resize(wall.positions.size(), normal);
}

void append_lit(const SensorFootprints& footprints, std::size_t zone, PairSum& sum) {
    const core::PatchPoints& lit = footprints.zones[zone].lit;
    append(lit, footprints.normal, sum.scan.illumination);
    sum.lit.insert(sum.lit.end(), lit.weights.begin(), lit.weights.end());
}

void append_seen(const SensorFootprints& footprints, std::size_t zone, PairSum& sum) {
    const core::PatchPoints& seen = footprints.zones[zone].seen;
    append(seen, footprints.normal, sum.scan.sensing);
    sum.seen.insert(sum.seen.end(), seen.weights.begin(), seen.weights.end());
    sum.zones.resize(sum.seen.size(), zone);
}

/// Cuts the lit points into slices whose histograms can be held.
void append_slices(const PairSum& sum, int num_bins, std::vector<PairSum>& slices) {
    if (sum.seen.empty()) return;
    const std::size_t at_once = std::max<std::size_t>(
        1, kMostValues / (sum.seen.size() * static_cast<std::size_t>(num_bins)));
    for (std::size_t begin = 0; begin < sum.lit.size(); begin += at_once) {
        const std::size_t end = std::min(begin + at_once, sum.lit.size());
        const auto cut = [&](auto& values) {
            values = {values.begin() + static_cast<std::ptrdiff_t>(begin),
                      values.begin() + static_cast<std::ptrdiff_t>(end)};
        };
        PairSum& slice = slices.emplace_back(sum);
        cut(slice.lit);
        cut(slice.scan.illumination.positions);
        cut(slice.scan.illumination.normals);
    }
}

/// What zones record of lit points and other points that they see.
std::vector<PairSum> pairs_apart(const core::SensorScan& scan,
                                 const SensorFootprints& footprints,
                                 int num_bins) {
    const core::SensorSetup& setup = *scan.setup;
    const Vec3 hair = kHair_m * setup.wall.world_from_wall().linear().col(0);
    const bool floods = setup.model.illumination == core::SensorIllumination::Flood;
    std::vector<PairSum> sums;
    for (std::size_t zone = 0; zone < footprints.zones.size(); ++zone) {
        if (sums.empty() || !floods) {
            sums.push_back(empty_sum(scan, core::ScanPattern::Exhaustive));
        }
        append_lit(footprints, zone, sums.back());
        append_seen(footprints, zone, sums.back());
    }
    std::vector<PairSum> slices;
    for (PairSum& sum : sums) {
        for (Vec3& point : sum.scan.illumination.positions) point += hair;
        append_slices(sum, num_bins, slices);
    }
    return slices;
}

/// What comes back to the points themselves.
PairSum pairs_that_coincide(const core::SensorScan& scan, const SensorFootprints& footprints) {
    PairSum sum = empty_sum(scan, core::ScanPattern::Confocal);
    for (std::size_t zone = 0; zone < footprints.zones.size(); ++zone) {
        append_seen(footprints, zone, sum);
        const auto& irradiance = footprints.zones[zone].seen_irradiance;
        sum.lit.insert(sum.lit.end(), irradiance.begin(), irradiance.end());
    }
    sum.scan.illumination = sum.scan.sensing;
    return sum;
}

/// The scene with all that does not send light back black; nothing when nothing sends it back.
std::optional<Scene> retroreflectors_of(const Scene& scene, const core::SensorScan& scan) {
    SceneGeometry geometry;
    geometry.objects = scene.objects();
    bool any = false;
    for (Object& object : geometry.objects) {
        if (object.role == Role::RelayWall) continue;
        if (traits_of(object.material.model).returns_to_source) {
            any = any || object.material.albedo > 0.0;
        } else {
            object.material = {};
            object.material.albedo = 0.0;
        }
    }
    if (!any) return std::nullopt;
    return Scene(std::move(geometry), scan, scan.setup->wall);
}

/// Renders sums of pairs by an estimator, one after another, and adds up what the zones record.
class ZoneRenderer {
 public:
    /// num_parts   sums of pairs that will be added
    ZoneRenderer(const RenderTask& task, std::size_t num_parts)
        : task_(task), settings_(task.settings), num_parts_(static_cast<double>(num_parts)) {
        if (settings_.seconds) *settings_.seconds /= num_parts_;
        settings_.direct_return = false;
        result_.capture = empty_capture(task.scan, task.axes, settings_);
    }

    void add_pairs(const Scene& scene, const PairSum& sum) { add_pairs(scene, sum, settings_); }
    void add_retroreflectors(const Scene& scene, const PairSum& sum);
    void add_direct_return(core::SensorSetup setup);
    RenderResult result() { return std::move(result_); }

 private:
    void add_pairs(const Scene& scene, const PairSum& sum, RenderSettings settings);
    void add(const RenderResult& part, const PairSum& sum);

    const RenderTask& task_;
    RenderSettings settings_;
    RenderResult result_;
    double num_parts_;
    std::uint64_t done_ = 0;  ///< parts
    bool is_error_known_ = true;
};

void fold(const core::Transient& points, const PairSum& sum, int power, core::Transient& zones) {
    const std::size_t num_bins = points.num_bins();
    std::vector<double> folded(zones.values().size());
    for (std::size_t pair = 0; pair < sum.scan.num_pairs(); ++pair) {
        const std::size_t s = sum.scan.sensing_index(pair);
        const double weight =
            std::pow(sum.lit[sum.scan.illumination_index(pair)] * sum.seen[s], power);
        const auto from = points.histogram(pair);
        for (std::size_t bin = 0; bin < num_bins; ++bin) {
            folded[sum.zones[s] * num_bins + bin] += weight * static_cast<double>(from[bin]);
        }
    }
    for (std::size_t i = 0; i < folded.size(); ++i) {
        zones.values()[i] += static_cast<float>(folded[i]);
    }
}

void ZoneRenderer::add(const RenderResult& part, const PairSum& sum) {
    core::Capture& capture = result_.capture;
    fold(part.capture.transient, sum, 1, capture.transient);
    for (std::size_t i = 0; i < part.capture.by_order.size(); ++i) {
        fold(part.capture.by_order[i], sum, 1, capture.by_order[i]);
    }
    if (part.capture.variance) {
        if (!capture.variance) {
            capture.variance.emplace(capture.transient.num_pairs(), capture.time_axis.num_bins);
        }
        fold(*part.capture.variance, sum, 2, *capture.variance);
    }
    if (!part.capture.transient.is_dark()) {
        is_error_known_ = is_error_known_ && part.estimated_error.has_value();
        result_.estimated_error =
            std::max(result_.estimated_error.value_or(0.0), part.estimated_error.value_or(0.0));
    }
    if (!is_error_known_) result_.estimated_error.reset();
    if (result_.sources.empty()) result_.sources = part.sources;
    if (part.element_tolerance) result_.element_tolerance = part.element_tolerance;
    result_.left_out = core::widest(result_.left_out, part.left_out);
    result_.excluded = part.excluded;
    result_.samples_per_pair = std::max(result_.samples_per_pair, part.samples_per_pair);
    result_.num_rays += part.num_rays;
    result_.seconds += part.seconds;
    result_.interrupted = result_.interrupted || part.interrupted;
}

void ZoneRenderer::add_pairs(const Scene& scene, const PairSum& sum, RenderSettings settings) {
    const auto done = static_cast<double>(done_);
    const core::Progress progress =
        task_.progress.part(done / num_parts_, (done + 1.0) / num_parts_);
    // Independent of the other parts.
    if (done_ > 0) settings.seed = core::Rng(settings.seed, 1, done_).next_bits();
    ++done_;
    const core::Scan scan = sum.scan;
    add(method_of(settings.method).run({scene, scan, task_.axes, settings, progress}), sum);
}

void ZoneRenderer::add_retroreflectors(const Scene& scene, const PairSum& sum) {
    RenderSettings settings = settings_;
    settings.max_bounces = std::min(3, settings.max_bounces);
    settings.laser_spot_m2 = 1.0;
    add_pairs(scene, sum, settings);
}

void ZoneRenderer::add_direct_return(core::SensorSetup setup) {
    core::Capture& capture = result_.capture;
    setup.subsamples = kDirectSubsamples;
    const SensorFootprints footprints = core::make_footprints(setup);
    for (std::size_t i = 0; i < footprints.zones.size(); ++i) {
        const ZoneFootprint& zone = footprints.zones[i];
        std::vector<double> histogram(capture.transient.num_bins());
        for (std::size_t k = 0; k < zone.seen.size(); ++k) {
            const double opl =
                (zone.seen.positions[k] - footprints.laser_m).norm() + zone.seen.device_m[k];
            const auto bin = capture.time_axis.bin_of(opl);
            if (!bin) continue;
            histogram[static_cast<std::size_t>(*bin)] += zone.seen.weights[k] *
                                                         zone.seen_irradiance[k] *
                                                         task_.scene.wall_albedo() / core::kPi;
        }
        for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
            const auto value = static_cast<float>(histogram[bin]);
            capture.transient.histogram(i)[bin] += value;
            if (!capture.by_order.empty()) capture.by_order[0].histogram(i)[bin] += value;
        }
    }
}

}  // namespace

RenderResult render_zones(const RenderTask& task, const core::SensorScan& scan) {
    const SensorFootprints footprints = core::make_footprints(*scan.setup);
    const std::vector<PairSum> sums = pairs_apart(scan, footprints, task.axes.time.num_bins);
    const std::optional<Scene> retroreflectors = retroreflectors_of(task.scene, scan);
    ZoneRenderer renderer(task, sums.size() + (retroreflectors ? 1 : 0));
    for (const PairSum& sum : sums) renderer.add_pairs(task.scene, sum);
    if (retroreflectors && task.settings.max_bounces >= 3) {
        renderer.add_retroreflectors(*retroreflectors, pairs_that_coincide(scan, footprints));
    }
    if (task.settings.direct_return) renderer.add_direct_return(*scan.setup);
    RenderResult result = renderer.result();
    core::observe_live_zones(*scan.setup, result.capture);
    return result;
}

}  // namespace renderer
