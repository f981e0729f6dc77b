// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/third_bounce_scan.h"

#include "renderer/core/system/parallel.h"
#include "renderer/scene/coinciding_points.h"
#include "renderer/third_bounce/third_bounce_pairs.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

namespace renderer {
namespace {

using core::Vec3;

constexpr std::size_t kPointsPerBlock = PairTiles::kPointsTogether;
static_assert(kPointsPerBlock == WallPointLanes::kSize);

// Where part `part` of a confocal scan's points begins. Parts hold whole blocks, and at least a few
// for threads to share, so that the last parts of small scans are empty.
std::size_t begin_of_part(int part, std::size_t num_points) {
    constexpr std::size_t kMinBlocks = 4;
    const std::size_t num_blocks = (num_points + kPointsPerBlock - 1) / kPointsPerBlock;
    const std::size_t per_part =
        (num_blocks + ThirdBounceScan::kParts - 1) / ThirdBounceScan::kParts;
    const std::size_t block = static_cast<std::size_t>(part) * std::max(kMinBlocks, per_part);
    return std::min(block * kPointsPerBlock, num_points);
}

// True when no path of the two points through the block has a length within the axis.
bool misses_axis(const BlockSphere& sphere,
                 const WallPoint& light,
                 const WallPoint& sensor,
                 const core::TimeAxis& axis) {
    const double middle =
        (sphere.center - light.position).norm() + (sphere.center - sensor.position).norm();
    const double reach = 2.0 * sphere.radius_m;
    return middle + reach < axis.opl_start_m || middle - reach > axis.opl_end_m();
}

// Whether both ends see elements of a block that reflect from one to the other.
bool connects(const ElementBlock& block, const PairEnd& light, const PairEnd& sensor) {
    if ((light.table->simd_groups & sensor.table->simd_groups) == 0) return false;
    return !block.response.towards_source || coincide(*light.point, *sensor.point);
}

}  // namespace

ThirdBounceScan::ThirdBounceScan(const Scene& scene,
                                 const core::WallScan& scan,
                                 const core::TimeAxis& axis,
                                 const ScanRules& rules)
    : scene_(scene),
      scan_(scan),
      axis_(axis),
      rules_(rules),
      lights_{scan.illumination,
              CoincidingPoints(scan).illumination,
              std::vector<double>(scan.illumination.size())},
      sensors_{
          scan.sensing, CoincidingPoints(scan).sensing, std::vector<double>(scan.sensing.size())} {
    if (rules.check_rays > 0) differences_.resize(scan.num_pairs());
}

double ThirdBounceScan::squared_shadow_error() const {
    const auto sum = [](const std::vector<double>& values) {
        return std::accumulate(values.begin(), values.end(), 0.0);
    };
    return squared_shadow_error_of_others_ + sum(sensors_.squared_errors) +
           sum(lights_.squared_errors);
}

SquaredError ThirdBounceScan::squared_visibility_error() const {
    SquaredError sum;
    for (const VisibilityDifferences& of_pair : differences_) sum += squared_error_of(of_pair);
    return sum;
}

int ThirdBounceScan::integrate(const ElementSet& batch,
                               core::Transient& result,
                               int first_part,
                               const std::function<bool(double fraction)>& go_on) {
    squared_shadow_error_of_others_ = squared_shadow_error();
    for (Side* const side : {&lights_, &sensors_}) {
        std::ranges::fill(side->squared_errors, 0.0);
        side->range = {};
        side->seen.clear();
    }
    elements_ = &batch;
    result_ = &result;
    if (scan_.pattern != core::ScanPattern::Confocal) return integrate_pairs(first_part, go_on);
    for (int part = first_part; part < kParts; ++part) {
        const std::size_t begin = begin_of_part(part, scan_.num_pairs());
        const std::size_t end = begin_of_part(part + 1, scan_.num_pairs());
        core::parallel_blocks(
            end - begin, kPointsPerBlock, [&](std::size_t first, std::size_t last) {
                integrate_confocal(begin + first, begin + last);
            });
        const bool goes_on =
            go_on(static_cast<double>(end) / static_cast<double>(scan_.num_pairs()));
        if (end == scan_.num_pairs()) break;
        if (!goes_on) return part + 1;
    }
    return kParts;
}

WallPoint ThirdBounceScan::Side::wall_point(std::size_t index, const Vec3& origin) const {
    return {points.positions[index] - origin,
            points.normals[index],
            static_cast<std::uint32_t>(index),
            is_confocal[index]};
}

std::vector<WallPoint> ThirdBounceScan::Side::wall_points(const PointRange& of,
                                                          const Vec3& origin) const {
    std::vector<WallPoint> result;
    for (std::size_t i = of.begin; i < of.end; ++i) result.push_back(wall_point(i, origin));
    return result;
}

core::TimeAxis ThirdBounceScan::axis_of_pair(std::size_t pair) const {
    core::TimeAxis axis = axis_;
    axis.opl_start_m -= scan_.device_segments_m(pair);
    return axis;
}

void ThirdBounceScan::check(VisibilityCheck& check,
                            std::size_t pair,
                            const VisibilityCheck::End& light,
                            const VisibilityCheck::End& sensor) {
    if (rules_.check_rays == 0) return;
    const double num_rays = elements_->fraction * static_cast<double>(rules_.check_rays);
    check.add_differences(
        light,
        sensor,
        axis_of_pair(pair),
        std::max<std::size_t>(1, static_cast<std::size_t>(num_rays)),
        core::Rng(0, pair, /*sample=*/elements_->num_elements + elements_->first_number),
        differences_[pair]);
}

void ThirdBounceScan::add_costs(const VisibilityTracer& tracer) {
    num_rays_ += tracer.cost().num_rays;
    tracing_seconds_ += tracer.cost().seconds;
}

void ThirdBounceScan::store(std::size_t pair, std::span<const double> histogram) {
    const std::span<float> sums = result_->histogram(pair);
    for (std::size_t bin = 0; bin < sums.size(); ++bin) {
        sums[bin] += static_cast<float>(histogram[bin]);
    }
}

// Looks from all points [begin, end) together.
void ThirdBounceScan::integrate_confocal(std::size_t begin, std::size_t end) {
    const std::vector<WallPoint> points = sensors_.wall_points({begin, end}, elements_->origin);
    std::vector<core::TimeAxis> axes;
    VisibilityRules rules;
    rules.negligible_error = rules_.negligible_error;
    rules.plan = rules_.plan;
    for (std::size_t pair = begin; pair < end; ++pair) {
        axes.push_back(axis_of_pair(pair));
        rules.opl.push_back({axes.back().opl_start_m, axes.back().opl_end_m()});
    }
    std::vector<VisibleElements> seen(points.size());
    VisibilityTracer tracer(scene_, *elements_);
    tracer.trace(points, rules, seen);
    add_costs(tracer);
    VisibilityCheck visibility(scene_, *elements_);
    for (std::size_t i = 0; i < points.size(); ++i) {
        check(visibility, begin + i, {points[i], seen[i]}, {points[i], seen[i]});
    }
    num_rays_ += visibility.num_rays();
    BlockTable table;
    const auto num_bins = static_cast<std::size_t>(axis_.num_bins);
    std::vector<double> histograms(points.size() * num_bins);
    const auto histogram_of = [&](std::size_t i) {
        return std::span(histograms).subspan(i * num_bins, num_bins);
    };
    for (std::size_t b = 0; b < elements_->blocks.size(); ++b) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const SimdGroupMask simd_groups = seen[i].simd_groups[b];
            if (simd_groups == 0) continue;
            compute_table(elements_->blocks[b], points[i], simd_groups, table);
            const PairEnd end_of_pair{
                &points[i], &table, seen[i].masks.data() + b * ElementBlock::kSize};
            add_pair(elements_->blocks[b], end_of_pair, end_of_pair, axes[i], histogram_of(i));
        }
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        sensors_.squared_errors[begin + i] = seen[i].squared_error;
        store(begin + i, histogram_of(i));
    }
}

// What the `num_points` points of one side need to know of the other side. They are told of all its
// points, so that what a point sees does not depend on the tile that is worked on.
VisibilityRules ThirdBounceScan::rules_towards(const Side& others, std::size_t num_points) const {
    VisibilityRules rules;
    rules.negligible_error = rules_.negligible_error;
    rules.plan = rules_.plan;
    rules.pairs_per_point =
        static_cast<double>(scan_.num_pairs()) / static_cast<double>(num_points);
    const auto [min_segments, max_segments] = core::device_segment_range_m(scan_);
    rules.opl.push_back({axis_.opl_start_m - max_segments, axis_.opl_end_m() - min_segments});
    WallPoint& middle = rules.other_end.emplace(WallPoint{Vec3::Zero(), Vec3::Zero()});
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < others.points.size(); ++i) {
        const WallPoint other = others.wall_point(i, elements_->origin);
        box.extend(other.position);
        middle.position += other.position / static_cast<double>(others.points.size());
        middle.normal += other.normal / static_cast<double>(others.points.size());
    }
    if (others.points.size() > 1) {
        for (const auto& [c, radius_m] : elements_->spheres) {
            const Vec3 farthest = (c - box.min()).cwiseAbs().cwiseMax((c - box.max()).cwiseAbs());
            rules.other_segments.push_back(
                {box.exteriorDistance(c) - radius_m, farthest.norm() + radius_m});
        }
    }
    return rules;
}

void ThirdBounceScan::look_from(Side& side, const PointRange& range, const VisibilityRules& rules) {
    if (side.range == range) return;
    side.range = range;
    side.seen.resize(range.size());
    core::parallel_blocks(range.size(), kPointsPerBlock, [&](std::size_t begin, std::size_t end) {
        VisibilityTracer tracer(scene_, *elements_);
        tracer.trace(side.wall_points({range.begin + begin, range.begin + end}, elements_->origin),
                     rules,
                     std::span(side.seen).subspan(begin, end - begin));
        add_costs(tracer);
        for (std::size_t i = begin; i < end; ++i) {
            side.squared_errors[range.begin + i] = side.seen[i].squared_error;
        }
    });
}

int ThirdBounceScan::integrate_pairs(int first_part,
                                     const std::function<bool(double fraction)>& go_on) {
    const auto bytes_per_point = static_cast<double>(elements_->blocks.size() *
                                                     ElementBlock::kSize * sizeof(VisibilityMask));
    const double fitting = rules_.memory_bytes / bytes_per_point;
    if (fitting < PairTiles::kMinPoints) {
        throw core::Failure(
            "third_bounce",
            fmt::format("visibility of {} elements needs {:.2f} GB, {:.2f} GB are free for it",
                        elements_->num_elements,
                        PairTiles::kMinPoints * bytes_per_point * 1e-9,
                        rules_.memory_bytes * 1e-9));
    }
    const std::size_t num_lights =
        scan_.pattern == core::ScanPattern::Single ? 1 : scan_.illumination.size();
    // Tiles at the edges count as whole ones.
    const auto enough =
        static_cast<double>(num_lights + scan_.sensing.size() + PairTiles::kMinPoints);
    const PairTiles tiles(
        num_lights, scan_.sensing.size(), static_cast<std::size_t>(std::min(fitting, enough)));
    const VisibilityRules from_lights = rules_towards(sensors_, scan_.illumination.size());
    const VisibilityRules from_sensors = rules_towards(lights_, scan_.sensing.size());
    constexpr double kFractionOfLooking = 0.25;
    for (int part = first_part; part < kParts; ++part) {
        for (const PairTiles::Batch& batch :
             tiles.batches(static_cast<std::size_t>(part), kParts)) {
            look_from(lights_, batch.lights, from_lights);
            look_from(sensors_, batch.sensors, from_sensors);
            if (!go_on(kFractionOfLooking + (1.0 - kFractionOfLooking) * part / kParts))
                return part;
            core::parallel_for(batch.tiles.size(),
                               [&](std::size_t i) { integrate_tile(batch.tiles[i]); });
        }
    }
    go_on(1.0);
    return kParts;
}

void ThirdBounceScan::integrate_tile(const PairTiles::Tile& tile) {
    const auto tables = [&](const Side& side, const PointRange& range) {
        return TileTables(
            side.wall_points(range, elements_->origin),
            std::span(side.seen).subspan(range.begin - side.range.begin, range.size()));
    };
    TileTables lights = tables(lights_, tile.lights);
    TileTables sensors = tables(sensors_, tile.sensors);
    const std::size_t num_sensors = tile.sensors.size();
    const auto num_bins = static_cast<std::size_t>(axis_.num_bins);
    std::vector<double> histograms(tile.lights.size() * num_sensors * num_bins);
    const auto pair_of = [&](std::size_t l, std::size_t s) {
        return (tile.lights.begin + l) * scan_.sensing.size() + tile.sensors.begin + s;
    };
    const auto histogram_of = [&](std::size_t l, std::size_t s) {
        return std::span(histograms).subspan((l * num_sensors + s) * num_bins, num_bins);
    };
    for (std::size_t b = 0; b < elements_->blocks.size(); ++b) {
        const ElementBlock& block = elements_->blocks[b];
        lights.compute(block, b);
        sensors.compute(block, b);
        for (std::size_t l = 0; l < tile.lights.size(); ++l) {
            const PairEnd& light = lights.ends()[l];
            for (std::size_t s = 0; s < num_sensors; ++s) {
                const PairEnd& sensor = sensors.ends()[s];
                if (!connects(block, light, sensor)) continue;
                const core::TimeAxis axis = axis_of_pair(pair_of(l, s));
                if (misses_axis(elements_->spheres[b], *light.point, *sensor.point, axis)) continue;
                add_pair(block, light, sensor, axis, histogram_of(l, s));
            }
        }
    }
    VisibilityCheck visibility(scene_, *elements_);
    for (std::size_t l = 0; l < tile.lights.size(); ++l) {
        for (std::size_t s = 0; s < num_sensors; ++s) {
            check(visibility, pair_of(l, s), lights.end(l), sensors.end(s));
            store(pair_of(l, s), histogram_of(l, s));
        }
    }
    num_rays_ += visibility.num_rays();
}

}  // namespace renderer
