// SPDX-License-Identifier: MIT
#include "nlos/formats/exr_image.h"

#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>

namespace nlos {
namespace {

using core::Capture;
using core::Error;

/// Names of one length, so that they sort as their numbers.
std::string channel_name(std::size_t bin, std::size_t num_bins) {
    const std::size_t digits = std::max<std::size_t>(3, std::to_string(num_bins - 1).size());
    return fmt::format("bin{:0{}}", bin, digits);
}

template <class Map>
const typename Map::mapped_type& at(const std::string& path,
                                    const Map& map,
                                    const std::string& name) {
    const auto found = map.find(name);
    if (found == map.end()) {
        throw Error(path + ": " + name, "is missing or of another kind", "must be there");
    }
    return found->second;
}

core::Json parse_object(const std::string& path, const ExrTable& table, const std::string& name) {
    core::Json json = core::Json::parse(at(path, table.texts, name), nullptr, false);
    if (!json.is_object()) throw Error(path + ": " + name, "is no JSON object", "must be one");
    return json;
}

/// Visits every pixel with its pair and its place in a channel.
template <class Visit>
void for_each_pixel(const core::PinholeCamera& camera, Visit&& visit) {
    for (std::size_t x = 0; x < camera.width(); ++x) {
        for (std::size_t y = 0; y < camera.height(); ++y) {
            visit(x * camera.height() + y, y * camera.width() + x);
        }
    }
}

}  // namespace

ExrTable to_exr_image(const Capture& capture) {
    const core::PinholeCamera& camera = *capture.scan.camera;
    const std::size_t num_bins = capture.transient.num_bins();
    ExrTable table;
    table.width = camera.width();
    table.height = camera.height();
    table.texts["nlosFormat"] = kExrImageFormat;
    table.texts["nlosCamera"] = core::write_value(camera).dump();
    table.texts["nlosUnit"] = enum_name(capture.unit);
    table.texts["nlosSceneInfo"] =
        capture.scene_info.dump(-1, ' ', false, core::Json::error_handler_t::replace);
    table.numbers["nlosOplStartM"] = capture.time_axis.opl_start_m;
    table.numbers["nlosBinWidthM"] = capture.time_axis.bin_width_m;
    if (capture.counts_per_radiance) {
        table.numbers["nlosCountsPerRadiance"] = *capture.counts_per_radiance;
    }
    for (std::size_t bin = 0; bin < num_bins; ++bin) {
        std::vector<float>& channel = table.channels[channel_name(bin, num_bins)];
        channel.resize(camera.num_pixels());
        for_each_pixel(camera, [&](std::size_t pair, std::size_t place) {
            channel[place] = capture.transient.histogram(pair)[bin];
        });
    }
    return table;
}

Capture from_exr_image(const std::string& path, const ExrTable& table) {
    Capture capture;
    core::Scan& scan = capture.scan;
    scan.pattern = core::ScanPattern::Single;
    scan.opl_origin = core::OplOrigin::Device;
    core::PinholeCamera& camera = scan.camera.emplace();
    core::read_value(parse_object(path, table, "nlosCamera"), path + ": nlosCamera", camera);
    core::validate(camera, path + ": nlosCamera");
    scan.laser_position = camera.light_position();
    scan.detector_position = camera.position_m;
    if (table.width != camera.width() || table.height != camera.height()) {
        throw Error(
            path,
            fmt::format("is {} x {} pixels", table.width, table.height),
            fmt::format("must be {} x {} as its camera says", camera.width(), camera.height()));
    }
    const std::size_t num_bins = table.channels.size();
    capture.time_axis = {at(path, table.numbers, "nlosOplStartM"),
                         at(path, table.numbers, "nlosBinWidthM"),
                         static_cast<int>(num_bins)};
    core::read_value(
        core::Json(at(path, table.texts, "nlosUnit")), path + ": nlosUnit", capture.unit);
    if (const auto scale = table.numbers.find("nlosCountsPerRadiance");
        scale != table.numbers.end()) {
        capture.counts_per_radiance = scale->second;
    }
    capture.scene_info = parse_object(path, table, "nlosSceneInfo");
    capture.transient = core::Transient(scan.num_pairs(), capture.time_axis.num_bins);
    for (std::size_t bin = 0; bin < num_bins; ++bin) {
        const auto& channel = at(path, table.channels, channel_name(bin, num_bins));
        for_each_pixel(camera, [&](std::size_t pair, std::size_t place) {
            capture.transient.histogram(pair)[bin] = channel[place];
        });
    }
    return capture;
}

}  // namespace nlos
