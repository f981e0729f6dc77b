// SPDX-License-Identifier: MIT
#include "apps/commands/fit_pictures.h"

#include "calib/statistics/poisson_deviance.h"
#include "nlos/pictures/light_scale.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace apps {
namespace {

using core::Vec3;

// Rows of a picture; more wall points are averaged in groups.
constexpr std::size_t kMaxRows = 256;
constexpr double kCellsAcross = 90.0;

// Colours that colour-blind people tell apart [Wong2011].
constexpr nlos::Colour kTruth = nlos::kSeriesColours[0];
constexpr nlos::Colour kFit = nlos::kSeriesColours[1];
constexpr nlos::Colour kBoth{90, 90, 90};

nlos::ImagePanel rows_panel(const calib::FitResult& result,
                            const std::array<std::size_t, 2>& bins,
                            const std::string& title) {
    nlos::ImagePanel panel;
    panel.title = title;
    panel.width = bins[1] - bins[0];
    panel.x_range = {result.axis.bin_begin_m(static_cast<double>(bins[0])),
                     result.axis.bin_begin_m(static_cast<double>(bins[1]))};
    panel.x_label = "path length [m]";
    panel.y_label = "pair";
    panel.aspect = nlos::AspectRatio::Free;
    return panel;
}

/// First and one past the last bin in which the model has light from the scene: more than the least
/// that there is, which is ambient.
std::array<std::size_t, 2> lit_bins(const calib::FitResult& result) {
    std::vector<double> light(static_cast<std::size_t>(result.axis.num_bins), 0.0);
    for (std::size_t i = 0; i < result.model.size(); ++i)
        light[i % light.size()] += result.model[i];
    const double ambient = *std::min_element(light.begin(), light.end());
    for (double& value : light) value -= ambient;
    return nlos::shown_bins(light);
}

/// What a picture lays over each other, in the wall's frame [m].
struct Overlay {
    std::vector<Vec3> truth;
    std::vector<Vec3> fit;
};

std::vector<Vec3> moved(const core::Transform& transform, std::vector<Vec3> points) {
    for (Vec3& point : points) point = transform * point;
    return points;
}

Eigen::AlignedBox3d box_around(const Overlay& overlay) {
    Eigen::AlignedBox3d box;
    for (const auto* points : {&overlay.truth, &overlay.fit}) {
        for (const Vec3& p : *points) box.extend(p);
    }
    const double margin = 0.05 * box.sizes().maxCoeff() + 0.01;
    return {box.min().array() - margin, box.max().array() + margin};
}

// Cells that hold truth get 1, those that hold the fit 2 more.
nlos::ImagePanel overlay_view(
    const Overlay& overlay, const Eigen::AlignedBox3d& box, const char* title, int across, int up) {
    const std::array<const char*, 3> labels{nlos::kWallX, nlos::kWallY, nlos::kWallDepth};
    const double cell = box.sizes().maxCoeff() / kCellsAcross;
    nlos::ImagePanel panel;
    panel.title = title;
    const auto cells = [&](int axis) {
        return static_cast<std::size_t>(std::ceil(box.sizes()[axis] / cell));
    };
    panel.width = cells(across);
    panel.height = cells(up);
    panel.x_range = {box.min()[across],
                     box.min()[across] + cell * static_cast<double>(panel.width)};
    panel.y_range = {box.min()[up], box.min()[up] + cell * static_cast<double>(panel.height)};
    panel.x_label = labels[static_cast<std::size_t>(across)];
    panel.y_label = labels[static_cast<std::size_t>(up)];
    panel.categories = {{"truth", kTruth}, {"fit", kFit}, {"both", kBoth}};
    std::vector<int> marks(panel.width * panel.height, 0);
    const auto mark = [&](const std::vector<Vec3>& points, int bit) {
        for (const Vec3& p : points) {
            const auto x = static_cast<std::size_t>((p[across] - box.min()[across]) / cell);
            const auto y = static_cast<std::size_t>((p[up] - box.min()[up]) / cell);
            marks[y * panel.width + x] |= bit;
        }
    };
    mark(overlay.truth, 1);
    mark(overlay.fit, 2);
    panel.values.assign(marks.begin(), marks.end());
    return panel;
}

}  // namespace

std::vector<nlos::Panel> fit_panels(const calib::FitResult& result) {
    const auto bins = static_cast<std::size_t>(result.axis.num_bins);
    const std::size_t pairs = result.data.size() / bins;
    const std::size_t group = (pairs + kMaxRows - 1) / kMaxRows;
    const std::size_t rows = (pairs + group - 1) / group;
    const std::array<std::size_t, 2> shown = lit_bins(result);
    nlos::ImagePanel data = rows_panel(result, shown, "Data");
    nlos::ImagePanel model = rows_panel(result, shown, "Model");
    nlos::ImagePanel residual = rows_panel(result, shown, "Data − model");
    const bool is_poisson = result.residual == "poisson";
    for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t bin = shown[0]; bin < shown[1]; ++bin) {
            double counted = 0.0;
            double expected = 0.0;
            for (std::size_t i = row * group; i < std::min(pairs, (row + 1) * group); ++i) {
                counted += result.data[i * bins + bin];
                expected += result.model[i * bins + bin];
            }
            data.values.push_back(static_cast<float>(counted));
            model.values.push_back(static_cast<float>(expected));
            const double misfit = is_poisson && expected > 0.0
                                      ? -calib::signed_deviance(expected, counted).value
                                      : counted - expected;
            residual.values.push_back(static_cast<float>(misfit));
        }
    }
    const float most = *std::max_element(data.values.begin(), data.values.end());
    double widest = 0.0;
    for (const float value : residual.values) {
        widest = std::max(widest, std::abs(static_cast<double>(value)));
    }
    for (nlos::ImagePanel* panel : {&data, &model, &residual}) {
        panel->height = rows;
        panel->y_range = {0.0, static_cast<double>(pairs)};
    }
    data.value_range = model.value_range = std::array{0.0, static_cast<double>(most)};
    data.value_label = model.value_label = is_poisson ? "counts" : "value";
    residual.value_label = is_poisson ? "standard deviations" : "value";
    residual.colour_map = nlos::ColourMap::Diverging;
    residual.value_range = std::array{-widest, widest};
    return {data, model, residual};
}

std::vector<nlos::Panel> overlay_panels(const calib::FitErrors& errors,
                                        const core::Transform& world_from_wall) {
    const core::Transform wall_from_world = world_from_wall.inverse(Eigen::Isometry);
    const Overlay overlay{moved(wall_from_world, errors.true_points.positions),
                          moved(wall_from_world, errors.fitted_points.positions)};
    if (overlay.truth.empty() && overlay.fit.empty()) return {};
    const Eigen::AlignedBox3d box = box_around(overlay);
    nlos::ImagePanel front = overlay_view(overlay, box, "Front (seen from the wall)", 0, 1);
    nlos::ImagePanel side = overlay_view(overlay, box, "Side (along wall x)", 2, 1);
    nlos::ImagePanel top = overlay_view(overlay, box, "Top (along wall y)", 0, 2);
    front.x_direction = top.x_direction = nlos::AxisDirection::Reversed;
    return {front, side, top};
}

}  // namespace apps
