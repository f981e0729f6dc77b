// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_array_reader.h"
#include "nlos/formats/capture_arrays.h"
#include "nlos/formats/capture_format.h"
#include "nlos/formats/ytal_layout.h"
#include "renderer/core/capture/left_out_orders.h"
#include "renderer/core/error.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>

#include <limits>

namespace nlos {
namespace {

using core::Capture;
using core::Error;

/// The axis of /nlos/velocity, which has one dimension more than H when it resolves time too.
core::VelocityAxis read_velocity_axis(const ArrayReader& file) {
    const std::string name = "nlos/velocity";
    const Shape shape = file.shape(name);
    Shape wanted = file.shape("H");
    core::VelocityAxis axis;
    axis.with_time = shape.size() > wanted.size();
    if (axis.with_time) wanted.insert(wanted.begin(), 0);
    wanted[0] = shape.empty() ? 0 : shape[0];
    require_shape(file, name, wanted);
    const std::size_t num_values = wanted[0] * (axis.with_time ? wanted[1] : 1);
    if (num_values > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        throw Error(file.where(name),
                    fmt::format("has {} values per pair", num_values),
                    "must have fewer than 2^31");
    }
    axis.num_bins = static_cast<int>(wanted[0]);
    const auto read_number = [&](const char* attribute, double& value) {
        const auto found = file.real_attribute(name, attribute);
        if (!found || found->size() != 1) {
            throw Error(file.where(name) + " attribute " + attribute,
                        "is missing or no number",
                        "must be one number");
        }
        value = found->front();
    };
    read_number(kVelocityStart, axis.start_m_per_s);
    read_number(kVelocityBinWidth, axis.bin_width_m_per_s);
    if (file.real_attribute(name, kVelocityCarrier)) read_number(kVelocityCarrier, axis.carrier_hz);
    validate(axis, file.where(name));
    return axis;
}

void read_velocity(const ArrayReader& file, Capture& capture) {
    core::VelocityHistogram velocity;
    velocity.axis = read_velocity_axis(file);
    const int time_bins = capture.time_axis.num_bins;
    const auto bins_per_row = static_cast<std::size_t>(velocity.axis.with_time ? time_bins : 1);
    const auto read_values = [&](const std::string& name) {
        core::Transient values =
            make_transient(file, name, capture, velocity.axis.num_values(time_bins));
        file.read_rows(
            name, [&](std::size_t first, std::size_t count, const std::vector<float>& rows) {
                copy_bins(rows.data(), first * bins_per_row, count * bins_per_row, values);
            });
        return values;
    };
    velocity.values = read_values("nlos/velocity");
    const std::string variance = "nlos/velocity_variance";
    if (file.has(variance)) {
        require_shape(file, variance, file.shape("nlos/velocity"));
        velocity.variance = read_values(variance);
        require_variances(file, variance, *velocity.variance);
    }
    capture.velocity = std::move(velocity);
}

void read_frame_steps(const ArrayReader& file, core::FrameSequence& sequence) {
    const auto read_step = [&](const char* name, double& value) {
        const auto found = file.real_attribute("nlos/frames", name);
        if (found && found->size() == 1) value = found->front();
    };
    read_step(kGateStep, sequence.gate_step_m);
    read_step(kFrameTime, sequence.frame_s);
}

void read_own_group(const ArrayReader& file, Capture& capture) {
    if (const auto unit = file.text_attribute("nlos", "unit")) {
        core::read_value(core::Json(*unit), file.where("nlos attribute unit"), capture.unit);
    } else if (capture.scene_info->contains(kUnitKey)) {
        core::read_value(
            (*capture.scene_info)[kUnitKey], file.where("scene_info: unit"), capture.unit);
    }
    if (const auto scale = file.real_attribute("nlos", "counts_per_radiance")) {
        capture.counts_per_radiance =
            checked_scale(scale->size() == 1 ? scale->front() : 0.0,
                          file.where("nlos attribute counts_per_radiance"));
    }
    read_optional_arrays(file, "nlos/", capture);
    if (capture.sequence) read_frame_steps(file, *capture.sequence);
    if (file.has("nlos/velocity")) read_velocity(file, capture);
}

/// Where another program has written scene_info anew and kept the attributes of H.
void read_left_out_orders(const ArrayReader& file, Capture& capture) {
    if (capture.scene_info->contains(core::kLeftOutOrdersKey)) return;
    const auto orders = file.real_attribute("H", kLeftOutOrders);
    const auto error = file.real_attribute("H", kLeftOutError);
    const auto share = file.real_attribute("H", kLeftOutShare);
    if (!orders || !error || !share) return;
    if (orders->size() != 2 || error->size() != 1 || share->size() != 1) return;
    capture.scene_info[core::kLeftOutOrdersKey] = {{"first", orders->front()},
                                                   {"last", orders->back()},
                                                   {"error", error->front()},
                                                   {"share", share->front()}};
}

Capture read_ytal(const ArrayReader& file, const CaptureReadSettings& settings) {
    Capture capture = read_histograms(file, settings);
    read_own_group(file, capture);
    read_left_out_orders(file, capture);
    return capture;
}

CaptureFormat::Read open_ytal(const std::string& path) {
    const auto file = open_arrays(path);
    if (!file || file->container() != "hdf5" || !file->has_object("H")) return nullptr;
    return [file](const CaptureReadSettings& settings) { return read_ytal(*file, settings); };
}

}  // namespace

CaptureFormat ytal_format() {
    return {"y-tal HDF5", open_ytal};
}

}  // namespace nlos
