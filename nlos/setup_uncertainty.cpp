// SPDX-License-Identifier: MIT
#include "nlos/setup_uncertainty.h"

#include "nlos/reconstruction/column_peak.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/statistics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nlos {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A property of a set-up that nobody knows exactly.
struct SetupParameter {
    const char* name;
    std::optional<double> SetupSettings::*sigma;  ///< in its own unit
    double when_measured;                         ///< likewise, where nobody said
    double unit_m;                                ///< what one of it moves depths by, about
    const char* amount;                           ///< a format of an amount
    bool (*matters)(const core::WallScan& scan);
    void (*move)(core::Capture& capture, const core::Transform& world_from_wall, double amount);
};

bool always(const core::WallScan&) {
    return true;
}
bool has_own_spots(const core::WallScan& scan) {
    return !scan.is_confocal();
}

void move_time_zero(core::Capture& capture, const core::Transform&, double ps) {
    capture.time_axis.opl_start_m += ps * 1e-12 * core::kSpeedOfLight;
}

void scale_wall(core::Capture& capture, const core::Transform&, double fraction) {
    core::WallScan& scan = capture.scan.wall();
    core::Vec3 centre = core::Vec3::Zero();
    for (const core::Vec3& point : scan.sensing.positions) centre += point;
    centre /= static_cast<double>(scan.sensing.size());
    for (core::WallPoints* points : {&scan.sensing, &scan.illumination}) {
        for (core::Vec3& point : points->positions) point += fraction * (point - centre);
    }
}

template <int kAxis>
void move_spots(core::Capture& capture, const core::Transform& world_from_wall, double by_m) {
    for (core::Vec3& point : capture.scan.wall().illumination.positions) {
        point += by_m * world_from_wall.linear().col(kAxis);
    }
}

constexpr SetupParameter kParameters[] = {{"time zero",
                                           &SetupSettings::time_zero_sigma_ps,
                                           10.0,
                                           0.5e-12 * core::kSpeedOfLight,
                                           "{:.3g} ps",
                                           always,
                                           move_time_zero},
                                          {"the wall's scale",
                                           &SetupSettings::wall_scale_sigma,
                                           0.003,
                                           1.0,
                                           "{:.3g}",
                                           always,
                                           scale_wall},
                                          {"the laser spot along x",
                                           &SetupSettings::spot_sigma_m,
                                           0.002,
                                           0.5,
                                           "{:.3g} m",
                                           has_own_spots,
                                           move_spots<0>},
                                          {"the laser spot along y",
                                           &SetupSettings::spot_sigma_m,
                                           0.002,
                                           0.5,
                                           "{:.3g} m",
                                           has_own_spots,
                                           move_spots<1>}};

/// A lab's file, as opposed to a simulation and to what nobody knows the origin of.
bool is_measured(const core::Capture& capture) {
    return capture.unit == core::TransientUnit::Counts && capture.scene_info->is_object() &&
           capture.scene_info->contains("original_format");
}

/// Depths of the peaks nearest to given ones, on a volume's own columns; NaN where there is none.
std::vector<double> peaks_near(const Volume& volume, const std::vector<double>& depth_m) {
    constexpr std::size_t kReach = 4;  // voxels
    const std::vector<double>& z_m = volume.axes.z_m;
    if (z_m.size() < 2) return std::vector<double>(depth_m.size(), kNan);
    const double step_m = z_m[1] - z_m[0];
    std::vector<double> peaks(depth_m.size(), kNan);
    for (std::size_t i = 0; i < depth_m.size(); ++i) {
        if (!std::isfinite(depth_m[i])) continue;
        const double at = std::clamp(
            (depth_m[i] - z_m.front()) / step_m, 0.0, static_cast<double>(z_m.size() - 1));
        const auto voxel = static_cast<std::size_t>(std::round(at));
        const std::size_t begin = voxel - std::min(voxel, kReach);
        const std::size_t end = std::min(z_m.size(), voxel + kReach + 1);
        const std::span<const float> column(volume.values.data() + i * z_m.size(), z_m.size());
        const auto highest = std::max_element(column.begin() + static_cast<std::ptrdiff_t>(begin),
                                              column.begin() + static_cast<std::ptrdiff_t>(end));
        if (!(*highest > 0.0F)) continue;
        const ColumnPeak peak =
            find_peak(column, static_cast<std::size_t>(highest - column.begin()));
        peaks[i] = z_m.front() + step_m * peak.position;
    }
    return peaks;
}

/// Values on columns at x and y, where they lie between columns of an axis that was scaled.
class ColumnValues {
 public:
    ColumnValues(const VolumeAxes& axes, const std::vector<double>& values)
        : axes_(axes), values_(values) {}

    double at(double x_m, double y_m) const {
        const auto [ix, u] = between(axes_.x_m, x_m);
        const auto [iy, v] = between(axes_.y_m, y_m);
        double sum = 0.0;
        for (const auto& [jx, weight_x] : {std::pair{ix, 1.0 - u}, std::pair{ix + 1, u}}) {
            for (const auto& [jy, weight_y] : {std::pair{iy, 1.0 - v}, std::pair{iy + 1, v}}) {
                const double weight = weight_x * weight_y;
                if (std::abs(weight) < 1e-9) continue;
                sum += weight * values_[jx * axes_.y_m.size() + jy];
            }
        }
        return sum;
    }

 private:
    static std::pair<std::size_t, double> between(const std::vector<double>& centres_m, double at) {
        if (centres_m.size() < 2) return {0, 0.0};
        const double step_m = centres_m[1] - centres_m[0];
        // Outermost columns are continued.
        const double position = std::clamp(std::floor((at - centres_m[0]) / step_m),
                                           0.0,
                                           static_cast<double>(centres_m.size() - 2));
        return {static_cast<std::size_t>(position), (at - centres_m[0]) / step_m - position};
    }

    const VolumeAxes& axes_;
    const std::vector<double>& values_;
};

/// Medians of the foreground columns at most two columns away that have a value.
std::vector<double> medians_near(const core::DepthMap& depth, const std::vector<double>& values) {
    constexpr std::size_t kReach = 2;
    std::vector<double> medians(values.size(), kNan);
    for (std::size_t ix = 0; ix < depth.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < depth.y_m.size(); ++iy) {
            const std::size_t i = depth.index(ix, iy);
            if (!depth.is_foreground(i)) continue;
            std::vector<double> near;
            visit_near(depth, ix, iy, kReach, [&](std::size_t jx, std::size_t jy) {
                const double value = values[depth.index(jx, jy)];
                if (std::isfinite(value)) near.push_back(value);
            });
            if (!near.empty()) medians[i] = core::median(near);
        }
    }
    return medians;
}

/// The median of the sizes of what is finite; 0 of nothing.
double median_size(const std::vector<double>& values) {
    std::vector<double> sizes;
    for (const double value : values) {
        if (std::isfinite(value)) sizes.push_back(std::abs(value));
    }
    return sizes.empty() ? 0.0 : core::median(sizes);
}

}  // namespace

void enter_uncertainties(const core::Capture& capture, SetupSettings& setup) {
    const bool assumed = !setup.is_none && is_measured(capture);
    for (const SetupParameter& parameter : kParameters) {
        std::optional<double>& sigma = setup.*parameter.sigma;
        if (!sigma) sigma = assumed ? parameter.when_measured : 0.0;
    }
}

std::optional<SetupReport> propagate_setup(const core::Capture& capture,
                                           const core::DepthMap& depth,
                                           const SetupSettings& setup,
                                           const std::function<Volume(const core::Capture&)>& run) {
    constexpr double kStep = 0.5;  // voxels
    const core::WallScan& scan = capture.scan.wall();
    const auto is_uncertain = [&](const SetupParameter& parameter) {
        return *(setup.*parameter.sigma) > 0.0 && parameter.matters(scan);
    };
    if (std::ranges::none_of(kParameters, is_uncertain)) return std::nullopt;
    if (median_size(depth.depth_m) == 0.0) return std::nullopt;

    const Volume before = run(capture);
    if (before.axes.z_m.size() < 2) return std::nullopt;
    const std::vector<double> peaks = peaks_near(before, depth.depth_m);
    SetupReport report;
    std::vector<double> squares(peaks.size(), 0.0);
    for (const SetupParameter& parameter : kParameters) {
        if (!is_uncertain(parameter)) continue;
        const double amount = kStep * (before.axes.z_m[1] - before.axes.z_m[0]) / parameter.unit_m;
        core::Capture moved = capture;
        parameter.move(moved, depth.world_from_wall, amount);
        const Volume after = run(moved);
        const std::vector<double> own = peaks_near(after, peaks);
        const ColumnValues values(after.axes, own);
        std::vector<double> slopes(peaks.size(), kNan);
        for (std::size_t ix = 0; ix < depth.x_m.size(); ++ix) {
            for (std::size_t iy = 0; iy < depth.y_m.size(); ++iy) {
                const std::size_t i = depth.index(ix, iy);
                slopes[i] = (values.at(depth.x_m[ix], depth.y_m[iy]) - peaks[i]) / amount;
            }
        }
        const double sigma = *(setup.*parameter.sigma);
        const std::vector<double> near = medians_near(depth, slopes);
        for (std::size_t i = 0; i < near.size(); ++i) squares[i] += std::pow(sigma * near[i], 2);
        report.effects.push_back({parameter.name,
                                  fmt::format(fmt::runtime(parameter.amount), sigma),
                                  sigma * median_size(near)});
    }
    for (const double square : squares) report.sigma_m.push_back(std::sqrt(square));
    report.depth_sigma_m = median_size(report.sigma_m);
    return report;
}

std::string describe(const SetupReport& report) {
    std::vector<std::string> parts;
    for (const SetupEffect& effect : report.effects) {
        parts.push_back(fmt::format("{} of {} moves it by {:.2g} mm",
                                    effect.amount,
                                    effect.parameter,
                                    1e3 * effect.depth_m));
    }
    return fmt::format(
        "the surface as a whole is known to {:.2g} mm by its set-up: {}; these data do not tell",
        1e3 * report.depth_sigma_m,
        fmt::join(parts, ", "));
}

core::Json setup_json(const Reconstruction& result) {
    if (!result.setup) return nullptr;
    core::Json setup = core::write_value(result.settings.setup);
    setup["depth_sigma_m"] = {{"noise", core::write_value(result.setup->noise_sigma_m)},
                              {"setup", result.setup->depth_sigma_m}};
    return setup;
}

}  // namespace nlos
