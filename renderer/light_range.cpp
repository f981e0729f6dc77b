// SPDX-License-Identifier: MIT
#include "renderer/light_range.h"

#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/sampling.h"
#include "renderer/core/system/parallel.h"
#include "renderer/frame_sequence.h"
#include "renderer/path/path_tracer.h"
#include "renderer/scene/area_sampler.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <span>

namespace renderer {
namespace {

using core::Vec3;

// A range that holds nothing yet.
constexpr std::array<double, 2> kEmptyRange{std::numeric_limits<double>::infinity(), 0.0};
constexpr std::size_t kMaxPilotPairs = 64;
constexpr std::size_t kMaxCorners = 50'000;  // of facets, beside points drawn by area
constexpr int kAreaPoints = 4096;
constexpr int kSamplesPerPair = 256;
constexpr int kPilotBins = 8192;
constexpr std::uint64_t kPilotItem = 1ULL << 42;  // for random numbers of its own
constexpr double kTail = 0.001;                   // of the light, beyond what counts as its range

// The first and the last point of each row of a grid's first and last row.
std::vector<std::size_t> corners_of(const core::WallPoints& points) {
    const std::size_t row = points.grid ? (*points.grid)[1] : points.size();
    return {0, row - 1, points.size() - row, points.size() - 1};
}

// Pairs spread over the scan, and for wall points those at its corners, which have the longest
// paths.
void add_corners(const core::WallScan& scan, std::vector<std::size_t>& pairs) {
    for (const std::size_t sensed : corners_of(scan.sensing)) {
        if (!scan.is_exhaustive()) {
            pairs.push_back(sensed);
            continue;
        }
        for (const std::size_t lit : corners_of(scan.illumination)) {
            pairs.push_back(lit * scan.sensing.size() + sensed);
        }
    }
}
void add_corners(const core::ImageScan&, std::vector<std::size_t>&) {}

std::vector<std::size_t> some_pairs(const core::Scan& scan) {
    const std::size_t count = scan.num_pairs();
    std::vector<std::size_t> pairs;
    for (std::size_t i = 0; i < std::min(kMaxPilotPairs, count); ++i) {
        pairs.push_back(spread_pair(i, kMaxPilotPairs, count));
    }
    scan.visit([&](const auto& kind) { add_corners(kind, pairs); });
    return pairs;
}

// Corners of hidden facets and points on them.
std::vector<Vec3> hidden_points(const Scene& scene) {
    std::vector<Vec3> points;
    const auto num_facets = static_cast<std::uint32_t>(scene.facets().size());
    const auto step = static_cast<std::uint32_t>(1 + 3 * scene.facets().size() / kMaxCorners);
    for (std::uint32_t i = 0; i < num_facets; i += step) {
        if (!scene.is_hidden(i)) continue;
        const auto corners = scene.facet(i).corners();
        points.insert(points.end(), corners.begin(), corners.end());
    }
    const AreaSampler by_area(scene);
    for (int i = 0; i < kAreaPoints; ++i) {
        const core::Vec2 u = core::lattice_point(i, kAreaPoints, core::Vec2::Zero());
        points.push_back(by_area.sample(u.x(), u.y()).position);
    }
    return points;
}

// Third bounces from points in front of both ends; an empty range when there are none.
std::array<double, 2> possible_lengths(const Scene& scene,
                                       const SensorPairs& sensor_pairs,
                                       const std::vector<std::size_t>& pairs) {
    const std::vector<Vec3> points = hidden_points(scene);
    std::vector<std::array<double, 2>> ranges(pairs.size(), kEmptyRange);
    core::parallel_for(pairs.size(), [&](std::size_t i) {
        const PathEndpoints ends = sensor_pairs.ends(pairs[i]);
        for (const Vec3& point : points) {
            const Vec3 to_sensor = point - ends.sensor.position;
            const Vec3 to_light = point - ends.light.position;
            if (to_sensor.dot(ends.sensor.normal) <= 0.0) continue;
            if (to_light.dot(ends.light.normal) <= 0.0) continue;
            const double length = ends.device_segments_m + to_sensor.norm() + to_light.norm();
            ranges[i] = {std::min(ranges[i][0], length), std::max(ranges[i][1], length)};
        }
    });
    std::array<double, 2> all = kEmptyRange;
    for (const auto& [shortest, longest] : ranges) {
        all = {std::min(all[0], shortest), std::max(all[1], longest)};
    }
    return all;
}

// What no path exceeds: its ends and all facets lie in a box.
double longest_path(const Scene& scene, const core::Scan& scan, int max_bounces) {
    Eigen::AlignedBox3d box;
    for (const Vec3& end : scan.path_ends()) box.extend(end);
    for (const Object& object : scene.objects()) {
        for (const Vec3& vertex : object.mesh.vertices) box.extend(vertex);
    }
    return box.diagonal().norm() * (max_bounces + 1);
}

std::vector<double> run_pilot(const Scene& scene,
                              const SensorPairs& sensor_pairs,
                              const std::vector<std::size_t>& pairs,
                              const core::TimeAxis& axis,
                              RenderSettings settings) {
    settings.by_order = false;
    const PathTracer tracer(scene, settings);
    std::vector<std::vector<double>> light(
        pairs.size(), std::vector<double>(static_cast<std::size_t>(axis.num_bins)));
    core::parallel_for(pairs.size(), [&](std::size_t i) {
        PassHistogram histogram({axis, {}}, GateShape::Box, /*num_channels=*/1);
        core::Rng rng(settings.seed, kPilotItem + pairs[i], 0);
        tracer.trace(sensor_pairs, pairs[i], kSamplesPerPair, rng, histogram);
        histogram.drain(
            [&](std::size_t begin, std::span<const double> values) {
                std::copy(values.begin(), values.end(), light[i].data() + begin);
            },
            [](std::size_t, std::span<const double>) {});
    });
    for (std::size_t i = 1; i < light.size(); ++i) {
        std::transform(
            light[i].begin(), light[i].end(), light[0].begin(), light[0].begin(), std::plus());
    }
    return light[0];
}

double extent(const core::WallPoints& points, int rank) {
    Eigen::AlignedBox3d box;
    for (const Vec3& point : points.positions) box.extend(point);
    Vec3 sizes = box.diagonal();
    std::sort(sizes.data(), sizes.data() + 3, std::greater());
    return sizes[rank];
}

// Half the bin that would blur the farthest neighbours of the scan; 0 for images and single points.
double resolving_bin_m(const core::ImageScan&, double) {
    return 0.0;
}
double resolving_bin_m(const core::WallScan& scan, double depth_m) {
    if (scan.sensing.size() < 2) return 0.0;
    const auto count = static_cast<double>(scan.sensing.size());
    const double width = extent(scan.sensing, 0);
    const double height = std::max(extent(scan.sensing, 1), width / count);
    const double pitch = std::sqrt(width * height / count);
    return pitch * width / std::hypot(width, 2.0 * depth_m);
}

// Of a detector whose response they are to show; infinite where none is known.
double widest_bin_of(const SceneDescription& description) {
    const double fwhm_ps = description.detector ? description.detector->jitter_fwhm_ps : 0.0;
    return fwhm_ps > 0.0 ? core::widest_bin_m(fwhm_ps) : std::numeric_limits<double>::infinity();
}

// Two significant digits.
double round_up(double value) {
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
    return std::ceil(value / unit * (1.0 - 1e-9)) * unit;
}

}  // namespace

std::size_t spread_pair(std::size_t i, std::size_t count, std::size_t all) {
    if (all <= count) return i;
    const double position = core::lattice_point(static_cast<int>(i), 1, core::Vec2::Zero()).y();
    return static_cast<std::size_t>(position * static_cast<double>(all));
}

bool LightRange::is_dark() const {
    return std::all_of(light.begin(), light.end(), [](double value) { return value == 0.0; });
}

std::array<double, 2> LightRange::without_tails(double tail) const {
    const double all = std::accumulate(light.begin(), light.end(), 0.0);
    std::size_t first = 0;
    std::size_t last = light.size() - 1;
    double sum = light[first];
    while (first < last && sum <= tail * all) sum += light[++first];
    sum = light[last];
    while (last > first && sum <= tail * all) sum += light[--last];
    return {axis.bin_begin_m(static_cast<double>(first)),
            axis.bin_begin_m(static_cast<double>(last) + 1.0)};
}

double LightRange::fraction_between(double begin_m, double end_m) const {
    double inside = 0.0;
    double all = 0.0;
    for (std::size_t bin = 0; bin < light.size(); ++bin) {
        const double begin = axis.bin_begin_m(static_cast<double>(bin));
        const double overlap = std::min(end_m, begin + axis.bin_width_m) - std::max(begin_m, begin);
        inside += light[bin] * std::clamp(overlap / axis.bin_width_m, 0.0, 1.0);
        all += light[bin];
    }
    return all > 0.0 ? inside / all : 0.0;
}

std::optional<LightRange> find_light_range(const Scene& scene,
                                           const core::Scan& scan,
                                           const RenderSettings& settings) {
    const SensorPairs sensor_pairs(scene, scan);
    if (settings.max_bounces < sensor_pairs.first_order()) return std::nullopt;
    const std::vector<std::size_t> pairs = some_pairs(scan);
    LightRange range;
    double longest = 0.0;  // path that the pilot run looks for
    if (!scan.has_wall()) {
        longest = longest_path(scene, scan, settings.max_bounces);
    } else {
        range.possible_m = possible_lengths(scene, sensor_pairs, pairs);
        if (range.possible_m[1] == 0.0) return LightRange{{0.0, 0.0}, {0.0, 1.0, 1}, {0.0}};
        const double segments = core::device_segment_range_m(scan.wall())[0];
        range.axis.opl_start_m = std::max(0.0, segments);
        // Each segment of a longer path is at most about as long as the longest of a third bounce.
        longest = range.possible_m[1] * 0.5 * (settings.max_bounces - 1);
    }
    range.axis.num_bins = kPilotBins;
    range.axis.bin_width_m = std::max(1e-9, longest - range.axis.opl_start_m) * 1.01 / kPilotBins;
    range.light = run_pilot(scene, sensor_pairs, pairs, range.axis, settings);
    if (!scan.has_wall()) range.possible_m = range.without_tails(0.0);
    return range;
}

bool is_narrow(const Scene& scene,
               const core::Scan& scan,
               const core::HistogramAxes& axes,
               const RenderSettings& settings) {
    constexpr double kNarrow = 0.15;
    if (axes.velocity) return false;
    const auto range = find_light_range(scene, scan, settings);
    return range && !range->is_dark() &&
           range->fraction_between(axes.time.opl_start_m, axes.time.opl_end_m()) < kNarrow;
}

core::TimeAxis choose_time_axis(const std::optional<LightRange>& range,
                                const Scene& scene,
                                const core::Scan& scan,
                                const SceneDescription& description) {
    constexpr int kFewest = 64;
    constexpr int kMost = 4096;
    constexpr double kMostStated = 1e9;  // bins of a given width
    constexpr double kMargin = 0.02;     // of the range, on either side
    if (!range || range->is_dark()) {
        throw core::Error("time_axis",
                          "found auto where no light reaches the scan",
                          "must be given, or the hidden surfaces be seen from the scan's points");
    }
    std::array<double, 2> ends = range->possible_m;
    double sure_end = range->without_tails(kTail)[1];
    const double middle = range->without_tails(0.5)[0];
    if (description.frames && description.frames->frame_s > 0.0) {
        const double seconds = description.frames->frame_s * (description.frames->count - 1);
        const Scene last(moved_by(scene, seconds), scan, description.relay_wall);
        const auto later = find_light_range(last, scan, description.render);
        ends = {std::min(ends[0], later->possible_m[0]), std::max(ends[1], later->possible_m[1])};
        if (!later->is_dark()) sure_end = std::max(sure_end, later->without_tails(kTail)[1]);
    }
    const double segments = scan.has_wall() ? core::device_segment_range_m(scan.wall())[0] : 0.0;
    if (description.render.direct_return && scan.has_wall()) ends[0] = segments;
    ends[1] = std::max(ends[1], sure_end);
    const double margin = kMargin * (ends[1] - ends[0]);
    const double start = std::max(0.0, ends[0] - margin);
    double span = ends[1] + margin - start;
    core::TimeAxis axis = description.time_axis;
    const SceneTimeAxis::Stated& stated = description.time_axis.stated;
    if (!stated.bin_width) {
        const double wanted = scan.visit(
            [&](const auto& kind) { return resolving_bin_m(kind, 0.5 * (middle - segments)); });
        const double widest = widest_bin_of(description);
        double width = wanted > 0.0 ? std::min(wanted, span / kFewest) : span / 256.0;
        width = std::min(width, widest);
        if (span > kMost * width) {
            span = std::max(kMost * width, sure_end + margin - start);
            width = std::max(width, span / kMost);
        }
        axis.bin_width_m = width < widest ? round_up(width) : width;
    }
    if (!stated.opl_start) {
        axis.opl_start_m = std::floor(start / axis.bin_width_m) * axis.bin_width_m;
    }
    if (!stated.num_bins) {
        const double bins = (start + span - axis.opl_start_m) / axis.bin_width_m;
        axis.num_bins = static_cast<int>(std::clamp(std::ceil(bins), 2.0, kMostStated));
    }
    return axis;
}

std::vector<std::string> axis_warnings(const LightRange& range,
                                       const core::TimeAxis& axis,
                                       const std::optional<FrameSettings>& frames) {
    constexpr double kLittle = 0.5;
    const double moved = frames ? (frames->count - 1) * frames->gate_step_m : 0.0;
    const double begin = axis.opl_start_m + std::min(0.0, moved);
    const double end = axis.opl_end_m() + std::max(0.0, moved);
    if (range.is_dark()) {
        return {
            "no light reaches the points of the scan: no hidden surface is seen from them, or "
            "all are black"};
    }
    const auto [shortest, longest] = range.without_tails(0.0);
    const std::string holds = fmt::format("the time axis holds {:.4g} to {:.4g} m", begin, end);
    const char* const help = "time_axis=auto, or opl_start_m, bin_width_m and num_bins, move it";
    if (end <= std::min(shortest, range.possible_m[0]) ||
        begin >= std::max(longest, range.possible_m[1])) {
        return {fmt::format("{} and no light: paths are {:.4g} to {:.4g} m long; {}",
                            holds,
                            range.possible_m[0],
                            std::max(longest, range.possible_m[1]),
                            help)};
    }
    // A gate is meant to hold little.
    const double fraction = range.fraction_between(begin, end);
    if (axis.num_bins == 1 || fraction >= kLittle) return {};
    const auto [first, last] = range.without_tails(kTail);
    return {fmt::format("{} and {:.2g} % of the light, which lies between {:.4g} and {:.4g} m; {}",
                        holds,
                        100.0 * fraction,
                        first,
                        last,
                        help)};
}

}  // namespace renderer
