// SPDX-License-Identifier: MIT
#include "nlos/pictures/picture.h"

#include "nlos/pictures/panel_drawing.h"
#include "renderer/core/error.h"
#include "renderer/core/output_file.h"

#include <algorithm>
#include <filesystem>
#include <numeric>

namespace nlos {
namespace {

constexpr int kOuterMargin = 28;  // [px]
constexpr Colour kPaper{255, 255, 255};

/// A table of panels: every column as wide as its widest panel, every row as high as its highest.
struct PanelTable {
    std::vector<int> widths;
    std::vector<int> heights;

    PixelSize size() const {
        return {std::accumulate(widths.begin(), widths.end(), 2 * kOuterMargin),
                std::accumulate(heights.begin(), heights.end(), 2 * kOuterMargin)};
    }
};

PanelTable table_of(const std::vector<Panel>& panels, std::size_t columns) {
    PanelTable table{std::vector<int>(columns, 0),
                     std::vector<int>((panels.size() + columns - 1) / columns, 0)};
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const PixelSize size = panel_size(panels[i]);
        int& width = table.widths[i % columns];
        int& height = table.heights[i / columns];
        width = std::max(width, size.width);
        height = std::max(height, size.height);
    }
    return table;
}

}  // namespace

PictureFormat picture_format(const std::string& path) {
    const std::string suffix = std::filesystem::path(path).extension().string();
    if (suffix == ".png") return PictureFormat::Png;
    if (suffix == ".svg") return PictureFormat::Svg;
    if (suffix == ".pdf") return PictureFormat::Pdf;
    throw core::Error(
        path, "has the suffix '" + suffix + "'", "must be one of .png, .svg, .pdf for a picture");
}

std::string encode_panels(const std::vector<Panel>& panels, int columns, PictureFormat format) {
    if (panels.empty()) throw core::Error("picture", "found no panel", "must have at least one");
    for (const Panel& panel : panels) check_panel(panel);

    const std::size_t per_row =
        std::min(static_cast<std::size_t>(std::max(1, columns)), panels.size());
    const PanelTable table = table_of(panels, per_row);
    Canvas canvas(table.size().width, table.size().height, kPaper, format);
    int y = kOuterMargin;
    for (std::size_t row = 0; row < table.heights.size(); ++row) {
        int x = kOuterMargin;
        for (std::size_t i = row * per_row; i < std::min((row + 1) * per_row, panels.size()); ++i) {
            draw_panel(canvas, x, y, panels[i]);
            x += table.widths[i % per_row];
        }
        y += table.heights[row];
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
