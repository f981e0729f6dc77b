// SPDX-License-Identifier: MIT
#include "nlos/formats/exr_attributes.h"
#include "renderer/core/error.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>

#include <algorithm>

namespace nlos {
namespace {

using core::Capture;
using core::Error;

constexpr const char* kTimeBin = "bin";
constexpr const char* kVelocityBin = "velocity";

/// Names of one length, so that they sort as their numbers.
std::string channel_name(const char* kind, std::size_t bin, std::size_t num_bins) {
    const std::size_t digits = std::max<std::size_t>(3, std::to_string(num_bins - 1).size());
    return fmt::format("{}{:0{}}", kind, bin, digits);
}

core::Json parse_object(const std::string& path, const ExrTable& table, const std::string& name) {
    core::Json json = core::parse_json(ExrAttributes(path, table).text(name), path + ": " + name);
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

void put_channels(const core::PinholeCamera& camera,
                  const char* kind,
                  const core::Transient& transient,
                  ExrTable& table) {
    for (std::size_t bin = 0; bin < transient.num_bins(); ++bin) {
        std::vector<float>& channel = table.channels[channel_name(kind, bin, transient.num_bins())];
        channel.resize(camera.num_pixels());
        for_each_pixel(camera, [&](std::size_t pair, std::size_t index) {
            channel[index] = transient.histogram(pair)[bin];
        });
    }
}

core::Transient read_channels(const std::string& path,
                              const core::PinholeCamera& camera,
                              const char* kind,
                              int num_bins,
                              const ExrTable& table) {
    core::Transient transient(camera.num_pixels(), num_bins);
    for (std::size_t bin = 0; bin < transient.num_bins(); ++bin) {
        const std::string name = channel_name(kind, bin, transient.num_bins());
        const auto& channel = ExrAttributes(path, table).channel(name);
        for_each_pixel(camera, [&](std::size_t pair, std::size_t index) {
            transient.histogram(pair)[bin] = channel[index];
        });
    }
    return transient;
}

/// The velocity axis, if the file has one; as many bins as it says must be there.
void read_velocity(const std::string& path,
                   const core::PinholeCamera& camera,
                   const ExrTable& table,
                   Capture& capture) {
    const std::string name = "nlosVelocityAxis";
    if (!table.texts.contains(name)) return;
    core::VelocityHistogram velocity;
    core::read_value(parse_object(path, table, name), path + ": " + name, velocity.axis);
    validate(velocity.axis, path + ": " + name);
    if (static_cast<std::size_t>(velocity.axis.num_bins) > table.channels.size()) {
        throw Error(path + ": " + name,
                    fmt::format("has {} bins", velocity.axis.num_bins),
                    "must have no more than the file has channels");
    }
    velocity.axis.with_time = false;
    velocity.values = read_channels(path, camera, kVelocityBin, velocity.axis.num_bins, table);
    capture.velocity = std::move(velocity);
}

}  // namespace

ExrTable to_exr_image(const Capture& capture, const core::PinholeCamera& camera) {
    ExrTable table;
    table.width = camera.width();
    table.height = camera.height();
    put_measurement(kExrImageFormat, capture, table);
    table.texts["nlosCamera"] = core::write_value(camera).dump();
    put_channels(camera, kTimeBin, capture.transient, table);
    if (capture.velocity && !capture.velocity->axis.with_time) {
        table.texts["nlosVelocityAxis"] = core::write_value(capture.velocity->axis).dump();
        put_channels(camera, kVelocityBin, capture.velocity->values, table);
    }
    return table;
}

Capture from_exr_image(const std::string& path, const ExrTable& table) {
    Capture capture;
    core::PinholeCamera camera;
    core::read_value(parse_object(path, table, "nlosCamera"), path + ": nlosCamera", camera);
    core::validate(camera, path + ": nlosCamera");
    capture.scan = core::ImageScan{camera};
    if (table.width != camera.width() || table.height != camera.height()) {
        throw Error(
            path,
            fmt::format("is {} x {} pixels", table.width, table.height),
            fmt::format("must be {} x {} as its camera says", camera.width(), camera.height()));
    }
    const auto num_bins =
        std::count_if(table.channels.begin(), table.channels.end(), [](const auto& channel) {
            return channel.first.starts_with(kTimeBin);
        });
    ExrAttributes(path, table).read_measurement(static_cast<int>(num_bins), capture);
    capture.scene_info = parse_object(path, table, "nlosSceneInfo");
    capture.transient = read_channels(path, camera, kTimeBin, capture.time_axis.num_bins, table);
    read_velocity(path, camera, table, capture);
    return capture;
}

}  // namespace nlos
