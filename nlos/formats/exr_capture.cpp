// SPDX-License-Identifier: MIT
#include "nlos/containers/exr_table.h"
#include "nlos/formats/capture_format.h"
#include "nlos/formats/exr_attributes.h"
#include "renderer/core/error.h"
#include "renderer/core/precision.h"
#include "renderer/core/settings/json_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <limits>

namespace nlos {
namespace {

using core::Capture;
using core::Error;
using core::WallPoints;

// A scan as an OpenEXR image that any viewer shows: one row per measurement pair, one column per
// bin (a streak image), or, for a scan of a grid with a single bin, the wall as an eye in front of
// it sees it: x from right to left, y upwards. Channel Y holds H as float, `variance` its variance,
// `order.N` the light of N bounces. Header attributes:
//
//   nlosFormat                        text: capture 1
//   nlosLayout                        text: pairs | wall
//   nlosPattern                       text: confocal | single | exhaustive
//   nlosUnit                          text: radiance | counts
//   nlosCountsPerRadiance             double, when known
//   nlosOplStartM, nlosBinWidthM      double: start of bin 0 and width of a bin [m of path length]
//   nlosOplOrigin                     text: relay_wall | device
//   nlosLaserM, nlosDetectorM         3 floats: device positions [m, world]
//   nlosSensingGrid, nlosIlluminationGrid            2 floats: points along x and y; none: a list
//   nlosSensingPointsM, nlosIlluminationPointsM      3 floats per point [m, world], x index first
//   nlosSensingNormals, nlosIlluminationNormals      3 floats per point, unit
//   nlosObservedBins                  2 floats per pair, where some bins were not observed: the
//                                     first observed bin and the one after the last
//   nlosSceneInfo                     text: JSON, where the capture came from
//
// A confocal scan holds its points once, as the sensing ones. Pairs are numbered as in core::Scan.

constexpr const char* kFormat = "capture 1";
constexpr const char* kValues = "Y";
constexpr const char* kVariance = "variance";
constexpr const char* kOrder = "order.";

void put_points(ExrTable& table, const std::string& device, const WallPoints& points) {
    table.lists["nlos" + device + "PointsM"] = to_floats(points.positions);
    table.lists["nlos" + device + "Normals"] = to_floats(points.normals);
    if (points.grid) {
        table.lists["nlos" + device + "Grid"] = {static_cast<float>((*points.grid)[0]),
                                                 static_cast<float>((*points.grid)[1])};
    }
}

void put_observed_bins(ExrTable& table, const std::vector<core::BinRange>& observed) {
    std::vector<float>& bins = table.lists[kExrObservedBins];
    for (const core::BinRange& range : observed) {
        bins.push_back(static_cast<float>(range.begin));
        bins.push_back(static_cast<float>(range.end));
    }
}

bool shows_wall(const Capture& capture) {
    const core::WallScan& scan = capture.scan.wall();
    return capture.time_axis.num_bins == 1 && scan.sensing.grid && !scan.is_exhaustive();
}

/// Where in the table a pair's first bin stands: rows of bins, or the wall from its front.
std::size_t index_of(std::size_t pair, const Capture& capture, bool is_wall) {
    if (!is_wall) return pair * static_cast<std::size_t>(capture.time_axis.num_bins);
    const auto [nx, ny] = *capture.scan.wall().sensing.grid;
    return (ny - 1 - pair % ny) * nx + (nx - 1 - pair / ny);
}

std::vector<float> to_channel(const core::Transient& transient,
                              const Capture& capture,
                              bool is_wall) {
    std::vector<float> channel(transient.values().size());
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        std::ranges::copy(
            transient.histogram(pair),
            channel.begin() + static_cast<std::ptrdiff_t>(index_of(pair, capture, is_wall)));
    }
    return channel;
}

core::Transient to_transient(const std::vector<float>& channel,
                             const Capture& capture,
                             bool is_wall) {
    core::Transient transient(capture.scan.num_pairs(), capture.time_axis.num_bins);
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        std::copy_n(channel.begin() + static_cast<std::ptrdiff_t>(index_of(pair, capture, is_wall)),
                    transient.num_bins(),
                    transient.histogram(pair).begin());
    }
    return transient;
}

/// N of a channel `order.N`, or nothing.
std::optional<int> order_of(const std::string& channel) {
    const std::string prefix = kOrder;
    if (!channel.starts_with(prefix)) return std::nullopt;
    int order = 0;
    const char* end = channel.data() + channel.size();
    const auto [stop, error] = std::from_chars(channel.data() + prefix.size(), end, order);
    if (error != std::errc() || stop != end) return std::nullopt;
    return order;
}

void check_size(const std::string& path, const ExrTable& table, const Capture& capture) {
    const auto bins = static_cast<std::size_t>(capture.time_axis.num_bins);
    const auto expect = [&](std::size_t width, std::size_t height) {
        if (table.width == width && table.height == height) return;
        throw Error(path,
                    fmt::format("is {} x {} pixels", table.width, table.height),
                    fmt::format("must be {} x {} as its points say", width, height));
    };
    if (shows_wall(capture)) {
        const auto [nx, ny] = *capture.scan.wall().sensing.grid;
        expect(nx, ny);
    } else {
        expect(bins, capture.scan.num_pairs());
    }
}

void read_scan(const ExrAttributes& attributes, core::WallScan& scan) {
    scan.pattern = attributes.choice<core::ScanPattern>("nlosPattern");
    scan.sensing = attributes.points("Sensing");
    scan.illumination = scan.is_confocal() ? scan.sensing : attributes.points("Illumination");
    scan.opl_origin = attributes.choice<core::OplOrigin>("nlosOplOrigin");
    scan.laser_position = attributes.vector("nlosLaserM");
    scan.detector_position = attributes.vector("nlosDetectorM");
}

Capture read_exr(const std::string& path, const CaptureReadSettings& settings) {
    const ExrTable table = read_exr_table(path);
    const auto format = table.texts.find(kExrFormatKey);
    if (format != table.texts.end() && format->second == kExrImageFormat) {
        Capture image = from_exr_image(path, table);
        image.time_axis.bin_width_m = settings.bin_width_m.value_or(image.time_axis.bin_width_m);
        return image;
    }
    if (format == table.texts.end() || format->second != kFormat) {
        throw Error(path,
                    fmt::format("is an image without the header attribute {}", kExrFormatKey),
                    "must be a capture written as OpenEXR");
    }
    const ExrAttributes attributes(path, table);
    Capture capture;
    read_scan(attributes, capture.scan.wall());
    const bool is_wall = attributes.text("nlosLayout") == "wall";
    if (table.width > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        throw Error(path, fmt::format("has {} columns", table.width), "must have fewer than 2^31");
    }
    attributes.read_measurement(is_wall ? 1 : static_cast<int>(table.width), capture);
    capture.time_axis.bin_width_m = settings.bin_width_m.value_or(capture.time_axis.bin_width_m);
    if (is_wall && !shows_wall(capture)) {
        throw Error(path + ": nlosLayout", "is wall for a list of points", "must be pairs");
    }
    check_size(path, table, capture);
    if (!table.channels.contains(kValues)) {
        throw Error(path, "has no channel Y", "must hold the histograms there");
    }
    for (const auto& [name, channel] : table.channels) {
        const std::optional<int> order = order_of(name);
        if (name == kValues) capture.transient = to_transient(channel, capture, is_wall);
        if (name == kVariance) capture.variance = to_transient(channel, capture, is_wall);
        if (!order) continue;
        capture.orders.push_back(*order);
        capture.by_order.push_back(to_transient(channel, capture, is_wall));
    }
    capture.observed = attributes.observed_bins(capture.scan.num_pairs());
    capture.scene_info =
        core::json_if_valid(attributes.text("nlosSceneInfo")).value_or(core::Json::object());
    if (!capture.scene_info->is_object()) capture.scene_info = core::Json::object();
    return capture;
}

CaptureFormat::Read open_exr(const std::string& path) {
    if (!is_exr_file(path)) return nullptr;
    return [path](const CaptureReadSettings& settings) { return read_exr(path, settings); };
}

std::vector<std::string> write_image(const std::string& path,
                                     const Capture& capture,
                                     const core::ImageScan& image) {
    write_exr_table(path, to_exr_image(capture, image.camera));
    const bool has_joint = capture.velocity && capture.velocity->axis.with_time;
    if (!capture.variance && capture.orders.empty() && !capture.sequence && !has_joint) return {};
    return {"variance, orders of bounces, frames and velocities with time are left out"};
}

std::vector<std::string> write_points(const std::string& path,
                                      const Capture& capture,
                                      const core::WallScan& scan) {
    const bool is_wall = shows_wall(capture);
    ExrTable table;
    table.width = is_wall ? (*scan.sensing.grid)[0] : capture.transient.num_bins();
    table.height = is_wall ? (*scan.sensing.grid)[1] : scan.num_pairs();
    put_measurement(kFormat, capture, table);
    table.texts["nlosLayout"] = is_wall ? "wall" : "pairs";
    table.texts["nlosPattern"] = enum_name(scan.pattern);
    table.texts["nlosOplOrigin"] = enum_name(scan.opl_origin);
    table.lists["nlosLaserM"] = to_floats({scan.laser_position});
    table.lists["nlosDetectorM"] = to_floats({scan.detector_position});
    put_points(table, "Sensing", scan.sensing);
    if (!scan.is_confocal()) {
        put_points(table, "Illumination", scan.illumination);
    }
    table.channels[kValues] = to_channel(capture.transient, capture, is_wall);
    if (capture.observed) put_observed_bins(table, *capture.observed);
    if (capture.variance) {
        table.channels[kVariance] = to_channel(*capture.variance, capture, is_wall);
    }
    for (std::size_t i = 0; i < capture.orders.size(); ++i) {
        // Two digits keep the channels, which are sorted by name, in the order of their numbers.
        table.channels[fmt::format("{}{:02}", kOrder, capture.orders[i])] =
            to_channel(capture.by_order[i], capture, is_wall);
    }
    write_exr_table(path, table);
    std::vector<std::string> losses;
    if (capture.sequence || capture.velocity)
        losses.push_back("frames and velocities are left out");
    if (std::ranges::any_of(scan.path_ends(), core::needs_double)) {
        losses.push_back("points so far from the origin are rounded to single precision");
    }
    return losses;
}

}  // namespace

std::vector<std::string> write_exr(const std::string& path,
                                   const Capture& capture,
                                   const CaptureWriteSettings&) {
    return capture.scan.visit(
        [&](const core::WallScan& scan) { return write_points(path, capture, scan); },
        [&](const core::ImageScan& image) { return write_image(path, capture, image); });
}

CaptureFormat exr_format() {
    return {"OpenEXR", open_exr};
}

}  // namespace nlos
