// SPDX-License-Identifier: MIT
#include "nlos/layouts/layout_capture.h"

#include "nlos/layouts/layout_bins.h"
#include "nlos/layouts/layout_histograms.h"
#include "nlos/layouts/layout_points.h"
#include "renderer/core/error.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

namespace nlos {
namespace {

namespace fs = std::filesystem;
using core::Capture;
using core::Error;
using core::Vec3;

/// The histograms' axes along which points of one kind lie.
PointAxes point_axes(const LayoutFiles& files,
                     const HistogramArray& array,
                     const std::vector<std::string>& names) {
    PointAxes axes;
    axes.reversed = array.reversed;
    axes.first_index_fastest = files.first_index_fastest(array.name);
    for (std::size_t i = 0; i < array.axes.size(); ++i) {
        if (std::find(names.begin(), names.end(), array.axes[i]) == names.end()) continue;
        axes.names.push_back(array.axes[i]);
        axes.extents.push_back(array.extents[i]);
    }
    return axes;
}

bool are_same_points(const core::WallPoints& a, const core::WallPoints& b) {
    constexpr double kTolerance_m = 1e-5;  // files hold single precision
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!((a.positions[i] - b.positions[i]).norm() <= kTolerance_m)) return false;
    }
    return true;
}

core::ScanPattern pattern_of(const Layout& layout,
                             const core::Scan& scan,
                             const PairNumbers& numbers,
                             bool has_illumination_axes) {
    switch (layout.pattern) {
        case LayoutPattern::Single:
            return core::ScanPattern::Single;
        case LayoutPattern::Confocal:
            return core::ScanPattern::Confocal;
        case LayoutPattern::Exhaustive:
            return core::ScanPattern::Exhaustive;
        case LayoutPattern::ByPoints:
            break;
    }
    const bool pairwise = !has_illumination_axes && numbers.illumination.size() > 1;
    if (pairwise && are_same_points(scan.sensing, scan.illumination) &&
        numbers.sensing == numbers.illumination) {
        return core::ScanPattern::Confocal;
    }
    return scan.illumination.size() == 1 ? core::ScanPattern::Single
                                         : core::ScanPattern::Exhaustive;
}

void require_every_pair_once(const LayoutFiles& files,
                             const PairNumbers& numbers,
                             std::size_t num_pairs) {
    const std::size_t lit =
        numbers.listed ? 1 : std::max<std::size_t>(numbers.illumination.size(), 1);
    const bool exhaustive = numbers.pattern == core::ScanPattern::Exhaustive;
    std::vector<bool> seen(num_pairs, false);
    std::size_t entries = 0;
    for (std::size_t l = 0; l < (exhaustive ? lit : 1); ++l) {
        for (std::size_t s = 0; s < numbers.sensing.size(); ++s, ++entries) {
            const std::size_t pair = numbers.pair(l, s);
            if (pair >= num_pairs || seen[pair]) {
                throw Error(files.path(),
                            fmt::format("histogram {} repeats an earlier pair of points", entries),
                            "must have every pair once");
            }
            seen[pair] = true;
        }
    }
    if (entries != num_pairs) {
        throw Error(files.path(),
                    fmt::format("has {} histograms for {} pairs of points", entries, num_pairs),
                    "must pair every illumination with every sensing point, or be confocal");
    }
}

/// Where the points are and how they pair up.
PairNumbers read_points(const LayoutFiles& files,
                        const Layout& layout,
                        const HistogramArray& array,
                        const CaptureReadSettings& settings,
                        core::Scan& scan) {
    // The devices stand on the side of the wall on which the hidden scene is.
    const std::optional<Vec3> towards =
        scan.opl_origin == core::OplOrigin::Device
            ? std::optional<Vec3>(0.5 * (scan.laser_position + scan.detector_position))
            : std::nullopt;
    const PointAxes sensed = point_axes(files, array, {"x", "y", "sx", "sy", "s", "pair"});
    PlacedPoints sensing =
        place_points(files, layout.sensing, sensed, settings, towards, "sensing");
    PairNumbers numbers;
    numbers.sensing = std::move(sensing.of_entry);
    numbers.num_sensing = sensing.points.size();
    numbers.listed = array.extent("pair").has_value();
    scan.sensing = std::move(sensing.points);

    PointAxes lit = point_axes(files, array, {"lx", "ly", "l"});
    const bool has_illumination_axes = !lit.names.empty();
    if (numbers.listed || (layout.pattern == LayoutPattern::ByPoints && !has_illumination_axes)) {
        lit = sensed;  // each histogram has its own of both
    }
    if (layout.pattern == LayoutPattern::Confocal) {
        scan.illumination = scan.sensing;
        numbers.illumination = numbers.sensing;
    } else if (!layout.illumination.index.empty()) {
        std::vector<double> index = files.read(layout.illumination.index);
        if (sensed.names.size() == 2 && sensed.names[0].back() == 'y') {
            std::reverse(index.begin(), index.end());
        }
        const auto grid = scan.sensing.grid.value_or(std::array<std::size_t, 2>{0, 0});
        const bool inside = index.size() == 2 && index[0] >= 1 && index[1] >= 1 &&
                            index[0] <= static_cast<double>(grid[0]) &&
                            index[1] <= static_cast<double>(grid[1]);
        if (!inside) {
            throw Error(
                files.where(layout.illumination.index),
                fmt::format("found ({})", fmt::join(index, ", ")),
                fmt::format(
                    "must be a point of the {} x {} grid, counted from 1", grid[0], grid[1]));
        }
        const auto number = (static_cast<std::size_t>(index[0]) - 1) * grid[1] +
                            static_cast<std::size_t>(index[1]) - 1;
        scan.illumination = {{scan.sensing.positions[number]}, {scan.sensing.normals[number]}, {}};
        numbers.illumination = {0};
    } else {
        PlacedPoints placed =
            place_points(files, layout.illumination, lit, settings, towards, "illumination");
        scan.illumination = std::move(placed.points);
        numbers.illumination = std::move(placed.of_entry);
    }
    scan.pattern = pattern_of(layout, scan, numbers, has_illumination_axes);
    numbers.pattern = scan.pattern;
    require_every_pair_once(files, numbers, scan.num_pairs());
    return numbers;
}

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
    core::Scan& scan = capture.scan;
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
                    "must be there, for path lengths include the legs to the devices");
    }
    scan.opl_origin = included ? core::OplOrigin::Device : core::OplOrigin::RelayWall;
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
        const Shape shape = files.shape(name);
        std::size_t count = 1;
        for (const std::size_t extent : shape) count *= extent;
        if (count <= kLongest) capture.scene_info["arrays"][name] = files.read(name);
    }
    const LayoutNumber& fwhm = layout.response_fwhm_s;
    if (fwhm.value || (!fwhm.array.empty() && files.has(fwhm.array))) {
        const double fwhm_s = *files.number(fwhm, "response");
        capture.scene_info["detector"]["response"]["jitter_fwhm_ps"] = fwhm_s * 1e12;
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
    const PairNumbers numbers = read_points(files, layout, *array, settings, capture.scan);
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
        subtract_background(files, background, capture.transient);
        if (capture.sequence) {
            for (auto& frame : capture.sequence->frames) {
                subtract_background(files, background, frame);
            }
        }
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

std::vector<std::string> files_in(const std::string& folder) {
    constexpr std::size_t kMost = 100000;
    std::vector<std::string> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        if (files.size() < kMost && entry.is_regular_file()) files.push_back(entry.path().string());
    }
    std::sort(files.begin(), files.end());
    return files;
}

bool is_of(const std::string& file, const Layout& layout) {
    return container_of(file) && mismatches(LayoutFiles(file), layout).empty();
}

}  // namespace

std::optional<LayoutSource> find_layout_source(const std::string& path) {
    const bool is_folder = fs::is_directory(path);
    // A folder is what its first files are; more than these are not looked at.
    constexpr std::size_t kMostTried = 8;
    std::vector<std::string> candidates{path};
    if (is_folder) candidates = files_in(path);
    if (candidates.size() > kMostTried) candidates.resize(kMostTried);
    for (const std::string& candidate : candidates) {
        if (!container_of(candidate)) continue;
        const LayoutFiles files(candidate);
        for (const Layout& layout : shipped_layouts()) {
            if (!mismatches(files, layout).empty()) continue;
            return is_folder ? layout_source(path, layout) : LayoutSource{layout, {path}};
        }
    }
    return std::nullopt;
}

LayoutSource layout_source(const std::string& path, const Layout& layout) {
    if (!fs::is_directory(path)) return {layout, {path}};
    LayoutSource source{layout, {}};
    for (const std::string& file : files_in(path)) {
        if (!is_of(file, layout)) continue;
        source.files.push_back(file);
        if (!layout.files_are_frames) return source;
    }
    if (source.files.empty()) {
        throw Error(
            path, "holds no file of layout " + layout.name, "must be such a file or folder");
    }
    return source;
}

LayoutSource sequence_source(const std::vector<std::string>& files, const Layout& layout) {
    if (!layout.files_are_frames) {
        throw Error(files.front(),
                    fmt::format("is the first of {} files of layout {}", files.size(), layout.name),
                    "must stand alone: files of this layout are no frames of a sequence");
    }
    for (const std::string& file : files) {
        if (is_of(file, layout)) continue;
        throw Error(file, "is not of layout " + layout.name, "must be, as the frames before");
    }
    return {layout, files};
}

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
        capture = std::move(frame);
    }
    keep_frames(std::move(frames), capture);
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
