// SPDX-License-Identifier: MIT
#include "nlos/containers/file_memory.h"
#include "nlos/containers/array_reader.h"
#include "nlos/formats/capture_format.h"
#include "nlos/formats/ytal_layout.h"
#include "nlos/formats/ytal_scan.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>

namespace nlos {
namespace {

using core::Capture;
using core::Error;

void read_axis(const ArrayReader& file, const CaptureReadSettings& settings, Capture& capture) {
    const std::size_t bins = file.shape("H").at(0);
    if (bins > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        throw Error(file.where("H"), fmt::format("has {} bins", bins), "must have fewer than 2^31");
    }
    capture.time_axis.num_bins = static_cast<int>(bins);
    capture.time_axis.bin_width_m =
        settings.bin_width_m ? *settings.bin_width_m : file.read_real("delta_t");
    if (file.has("t_start")) {
        capture.time_axis.opl_start_m = file.read_real("t_start");
    } else {
        capture.notes.emplace_back("t_start is missing: 0 assumed");
    }
    validate(capture.time_axis, file.path() + ": time axis");
}

/// Copies rows with time slowest to bins [first, first + count) of [pair][bin].
void copy_bins(const float* rows,
               std::size_t first,
               std::size_t count,
               core::Transient& transient) {
    constexpr std::size_t kPairsAtOnce = 16;  // one cache line of every row at a time
    const std::size_t pairs = transient.num_pairs();
    for (std::size_t begin = 0; begin < pairs; begin += kPairsAtOnce) {
        const std::size_t end = std::min(pairs, begin + kPairsAtOnce);
        for (std::size_t row = 0; row < count; ++row) {
            for (std::size_t pair = begin; pair < end; ++pair) {
                transient.histogram(pair)[first + row] = rows[row * pairs + pair];
            }
        }
    }
}

core::Transient make_transient(const ArrayReader& file,
                               const std::string& name,
                               const Capture& capture,
                               int num_bins) {
    const std::size_t pairs = capture.scan.num_pairs();
    require_memory(sizeof(float) * pairs * static_cast<std::size_t>(num_bins), file.where(name));
    return {pairs, num_bins};
}

/// Reads (T, pairs...) with time slowest into [pair][bin].
core::Transient read_transient(const ArrayReader& file,
                               const std::string& name,
                               const Capture& capture) {
    core::Transient transient = make_transient(file, name, capture, capture.time_axis.num_bins);
    file.read_rows(name, [&](std::size_t first, std::size_t count, const std::vector<float>& rows) {
        copy_bins(rows.data(), first, count, transient);
    });
    return transient;
}

void require_shape(const ArrayReader& file, const std::string& name, const Shape& wanted) {
    if (file.shape(name) == wanted) return;
    throw Error(file.where(name),
                "has shape " + shape_text(file.shape(name)),
                "must have shape " + shape_text(wanted) + ", as H");
}

void require_variances(const ArrayReader& file,
                       const std::string& name,
                       const core::Transient& variance) {
    for (const float value : variance.values()) {
        if (!(value >= 0.0F) || !std::isfinite(value)) {
            throw Error(file.where(name),
                        fmt::format("found {}", value),
                        "must be finite and not negative");
        }
    }
}

/// The bins of each pair that were observed; validate() checks them against the axis and H.
void read_observed_bins(const ArrayReader& file, Capture& capture) {
    Shape wanted = file.shape("H");
    wanted[0] = 2;
    require_shape(file, kObservedBins, wanted);
    const std::vector<double> bins = file.read_doubles(kObservedBins, wanted);
    const std::size_t num_pairs = bins.size() / 2;
    for (const double bin : bins) {
        if (bin == std::trunc(bin) && std::abs(bin) <= std::numeric_limits<int>::max()) continue;
        throw Error(file.where(kObservedBins), fmt::format("found {}", bin), "must be bin numbers");
    }
    std::vector<core::BinRange>& observed = capture.observed.emplace();
    for (std::size_t pair = 0; pair < num_pairs; ++pair) {
        observed.push_back(
            {static_cast<int>(bins[pair]), static_cast<int>(bins[num_pairs + pair])});
    }
}

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

/// Reads several transients stored as one array, each of them as H.
std::vector<core::Transient> read_stack(const ArrayReader& file,
                                        const std::string& name,
                                        const Capture& capture) {
    const Shape shape = file.shape(name);
    Shape wanted = file.shape("H");
    wanted.insert(wanted.begin(), shape.empty() ? 0 : shape[0]);
    require_shape(file, name, wanted);
    std::vector<core::Transient> stack;
    for (std::size_t i = 0; i < wanted[0]; ++i) {
        stack.push_back(make_transient(file, name, capture, capture.time_axis.num_bins));
    }
    file.read_rows(name, [&](std::size_t first, std::size_t count, const std::vector<float>& rows) {
        for (std::size_t i = 0; i < count; ++i) {
            copy_bins(rows.data() + i * (rows.size() / count), 0, wanted[1], stack[first + i]);
        }
    });
    return stack;
}

void read_orders(const ArrayReader& file, Capture& capture) {
    capture.by_order = read_stack(file, "nlos/H_by_order", capture);
    for (const double order : file.read_doubles("nlos/orders", {capture.by_order.size()})) {
        capture.orders.push_back(static_cast<int>(order));
    }
}

void read_frames(const ArrayReader& file, Capture& capture) {
    core::FrameSequence sequence;
    const auto read_step = [&](const char* name, double& value) {
        const auto found = file.real_attribute("nlos/frames", name);
        if (found && found->size() == 1) value = found->front();
    };
    read_step(kGateStep, sequence.gate_step_m);
    read_step(kFrameTime, sequence.frame_s);
    sequence.frames = read_stack(file, "nlos/frames", capture);
    capture.sequence = std::move(sequence);
}

void read_own_group(const ArrayReader& file, Capture& capture) {
    if (const auto unit = file.text_attribute("nlos", "unit")) {
        core::read_value(core::Json(*unit), file.where("nlos attribute unit"), capture.unit);
    } else if (capture.scene_info.contains(kUnitKey)) {
        core::read_value(
            capture.scene_info[kUnitKey], file.where("scene_info: unit"), capture.unit);
    }
    const auto scale = file.real_attribute("nlos", "counts_per_radiance");
    if (scale && scale->size() == 1 && std::isfinite((*scale)[0]) && (*scale)[0] > 0.0) {
        capture.counts_per_radiance = (*scale)[0];
    } else if (scale) {
        throw Error(file.where("nlos attribute counts_per_radiance"),
                    "is no positive number",
                    "must be one positive number");
    }
    if (file.has(kObservedBins)) read_observed_bins(file, capture);
    if (file.has("nlos/H_by_order")) read_orders(file, capture);
    if (file.has("nlos/frames")) read_frames(file, capture);
    if (file.has("nlos/velocity")) read_velocity(file, capture);
    if (!file.has("nlos/variance")) return;
    require_shape(file, "nlos/variance", file.shape("H"));
    capture.variance = read_transient(file, "nlos/variance", capture);
    require_variances(file, "nlos/variance", *capture.variance);
}

bool recognise_ytal(const std::string& path) {
    return container_of(path) == "hdf5" && ArrayReader(path).has_object("H");
}

Capture read_ytal(const std::string& path, const CaptureReadSettings& settings) {
    const ArrayReader file(path);
    Capture capture;
    if (file.has("scene_info")) capture.scene_info = parse_scene_info(file.read_text("scene_info"));
    read_ytal_scan(file, capture);
    read_axis(file, settings, capture);
    capture.transient = read_transient(file, "H", capture);
    read_own_group(file, capture);
    return capture;
}

}  // namespace

CaptureFormat ytal_format() {
    return {"y-tal HDF5",
            "HDF5 with a dataset H",
            recognise_ytal,
            read_ytal,
            {".h5", ".hdf5"},
            write_ytal_capture};
}

}  // namespace nlos
