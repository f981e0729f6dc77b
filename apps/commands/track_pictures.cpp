// SPDX-License-Identifier: MIT
#include "apps/commands/track_pictures.h"

#include "calib/track/track_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace apps {
namespace {

using core::Vec2;
using core::Vec3;
using Point = std::array<double, 2>;

constexpr nlos::Colour kWallColour{60, 64, 72};
constexpr nlos::Colour kSpotColour{222, 140, 40};
constexpr nlos::Colour kSensorColour{190, 40, 60};
constexpr nlos::Colour kStartColour{30, 140, 80};
constexpr std::array kPathColours{nlos::Colour{37, 99, 180},
                                  nlos::Colour{150, 60, 160},
                                  nlos::Colour{20, 140, 140},
                                  nlos::Colour{160, 110, 20}};
constexpr double kChi2_95_2d = 5.991464547107979;
constexpr std::size_t kMostEllipses = 40;
constexpr double kMargin_m = 0.15;

struct View {
    const char* title;
    int across;
    int up;
    const char* up_label;
};

class Plan {
 public:
    Plan(const View& view, const calib::TrackSensor& sensor)
        : view_(view), wall_from_world_(sensor.wall.world_from_wall().inverse()) {
        panel_.title = view.title;
        panel_.x_label = nlos::kWallX;
        panel_.y_label = view.up_label;
    }

    Point place(const Vec3& world) const {
        const Vec3 p = wall_from_world_ * world;
        return {p[view_.across], p[view_.up]};
    }

    void line(std::vector<Point> points, nlos::Colour colour, int thickness, double fill) {
        for (const Point& p : points) extent_.extend(Vec2(p[0], p[1]));
        panel_.lines.push_back({std::move(points), colour, thickness, fill});
    }

    void mark(const Point& p, double radius_m, nlos::Colour colour) {
        line(circle(p, radius_m * Eigen::Matrix2d::Identity()), colour, 2, 0.9);
    }

    void ellipse(const Vec3& world, const core::Mat3& covariance, nlos::Colour colour) {
        const core::Mat3 turned =
            wall_from_world_.linear() * covariance * wall_from_world_.linear().transpose();
        // A root of the view's part, by Cholesky: its circle is the ellipse.
        const double a = std::sqrt(turned(view_.across, view_.across));
        const double b = turned(view_.across, view_.up) / a;
        const double c = std::sqrt(std::max(0.0, turned(view_.up, view_.up) - b * b));
        Eigen::Matrix2d root;
        root << a, 0.0, b, c;
        root *= std::sqrt(kChi2_95_2d);
        line(circle(place(world), root), colour, 1, 0.08);
    }

    void legend(const std::string& name, nlos::Colour colour) {
        panel_.legend.emplace_back(name, colour);
    }

    nlos::DrawingPanel finished() {
        panel_.x_range = {extent_.min().x() - kMargin_m, extent_.max().x() + kMargin_m};
        panel_.y_range = {extent_.min().y() - kMargin_m, extent_.max().y() + kMargin_m};
        return std::move(panel_);
    }

 private:
    static std::vector<Point> circle(const Point& center, const Eigen::Matrix2d& shape) {
        constexpr int kCorners = 48;
        std::vector<Point> points;
        for (int i = 0; i <= kCorners; ++i) {
            const double angle = 2.0 * core::kPi * i / kCorners;
            const Vec2 p =
                Vec2(center[0], center[1]) + shape * Vec2(std::cos(angle), std::sin(angle));
            points.push_back({p.x(), p.y()});
        }
        return points;
    }

    View view_;
    core::Transform wall_from_world_;
    nlos::DrawingPanel panel_;
    Eigen::AlignedBox2d extent_;
};

void draw_wall(const calib::TrackSettings& settings, const calib::TrackSensor& sensor, Plan& plan) {
    const core::SensorFootprints footprints = footprints_at(sensor, settings.pose.whole());
    Eigen::AlignedBox2d spots;
    for (const core::ZoneFootprint& zone : footprints.zones) {
        for (const Vec3& p : zone.seen.positions) {
            const Point spot = plan.place(p);
            spots.extend(Vec2(spot[0], spot[1]));
        }
    }
    plan.line({{spots.min().x() - kMargin_m, spots.min().y()},
               {spots.max().x() + kMargin_m, spots.min().y()}},
              kWallColour,
              spots.sizes().y() < 1e-6 ? 8 : 0,
              0.0);
    plan.legend("wall", kWallColour);
    for (const core::ZoneFootprint& zone : footprints.zones) {
        if (zone.center_m) plan.mark(plan.place(*zone.center_m), 0.015, kSpotColour);
    }
    plan.legend("middle of a zone", kSpotColour);
}

/// What is known of the way of the sensor, or where the target stands if this is to be found.
void draw_known(const std::vector<calib::FrameEstimate>& frames,
                const calib::TrackSettings& settings,
                Plan& plan) {
    if (settings.moves_sensor()) {
        plan.mark(plan.place(*settings.target.position_m), 0.03, kSensorColour);
        plan.legend("target, which stands", kSensorColour);
        return;
    }
    std::vector<Point> way;
    for (const calib::FrameEstimate& frame : frames) {
        if (frame.pose) way.push_back(plan.place(frame.pose->position_m));
    }
    if (way.empty()) return;
    plan.line(way, kSensorColour, 3, 0.0);
    plan.mark(way.front(), 0.03, kSensorColour);
    plan.legend("sensor", kSensorColour);
}

void draw_paths(const std::vector<calib::FrameEstimate>& frames,
                const calib::TrackSettings& settings,
                Plan& plan) {
    std::map<int, std::vector<const calib::TargetEstimate*>> paths;
    for (const calib::FrameEstimate& frame : frames) {
        for (const calib::TargetEstimate& target : frame.targets) {
            if (target.is_named) paths[target.id].push_back(&target);
        }
    }
    const auto colour_of = [](int id) {
        return kPathColours[static_cast<std::size_t>(id - 1) % kPathColours.size()];
    };
    for (const auto& [id, path] : paths) {
        const std::size_t step = (path.size() + kMostEllipses - 1) / kMostEllipses;
        for (std::size_t i = 0; i < path.size(); i += step) {
            plan.ellipse(calib::reported_position_m(*path[i], settings),
                         calib::reported_covariance_m2(*path[i], settings),
                         colour_of(id));
        }
    }
    const char* moving = settings.moves_sensor() ? "sensor" : "target";
    for (const auto& [id, path] : paths) {
        std::vector<Point> line;
        for (const auto* target : path)
            line.push_back(plan.place(calib::reported_position_m(*target, settings)));
        const Point first = line.front();
        plan.line(std::move(line), colour_of(id), 4, 0.0);
        plan.mark(first, 0.02, kStartColour);
        plan.legend(fmt::format("{} {} with 95 % ellipses", moving, id), colour_of(id));
    }
    if (!paths.empty()) plan.legend("first named", kStartColour);
}

nlos::ImagePanel rows_panel(const std::string& title,
                            const calib::TrackSensor& sensor,
                            const std::vector<double>& values) {
    nlos::ImagePanel panel;
    panel.title = title;
    panel.width = static_cast<std::size_t>(sensor.axis.num_bins);
    panel.height = sensor.num_zones();
    panel.values.assign(values.begin(), values.end());
    panel.x_range = {sensor.axis.opl_start_m, sensor.axis.opl_end_m()};
    panel.y_range = {0.0, static_cast<double>(sensor.num_zones())};
    panel.x_label = "path length [m]";
    panel.y_label = "zone";
    panel.value_label = "counts";
    panel.aspect = nlos::AspectRatio::Free;
    return panel;
}

}  // namespace

std::vector<nlos::Panel> track_panels(const std::vector<calib::FrameEstimate>& frames,
                                      const calib::TrackSettings& settings,
                                      const calib::TrackSensor& sensor,
                                      const ExplainedFrame& shown) {
    std::vector<nlos::Panel> panels;
    for (const View& view : {View{"Top view: wall below", 0, 2, nlos::kWallDepth},
                             View{"Front view, onto the wall", 0, 1, nlos::kWallY}}) {
        Plan plan(view, sensor);
        draw_wall(settings, sensor, plan);
        draw_known(frames, settings, plan);
        draw_paths(frames, settings, plan);
        panels.emplace_back(plan.finished());
    }
    if (shown.counts.empty()) return panels;
    std::vector<double> data(shown.counts.size());
    std::vector<double> model(shown.counts.size());
    double most = 0.0;
    for (std::size_t i = 0; i < data.size(); ++i) {
        data[i] = std::max(0.0, shown.counts[i] - shown.background[i]);
        model[i] = shown.signal[i];
        if (model[i] > 0.0) most = std::max({most, data[i], model[i]});
    }
    nlos::ImagePanel counted = rows_panel(
        fmt::format("Counts over the background at {:.3g} s", shown.time_s), sensor, data);
    nlos::ImagePanel explained = rows_panel("What the targets explain", sensor, model);
    if (most > 0.0) counted.value_range = explained.value_range = std::array{0.0, most};
    panels.emplace_back(std::move(counted));
    panels.emplace_back(std::move(explained));
    return panels;
}

}  // namespace apps
