// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_array_reader.h"

#include "nlos/containers/file_memory.h"
#include "nlos/formats/capture_arrays.h"
#include "nlos/formats/ytal_layout.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>

namespace nlos {

using core::Capture;
using core::Error;

core::Transient make_transient(const ArrayReader& file,
                               const std::string& name,
                               const Capture& capture,
                               int num_bins) {
    const std::size_t pairs = capture.scan.num_pairs();
    require_memory(sizeof(float) * pairs * static_cast<std::size_t>(num_bins), file.where(name));
    return {pairs, num_bins};
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

namespace {

/// Reads delta_t and t_start, and the number of bins from H.
void read_time_axis(const ArrayReader& file,
                    const CaptureReadSettings& settings,
                    Capture& capture) {
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

/// The bins of each pair that were observed, of so many frames; validate() checks them against the
/// axis and histograms.
///
/// shape   of the array
std::vector<core::ObservedBins> read_observed_bins(const ArrayReader& file,
                                                   const std::string& name,
                                                   const Shape& shape,
                                                   std::size_t num_frames) {
    require_shape(file, name, shape);
    const std::vector<double> bins = file.read_doubles(name, shape);
    for (const double bin : bins) {
        if (bin == std::trunc(bin) && std::abs(bin) <= std::numeric_limits<int>::max()) continue;
        throw Error(file.where(name), fmt::format("found {}", bin), "must be bin numbers");
    }
    const std::size_t num_pairs = bins.size() / (2 * num_frames);
    std::vector<core::ObservedBins> observed(num_frames);
    for (std::size_t frame = 0; frame < num_frames; ++frame) {
        std::vector<core::BinRange>& ranges = observed[frame].emplace();
        const double* const begins = bins.data() + 2 * num_pairs * frame;
        for (std::size_t pair = 0; pair < num_pairs; ++pair) {
            ranges.push_back(
                {static_cast<int>(begins[pair]), static_cast<int>(begins[num_pairs + pair])});
        }
    }
    return observed;
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

void read_orders(const ArrayReader& file, const std::string& prefix, Capture& capture) {
    capture.by_order = read_stack(file, prefix + "H_by_order", capture);
    for (const double order : file.read_doubles(prefix + "orders", {capture.by_order.size()})) {
        capture.orders.push_back(static_cast<int>(order));
    }
}

}  // namespace

Capture read_histograms(const ArrayReader& file, const CaptureReadSettings& settings) {
    Capture capture;
    if (file.has("scene_info")) capture.scene_info = parse_scene_info(file.read_text("scene_info"));
    read_ytal_scan(file, capture);
    read_time_axis(file, settings, capture);
    capture.transient = read_transient(file, "H", capture);
    return capture;
}

double checked_scale(double counts_per_radiance, const std::string& where) {
    if (std::isfinite(counts_per_radiance) && counts_per_radiance > 0.0) return counts_per_radiance;
    throw Error(where, "is no positive number", "must be one positive number");
}

void read_optional_arrays(const ArrayReader& file, const std::string& prefix, Capture& capture) {
    const auto name = [&](const char* array) { return prefix + array; };
    Shape ranges = file.shape("H");
    ranges[0] = 2;
    if (file.has(name("observed_bins"))) {
        capture.observed = read_observed_bins(file, name("observed_bins"), ranges, 1).front();
    }
    if (file.has(name("H_by_order"))) read_orders(file, prefix, capture);
    if (file.has(name("frames"))) {
        const std::size_t count =
            capture.sequence.emplace(core::FrameSequence{read_stack(file, name("frames"), capture)})
                .frames.size();
        ranges.insert(ranges.begin(), count);
        if (file.has(name("frame_error"))) {
            capture.sequence->errors = file.read_doubles(name("frame_error"), {count});
        }
        if (count > 0 && file.has(name("frames_observed_bins"))) {
            capture.sequence->observed =
                read_observed_bins(file, name("frames_observed_bins"), ranges, count);
        }
    }
    if (!file.has(name("variance"))) return;
    require_shape(file, name("variance"), file.shape("H"));
    capture.variance = read_transient(file, name("variance"), capture);
    require_variances(file, name("variance"), *capture.variance);
}

}  // namespace nlos
