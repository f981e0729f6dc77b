// SPDX-License-Identifier: MIT
#include "nlos/pictures/picture.h"

#include "nlos/pictures/panel_drawing.h"
#include "renderer/core/error.h"
#include "renderer/core/file_suffix.h"
#include "renderer/core/system/output_file.h"

#include <algorithm>
#include <filesystem>
#include <numeric>

namespace nlos {
namespace {

constexpr int kOuterMargin = 28;  // [px]
constexpr int kSlack = 44;        // [px]: panels that nearly stand in a row keep their order
constexpr Colour kPaper{255, 255, 255};

/// Where panels stand: each in the first column that is about the shortest so far, every column as
/// wide as its widest panel. Panels of one height make rows.
struct PanelLayout {
    std::vector<std::size_t> column;  ///< of each panel
    std::vector<int> top;             ///< of each panel
    std::vector<int> widths;          ///< of the columns
    std::vector<int> heights;         ///< of the columns

    PanelLayout(const std::vector<Panel>& panels, std::size_t columns)
        : widths(columns, 0), heights(columns, kOuterMargin) {
        for (const Panel& panel : panels) {
            const PixelSize size = panel_size(panel);
            const int least = *std::ranges::min_element(heights) + kSlack;
            const auto next = std::ranges::find_if(heights, [&](int y) { return y <= least; });
            column.push_back(static_cast<std::size_t>(next - heights.begin()));
            top.push_back(*next);
            *next += size.height;
            widths[column.back()] = std::max(widths[column.back()], size.width);
        }
    }

    int left(std::size_t of_column) const {
        return std::accumulate(
            widths.begin(), widths.begin() + static_cast<std::ptrdiff_t>(of_column), kOuterMargin);
    }
    PixelSize size() const {
        return {left(widths.size()) + kOuterMargin,
                *std::ranges::max_element(heights) + kOuterMargin};
    }
};

}  // namespace

PictureFormat picture_format(const std::string& path) {
    const std::string suffix = core::file_suffix(path);
    if (suffix == ".png") return PictureFormat::Png;
    if (suffix == ".svg") return PictureFormat::Svg;
    if (suffix == ".pdf") return PictureFormat::Pdf;
    throw core::Error(
        path, "has the suffix '" + suffix + "'", "must be one of .png, .svg, .pdf for a picture");
}

std::string encode_panels(const std::vector<Panel>& panels, int columns, PictureFormat format) {
    if (panels.empty()) throw core::Error("picture", "found no panel", "must have at least one");
    for (const Panel& panel : panels) check_panel(panel);

    const PanelLayout layout(
        panels, std::min(static_cast<std::size_t>(std::max(1, columns)), panels.size()));
    Canvas canvas(layout.size().width, layout.size().height, kPaper, format);
    for (std::size_t i = 0; i < panels.size(); ++i) {
        draw_panel(canvas, layout.left(layout.column[i]), layout.top[i], panels[i]);
    }
    return canvas.finish();
}

void write_panels(const std::string& path, const std::vector<Panel>& panels, int columns) {
    core::write_text_file(path, encode_panels(panels, columns, picture_format(path)));
}

void check_picture_suffix(const std::string& path) {
    if (!path.empty()) picture_format(path);
}

}  // namespace nlos
