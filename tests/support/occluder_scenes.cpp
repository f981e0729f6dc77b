// SPDX-License-Identifier: MIT
#include "tests/support/occluder_scenes.h"

#include "renderer/core/random.h"
#include "renderer/core/system/parallel.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace test_support {
namespace {

using core::Vec3;

constexpr std::size_t kPacket = renderer::SegmentPacket::kSize;

double between(core::Rng& rng, double low, double high) {
    return low + (high - low) * rng.uniform();
}

double between_log(core::Rng& rng, double low, double high) {
    return low * std::pow(high / low, rng.uniform());
}

std::vector<Vec3> wall_grid(int points) {
    std::vector<Vec3> positions;
    for (int i = 0; i < points; ++i) {
        for (int j = 0; j < points; ++j) {
            positions.emplace_back((i + 0.5) / points - 0.5, (j + 0.5) / points - 0.5, 0.0);
        }
    }
    return positions;
}

// Up to 100 points, so that pilot runs see all of some scans and a part of others.
core::WallScan random_scan(core::Rng& rng) {
    const double kind = rng.uniform();
    const int points = static_cast<int>(between(rng, 6.0, 11.0));
    if (kind < 0.6) return confocal_scan(wall_grid(points));
    if (kind < 0.8) {
        return single_scan({between(rng, -0.4, 0.4), between(rng, -0.4, 0.4), 0.0},
                           wall_grid(points));
    }
    return exhaustive_scan(wall_grid(2), wall_grid(points / 2));
}

// A sheet about `center`, tilted by up to about 30 degrees.
Parallelogram tilted_sheet(
    core::Rng& rng, const Vec3& center, double width, double height, double albedo) {
    const double turn = between(rng, 0.0, core::kPi);
    const Vec3 u =
        width * Vec3(std::cos(turn), std::sin(turn), between(rng, -0.4, 0.4)).normalized();
    const Vec3 v =
        height * Vec3(-std::sin(turn), std::cos(turn), between(rng, -0.4, 0.4)).normalized();
    return {center - 0.5 * (u + v), u, v, albedo};
}

// Slats of a frame whose sheet is `frame`: along v, `width` wide, one every `period`.
void add_slats(const Parallelogram& frame,
               double width,
               double period,
               std::vector<Parallelogram>& sheets) {
    const Vec3 across = frame.u.normalized();
    const int count = std::clamp(static_cast<int>(frame.u.norm() / period), 1, 400);
    for (int i = 0; i < count; ++i) {
        sheets.push_back(
            {frame.corner + i * period * across, width * across, frame.v, frame.albedo});
    }
}

void add_dots(core::Rng& rng,
              const Parallelogram& frame,
              double width,
              int count,
              std::vector<Parallelogram>& sheets) {
    const Vec3 u = width * frame.u.normalized();
    const Vec3 v = width * frame.v.normalized();
    for (int i = 0; i < count; ++i) {
        const Vec3 corner = frame.corner + rng.uniform() * frame.u + rng.uniform() * frame.v;
        sheets.push_back({corner, u, v, frame.albedo});
    }
}

// Weight and length of a path by way of a point, without visibility; a weight of 0: there is none.
struct Path {
    double weight = 0.0;
    double opl_m = 0.0;
};

Path path_by_way_of(const Vec3& p, const Vec3& normal, const Vec3& light, const Vec3& sensor) {
    const Vec3 to_light = light - p;
    const Vec3 to_sensor = sensor - p;
    const double side_light = normal.dot(to_light);
    const double side_sensor = normal.dot(to_sensor);
    if (to_light.z() >= 0.0 || to_sensor.z() >= 0.0 || side_light * side_sensor <= 0.0) return {};
    const double squared = to_light.squaredNorm() * to_sensor.squaredNorm();
    return {to_light.z() * to_sensor.z() * side_light * side_sensor / (squared * squared),
            to_light.norm() + to_sensor.norm()};
}

// Up to kPacket points of a sheet and what every wall point sees of them.
class PointPacket {
 public:
    PointPacket(const renderer::Scene& scene, const Vec3& normal)
        : scene_(scene), normal_(normal) {}

    void add(const Vec3& point) {
        ends_.set(points_.size(), point, normal_);
        points_.push_back(point);
    }
    bool is_full() const { return points_.size() == kPacket; }

    void add_to(const OccluderScene& setup, double weight, std::vector<double>& sums) {
        if (points_.empty()) return;
        const std::vector<std::uint32_t> from_lights = blocked_from(setup.scan.illumination);
        const std::vector<std::uint32_t> from_sensors = blocked_from(setup.scan.sensing);
        const core::TimeAxis& axis = setup.axis;
        for (std::size_t pair = 0; pair < setup.scan.num_pairs(); ++pair) {
            const std::size_t l = setup.scan.illumination_index(pair);
            const std::size_t s = setup.scan.sensing_index(pair);
            const std::uint32_t blocked = from_lights[l] | from_sensors[s];
            for (std::size_t i = 0; i < points_.size(); ++i) {
                if ((blocked >> i & 1U) != 0) continue;
                const Path path = path_by_way_of(points_[i],
                                                 normal_,
                                                 setup.scan.illumination.positions[l],
                                                 setup.scan.sensing.positions[s]);
                const double bin = std::floor((path.opl_m - axis.opl_start_m) / axis.bin_width_m);
                if (path.weight == 0.0 || bin < 0.0 || bin >= axis.num_bins) continue;
                sums[pair * static_cast<std::size_t>(axis.num_bins) +
                     static_cast<std::size_t>(bin)] += weight * path.weight;
            }
        }
        points_.clear();
    }

 private:
    std::vector<std::uint32_t> blocked_from(const core::WallPoints& wall) const {
        std::vector<std::uint32_t> blocked;
        for (std::size_t i = 0; i < wall.size(); ++i) {
            renderer::SegmentPacket packet;
            scene_.rays().aim(packet,
                              wall.positions[i],
                              wall.normals[i],
                              ends_.lanes(),
                              static_cast<int>(points_.size()));
            scene_.rays().trace(packet);
            blocked.push_back(packet.blocked);
        }
        return blocked;
    }

    const renderer::Scene& scene_;
    Vec3 normal_;
    std::vector<Vec3> points_;
    renderer::SegmentEnds ends_;
};

// Whether a point is on one of the first sheets: what lies at one place counts once.
bool is_on_sheets(const Vec3& point, const std::vector<Parallelogram>& sheets, std::size_t count) {
    constexpr double kSamePlane_m = 1e-9;
    return std::any_of(
        sheets.begin(),
        sheets.begin() + static_cast<std::ptrdiff_t>(count),
        [&](const Parallelogram& sheet) {
            const Vec3 normal = sheet.u.cross(sheet.v);
            const Vec3 way = point - sheet.corner;
            if (std::abs(way.dot(normal)) > kSamePlane_m * normal.norm()) return false;
            const double along_u = way.cross(sheet.v).dot(normal) / normal.squaredNorm();
            const double along_v = sheet.u.cross(way).dot(normal) / normal.squaredNorm();
            return along_u >= 0.0 && along_u <= 1.0 && along_v >= 0.0 && along_v <= 1.0;
        });
}

// One point in each cell of a grid on a sheet.
void sample_sheet(const OccluderScene& setup,
                  const renderer::Scene& scene,
                  std::size_t number,
                  double points_per_m2,
                  core::Rng rng,
                  std::vector<double>& sums) {
    const Parallelogram& sheet = setup.sheets[number];
    const Vec3 area = sheet.u.cross(sheet.v);
    const double per_m = std::sqrt(points_per_m2);
    const int rows = 1 + static_cast<int>(sheet.v.norm() * per_m);
    const int columns =
        1 + static_cast<int>(points_per_m2 * area.norm() / static_cast<double>(rows));
    const double weight =
        sheet.albedo * area.norm() / (std::pow(core::kPi, 3) * static_cast<double>(rows) * columns);
    PointPacket packet(scene, area.normalized());
    for (int i = 0; i < columns; ++i) {
        for (int j = 0; j < rows; ++j) {
            const Vec3 point = sheet.corner + (i + rng.uniform()) / columns * sheet.u +
                               (j + rng.uniform()) / rows * sheet.v;
            if (is_on_sheets(point, setup.sheets, number)) continue;
            packet.add(point);
            if (packet.is_full()) packet.add_to(setup, weight, sums);
        }
    }
    packet.add_to(setup, weight, sums);
}

std::vector<double> sampled_third_bounce(const OccluderScene& setup,
                                         const renderer::Scene& scene,
                                         double num_points,
                                         std::uint64_t seed) {
    double area = 0.0;
    for (const Parallelogram& sheet : setup.sheets) {
        if (sheet.albedo > 0.0) area += sheet.u.cross(sheet.v).norm();
    }
    std::vector<double> sums(setup.scan.num_pairs() *
                             static_cast<std::size_t>(setup.axis.num_bins));
    for (std::size_t i = 0; i < setup.sheets.size(); ++i) {
        if (setup.sheets[i].albedo == 0.0) continue;
        sample_sheet(setup, scene, i, num_points / area, core::Rng(seed, i, 0), sums);
    }
    return sums;
}

OccluderScene before_one_sheet(const std::string& name) {
    return {name,
            {{{-0.4, -0.3, 0.8}, {0.8, 0.0, 0.1}, {0.05, 0.7, 0.0}, 0.8}},
            confocal_scan(wall_grid(6)),
            {1.4, 0.016, 80}};
}

}  // namespace

renderer::Scene OccluderScene::scene() const {
    renderer::SceneGeometry geometry;
    for (const Parallelogram& sheet : sheets) {
        geometry.objects.push_back(parallelogram_object(sheet));
    }
    return {std::move(geometry), scan, {}};
}

OccluderScene random_occluder_scene(std::uint64_t number) {
    core::Rng rng(20'260, number, 0);
    OccluderScene setup;
    setup.scan = random_scan(rng);
    const double bin_width = 0.008 * std::pow(2.0, std::floor(between(rng, 0.0, 3.0)));
    setup.axis = {0.8, bin_width, static_cast<int>(3.2 / bin_width)};
    const int num_hidden = 1 + static_cast<int>(between(rng, 0.0, 3.0));
    for (int i = 0; i < num_hidden; ++i) {
        const Vec3 center(between(rng, -0.4, 0.4), between(rng, -0.4, 0.4), between(rng, 0.7, 1.2));
        setup.sheets.push_back(tilted_sheet(
            rng, center, between(rng, 0.15, 0.8), between(rng, 0.15, 0.8), between(rng, 0.3, 1.0)));
    }
    const double width = between_log(rng, 1e-3, 1.0);
    const double albedo = rng.uniform() < 0.75 ? 0.0 : 0.5;
    const Vec3 center(between(rng, -0.2, 0.2), between(rng, -0.2, 0.2), between(rng, 0.25, 0.5));
    const double size = std::max(2.0 * width, between(rng, 0.15, 0.8));
    const Parallelogram frame = tilted_sheet(rng, center, size, size, albedo);
    const double kind = rng.uniform();
    const double period = width * between(rng, 1.3, 5.0);
    std::string kind_name = "slats";
    if (kind < 0.6) add_slats(frame, width, period, setup.sheets);
    if (kind > 0.4 && kind < 0.6) {
        kind_name = "grid";
        add_slats({frame.corner, frame.v, frame.u, albedo}, width, period, setup.sheets);
    } else if (kind >= 0.6 && kind < 0.85) {
        kind_name = "dots";
        const double wanted = between(rng, 0.02, 0.5) * std::pow(size / width, 2);
        add_dots(rng, frame, width, std::clamp(static_cast<int>(wanted), 1, 5000), setup.sheets);
    } else if (kind >= 0.85) {
        kind_name = "panels";
        add_dots(rng, frame, width, 1 + static_cast<int>(between(rng, 0.0, 5.0)), setup.sheets);
    }
    setup.name = fmt::format("{} {} of {:.1f} mm", number, kind_name, 1e3 * width);
    return setup;
}

OccluderScene comb_of_thin_slats() {
    OccluderScene setup = before_one_sheet("comb");
    add_slats({{-0.4, -0.5, 0.4}, {0.8, 0.0, 0.0}, {0.0, 1.0, 0.0}, 0.0}, 2e-3, 4e-3, setup.sheets);
    return setup;
}

OccluderScene thousands_of_dots() {
    OccluderScene setup = before_one_sheet("dots");
    core::Rng rng(5'000, 0, 0);
    add_dots(
        rng, {{-0.4, -0.4, 0.4}, {0.8, 0.0, 0.0}, {0.0, 0.8, 0.0}, 0.0}, 4e-3, 5000, setup.sheets);
    return setup;
}

std::array<std::vector<double>, 2> sampled_third_bounces(const OccluderScene& setup,
                                                         const renderer::Scene& scene,
                                                         double num_points) {
    std::array<std::vector<double>, 2> truths;
    core::parallel_for(truths.size(), [&](std::size_t i) {
        truths[i] = sampled_third_bounce(setup, scene, num_points, i + 1);
    });
    return truths;
}

double error_against(const std::array<std::vector<double>, 2>& truths,
                     const core::Transient& transient) {
    double squared_error = 0.0;
    double squared_norm = 0.0;
    for (std::size_t i = 0; i < truths[0].size(); ++i) {
        const double value = double{transient.values()[i]};
        squared_error += (value - truths[0][i]) * (value - truths[1][i]);
        squared_norm += truths[0][i] * truths[1][i];
    }
    if (squared_norm == 0.0) return squared_error == 0.0 ? 0.0 : HUGE_VAL;  // nothing is lit
    return std::sqrt(std::max(0.0, squared_error) / squared_norm);
}

}  // namespace test_support
