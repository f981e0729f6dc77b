// SPDX-License-Identifier: MIT
#include "nlos/layouts/layout_capture.h"

#include "nlos/layouts/layout_histograms.h"
#include "renderer/core/error.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using core::Capture;
using core::Error;
using core::Vec3;

/// Laser and detector, and whether lengths start and end there.
void read_devices(const LayoutFiles& files,
                  const Layout& layout,
                  const CaptureReadSettings& settings,
                  Capture& capture) {
    const LayoutDevices& devices = layout.devices;
    const auto position = [&](const std::string& array, Vec3& value) {
        if (array.empty() || !files.has(array)) return false;
        const std::vector<double> values = files.read(array);
        if (values.size() != 3) {
            throw Error(files.where(array),
                        fmt::format("holds {} values", values.size()),
                        "must be the three coordinates of a position [m]");
        }
        value = Vec3(values.data());
        return true;
    };
    core::WallScan& scan = capture.scan.wall();
    bool known = position(devices.laser, scan.laser_position);
    known = position(devices.detector, scan.detector_position) && known;
    if (!devices.position_m.empty()) {
        scan.laser_position = scan.detector_position = Vec3(devices.position_m.data());
        known = true;
    }
    std::optional<double> distance_m = settings.distance_m;
    if (!distance_m) distance_m = files.number(devices.distance_m, "capture.distance_m");
    if (distance_m) {
        scan.laser_position = scan.detector_position = Vec3(0.0, 0.0, *distance_m);
        known = true;
    }
    bool included = devices.legs_included || settings.distance_m;
    if (const auto excluded = files.number(devices.legs_excluded, "capture.opl_origin")) {
        included = *excluded == 0.0;
    }
    if (included && !known) {
        throw Error(files.where(devices.laser + ", " + devices.detector),
                    "are missing",
                    "must be there, for path lengths include the segments to the devices");
    }
    scan.opl_origin = included ? core::OplOrigin::Device : core::OplOrigin::RelayWall;
}

/// Keeps the observed bins of frames that do not all have those of the last, the capture's own.
void keep_observed(std::vector<core::ObservedBins> observed, Capture& capture) {
    if (std::ranges::count(observed, observed.back()) == std::ssize(observed)) return;
    capture.sequence->observed = std::move(observed);
}

void keep_frames(std::vector<core::Transient> frames, Capture& capture) {
    capture.transient = frames.back();
    if (frames.size() == 1) return;
    capture.sequence.emplace();
    capture.sequence->frames = std::move(frames);
}

/// Keeps light by order of bounces, but for orders without any.
void keep_orders(std::vector<core::Transient> by_order, int first_order, Capture& capture) {
    for (std::size_t i = 0; i < by_order.size(); ++i) {
        if (by_order[i].is_dark()) continue;
        capture.orders.push_back(first_order + static_cast<int>(i));
        capture.by_order.push_back(std::move(by_order[i]));
    }
}

void describe(const LayoutFiles& files, const Layout& layout, Capture& capture) {
    capture.scene_info["original_format"] = layout.title;
    for (const std::string& name : layout.keep) {
        constexpr std::size_t kLongest = 4096;
        if (!files.has(name)) continue;
        if (total_bytes(files.shape(name), 1) <= kLongest) {
            capture.scene_info["arrays"][name] = files.read(name);
        }
    }
    const auto number = [&](const LayoutNumber& described, const char* what) {
        const bool is_there =
            described.value || (!described.array.empty() && files.has(described.array));
        return is_there ? files.number(described, what) : std::nullopt;
    };
    if (const auto fwhm_s = number(layout.response_fwhm_s, "response")) {
        capture.scene_info["detector"]["response"]["jitter_fwhm_ps"] = *fwhm_s * 1e12;
    }
    if (const auto fwhm_m = number(layout.spot_fwhm_m, "solver.spot_m")) {
        capture.scene_info["detector"]["spot_m"] = *fwhm_m;
    }
    capture.notes.push_back(fmt::format("layout {}{}{}",
                                        layout.name,
                                        layout.source.empty() ? "" : " " + layout.source,
                                        layout.tried ? "" : ", never tried on a file of others"));
    capture.notes.insert(capture.notes.end(), layout.notes.begin(), layout.notes.end());
}

void read_unit(const LayoutFiles& files, const LayoutHistogram& layout, Capture& capture) {
    capture.unit = layout.unit;
    if (const auto is_counts = files.number(layout.is_counts, "capture.unit")) {
        capture.unit =
            *is_counts == 0.0 ? core::TransientUnit::Radiance : core::TransientUnit::Counts;
    }
    const auto is_whole = [](float value) { return value == std::trunc(value); };
    if (!layout.is_counts.is_given() && capture.unit == core::TransientUnit::Counts &&
        !std::ranges::all_of(capture.transient.values(), is_whole)) {
        capture.unit = core::TransientUnit::Radiance;
        capture.notes.emplace_back(
            "counts that are no whole numbers, such as averages, are taken for radiance");
    }
    const auto scale = files.number(layout.counts_per_radiance, "counts_per_radiance");
    if (scale && *scale > 0.0) capture.counts_per_radiance = *scale;
}

Capture read_one(const std::string& path,
                 const Layout& layout,
                 const CaptureReadSettings& settings) {
    const LayoutFiles files(path);
    const auto array = find_histograms(files, layout);
    if (!array) {
        throw Error(
            path,
            fmt::format(
                "is not of layout {}: {}", layout.name, fmt::join(mismatches(files, layout), ", ")),
            "must hold what the layout says");
    }
    Capture capture;
    read_devices(files, layout, settings, capture);
    const PairNumbers numbers = read_pairs(files, layout, *array, settings, capture.scan.wall());
    capture.time_axis = read_axis(files, layout.bins, *array->extent("t"), settings);
    Histograms histograms =
        read_histograms(files, *array, numbers, capture.scan.num_pairs(), settings.frame);
    keep_frames(std::move(histograms.frames), capture);
    keep_orders(std::move(histograms.by_order), layout.histogram.first_order, capture);
    read_unit(files, layout.histogram, capture);
    describe(files, layout, capture);
    const core::BinRange lit = lit_bins(capture);
    const auto& background = layout.histogram.background;
    if (!background.empty() && std::all_of(background.begin(),
                                           background.end(),
                                           [&](const auto& name) { return files.has(name); })) {
        core::for_each_transient(capture, [&](const char*, core::Transient& transient, int) {
            subtract_background(files, background, transient);
        });
        capture.notes.push_back(
            fmt::format("the mean of {} is subtracted", fmt::join(background, ", ")));
    }
    if (layout.bins.zeros_are_unobserved) core::restrict_observed(capture, lit);
    const auto& shift = layout.bins.shift;
    if (shift && (shift->required || files.has(shift->array))) {
        take_off_delays(read_delays(files, *shift, *array, numbers), capture);
        capture.notes.push_back(fmt::format("the delays in {} are taken off", shift->array));
    }
    return capture;
}

}  // namespace

Capture read_layout_capture(const LayoutSource& source, const CaptureReadSettings& settings) {
    if (source.files.size() == 1) return read_one(source.files[0], source.layout, settings);
    if (settings.frame) {
        const auto wanted = static_cast<std::size_t>(*settings.frame);
        if (wanted >= source.files.size()) {
            throw Error("capture.frame",
                        fmt::format("found {}", *settings.frame),
                        fmt::format("must be less than the {} frames", source.files.size()));
        }
        CaptureReadSettings of_file = settings;
        of_file.frame.reset();
        return read_one(source.files[wanted], source.layout, of_file);
    }
    std::vector<core::Transient> frames;
    std::vector<core::ObservedBins> observed;
    Capture capture;
    for (const std::string& file : source.files) {
        Capture frame = read_one(file, source.layout, settings);
        if (!frames.empty() && (frame.scan.num_pairs() != frames[0].num_pairs() ||
                                frame.transient.num_bins() != frames[0].num_bins())) {
            throw Error(
                file,
                fmt::format(
                    "has {} pairs of {} bins", frame.scan.num_pairs(), frame.transient.num_bins()),
                fmt::format("must have {} pairs of {} bins, as the frames before",
                            frames[0].num_pairs(),
                            frames[0].num_bins()));
        }
        frames.push_back(frame.transient);
        observed.push_back(frame.observed);
        capture = std::move(frame);
    }
    keep_frames(std::move(frames), capture);
    keep_observed(std::move(observed), capture);
    capture.notes.push_back(fmt::format(
        "{} files are frames; the wall points are those of the last", source.files.size()));
    return capture;
}

std::vector<std::string> open_questions(const Layout& layout, const CaptureReadSettings& settings) {
    std::vector<std::string> questions;
    const auto ask = [&](const LayoutNumber& number, bool is_given, const char* setting) {
        if (!number.ask.empty() && !is_given) {
            questions.push_back(fmt::format("{}=... ({})", setting, number.ask));
        }
    };
    ask(layout.bins.width_m, settings.bin_width_m.has_value(), "capture.bin_width_m");
    ask(layout.bins.width_s, settings.bin_width_m.has_value(), "capture.bin_width_m");
    ask(layout.devices.distance_m, settings.distance_m.has_value(), "capture.distance_m");
    const auto ask_points = [&](const LayoutPoints& points) {
        ask(points.pitch_m, settings.pitch_m.has_value(), "capture.pitch_m");
        if (!points.grid) return;
        const bool has_size = settings.wall_size_m.has_value();
        for (const auto& number : points.grid->size_m) {
            ask(number, has_size, "capture.wall_size_m");
            break;
        }
        for (const auto& number : points.grid->pitch_m) {
            ask(number, has_size || settings.pitch_m, "capture.pitch_m");
            break;
        }
    };
    ask_points(layout.sensing);
    if (layout.pattern != LayoutPattern::Confocal) ask_points(layout.illumination);
    std::sort(questions.begin(), questions.end());
    questions.erase(std::unique(questions.begin(), questions.end()), questions.end());
    return questions;
}

}  // namespace nlos
