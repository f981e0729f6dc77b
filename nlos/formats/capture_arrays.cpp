// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_arrays.h"

#include "nlos/formats/ytal_layout.h"
#include "renderer/core/settings/settings_json.h"

namespace nlos {

using core::WallPoints;

ArrayLayout array_layout(const core::Scan& scan) {
    return scan.visit(
        [](const core::WallScan& points) -> ArrayLayout {
            // A single illumination point is a grid of one by one as well.
            const WallPoints& lit = points.illumination;
            const bool fits = !points.is_exhaustive() || lit.grid || lit.size() == 1;
            return {points.is_exhaustive(), points.sensing.grid && fits};
        },
        [](const core::ImageScan&) -> ArrayLayout {
            return {false, true};
        });
}

Shape point_extents(const WallPoints& points, const ArrayLayout& layout) {
    if (!layout.grids) return {points.size()};
    const auto grid = points.grid.value_or(std::array<std::size_t, 2>{1, 1});
    return {grid[0], grid[1]};
}

Shape histogram_shape(const core::Capture& capture) {
    Shape shape{static_cast<std::size_t>(capture.time_axis.num_bins)};
    const auto append = [&](const Shape& extents) {
        shape.insert(shape.end(), extents.begin(), extents.end());
    };
    const ArrayLayout layout = array_layout(capture.scan);
    capture.scan.visit(
        [&](const core::WallScan& scan) {
            if (layout.exhaustive) append(point_extents(scan.illumination, layout));
            append(point_extents(scan.sensing, layout));
        },
        [&](const core::ImageScan& image) { append(image.pair_extents()); });
    return shape;
}

core::Json scene_info_of(const core::Capture& capture) {
    core::Json scene_info = *capture.scene_info;
    if (const auto* image = capture.scan.as<core::ImageScan>()) {
        scene_info[kCameraKey] = core::write_value(image->camera);
    }
    return scene_info;
}

std::vector<int> observed_array(const std::vector<core::BinRange>& observed) {
    std::vector<int> bins;
    for (const core::BinRange& range : observed) bins.push_back(range.begin);
    for (const core::BinRange& range : observed) bins.push_back(range.end);
    return bins;
}

std::vector<int> observed_array_of_frames(const core::Capture& capture) {
    std::vector<int> bins;
    for (std::size_t frame = 0; frame < capture.sequence->frames.size(); ++frame) {
        std::vector<core::BinRange> ranges;
        for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
            ranges.push_back(core::observed_range(
                capture.observed_in_frame(frame), pair, capture.time_axis.num_bins));
        }
        const std::vector<int> of_frame = observed_array(ranges);
        bins.insert(bins.end(), of_frame.begin(), of_frame.end());
    }
    return bins;
}

namespace {

/// Visits bins [first, first + count) of all pairs, each with its place in rows with time slowest:
/// one cache line of every row at a time.
template <class AnyTransient, class Visit>
void for_each_row_value(AnyTransient& transient,
                        std::size_t first,
                        std::size_t count,
                        Visit&& visit) {
    constexpr std::size_t kPairsAtOnce = 16;
    const std::size_t pairs = transient.num_pairs();
    for (std::size_t begin = 0; begin < pairs; begin += kPairsAtOnce) {
        const std::size_t end = std::min(pairs, begin + kPairsAtOnce);
        for (std::size_t row = 0; row < count; ++row) {
            for (std::size_t pair = begin; pair < end; ++pair) {
                visit(transient.histogram(pair)[first + row], row * pairs + pair);
            }
        }
    }
}

}  // namespace

void copy_rows(const core::Transient& transient,
               std::size_t first,
               std::size_t count,
               float* rows) {
    for_each_row_value(
        transient, first, count, [&](float value, std::size_t index) { rows[index] = value; });
}

void copy_bins(const float* rows,
               std::size_t first,
               std::size_t count,
               core::Transient& transient) {
    for_each_row_value(
        transient, first, count, [&](float& value, std::size_t index) { value = rows[index]; });
}

void copy_stack(const std::vector<core::Transient>& stack,
                std::size_t first,
                std::size_t count,
                float* rows) {
    for (std::size_t i = first; i < first + count; ++i) {
        copy_rows(stack[i], 0, stack[i].num_bins(), rows);
        rows += stack[i].values().size();
    }
}

}  // namespace nlos
