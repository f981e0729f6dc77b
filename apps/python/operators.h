// SPDX-License-Identifier: MIT
#pragma once

#include "apps/python/capture_histograms.h"
#include "nlos/preparation/wall_frame.h"
#include "nlos/solver/cone_convolution.h"
#include "nlos/solver/pair_operator.h"
#include "nlos/solver/time_operator.h"

#include <memory>
#include <mutex>
#include <numeric>

namespace python {

/// What both operators leave to the caller.
struct OperatorSettings {
    nlos::Falloff falloff = nlos::Falloff::Diffuse;
    core::ResponseSettings response;
    double spot_m = 0.0;
};

template <class Visitor>
void for_each_field(OperatorSettings& s, Visitor&& visit) {
    visit("falloff",
          s.falloff,
          "by range: diffuse (r^4), retro (r^2) or, of PairOperator, facing (z^4 / r^8)");
    visit("response", s.response, "instrument response");
    visit("spot_m", s.spot_m, core::at_least(0, "full width of the spot on the wall [m]"));
}

/// The scan and the voxels of an operator, which refers to them.
struct OperatorDomain {
    core::WallScan scan;
    core::TimeAxis axis;
    core::ObservedBins observed;
    core::Transient empty{};
    nlos::WallFrame wall;
    nlos::VolumeAxes axes;
    core::Progress progress{};

    OperatorDomain(const core::Capture& capture, std::array<std::vector<double>, 3> voxels_m)
        : scan(capture.scan.wall()),
          axis(capture.time_axis),
          observed(capture.observed),
          wall(nlos::derive_wall_frame(scan)),
          axes{std::move(voxels_m[0]),
               std::move(voxels_m[1]),
               std::move(voxels_m[2]),
               wall.world_from_wall} {}

    nlos::MethodInput input(const OperatorSettings& settings) const {
        nlos::MethodInput input{scan, axis, empty, wall, axes, {0.0, 0.0}, progress};
        if (observed) input.observed = &*observed;
        if (core::is_given(settings.response)) {
            input.measurement.response = core::sample_response(
                core::make_response(settings.response, "response"), axis.bin_width_m);
        }
        return input;
    }
    Extents volume_shape() const { return {axes.x_m.size(), axes.y_m.size(), axes.z_m.size()}; }
    Extents light_shape() const {
        return histogram_shape(scan, static_cast<std::size_t>(axis.num_bins));
    }
};

/// nlos::PairOperator of a capture's pairs and a box of voxels.
class PairLight {
 public:
    PairLight(const core::Capture& capture,
              std::array<std::vector<double>, 3> voxels_m,
              const OperatorSettings& settings)
        : domain_(std::make_unique<OperatorDomain>(capture, std::move(voxels_m))),
          operator_(domain_->input(settings), settings.falloff, settings.spot_m),
          pairs_(capture.scan.num_pairs()) {
        std::iota(pairs_.begin(), pairs_.end(), std::size_t{0});
        std::vector<Eigen::Vector3f> voxels;
        const nlos::VolumeAxes& axes = domain_->axes;
        voxels.reserve(axes.num_voxels());
        for (const double x : axes.x_m) {
            for (const double y : axes.y_m) {
                for (const double z : axes.z_m) {
                    voxels.push_back(core::Vec3(x, y, z).cast<float>());
                }
            }
        }
        operator_.set_voxels(std::move(voxels));
    }

    const OperatorDomain& domain() const { return *domain_; }

    core::Transient forward(const std::vector<float>& volume) {
        core::Transient light(pairs_.size(), domain_->axis.num_bins);
        operator_.forward(volume, pairs_, light.values());
        return light;
    }
    std::vector<float> adjoint(const core::Transient& light) {
        std::vector<float> volume(operator_.num_voxels(), 0.0F);
        operator_.adjoint(light.values(), pairs_, volume);
        return volume;
    }

 private:
    std::unique_ptr<const OperatorDomain> domain_;
    nlos::PairOperator operator_;
    std::vector<std::size_t> pairs_;
};

/// The light cone of a confocal grid: nlos::ConeConvolution, then nlos::TimeOperator. Voxels stand
/// at the wall points, in even bins of squared depth.
class LightCone {
 public:
    LightCone(const core::Capture& capture, const OperatorSettings& settings)
        : domain_(std::make_unique<OperatorDomain>(capture, columns_of(capture))),
          cone_(checked_cone(settings)),
          convolution_(cone_, *domain_->wall.grid, settings.spot_m, 1.0, 1.0),
          time_(axis_from_wall(),
                cone_.v_edges,
                nlos::falloff_power(settings.falloff),
                domain_->input(settings).measurement.response) {
        for (std::size_t i = 0; i < cone_.num_v(); ++i) {
            domain_->axes.z_m.push_back(std::sqrt(0.5 * (cone_.v_edges[i] + cone_.v_edges[i + 1])));
        }
    }

    const OperatorDomain& domain() const { return *domain_; }

    core::Transient forward(const std::vector<float>& volume) {
        nlos::ConeField field(volume.size());
        for_each_voxel(
            [&](std::size_t stored, std::size_t shown) { field[stored] = volume[shown]; });
        nlos::ConeField light(volume.size());
        {
            const std::lock_guard lock(one_at_a_time_);
            convolution_.forward(field, light);
        }
        core::Transient result(domain_->scan.num_pairs(), domain_->axis.num_bins);
        core::parallel_for(cone_.nx, [&](std::size_t x) {
            std::vector<float> time(time_.num_bins() * cone_.ny);
            time_.apply(light.data() + x * cone_.num_v() * cone_.ny, time.data(), cone_.ny);
            for_each_bin(x, [&](std::size_t pair, std::size_t bin, std::size_t index) {
                result.histogram(pair)[bin] = time[index];
            });
        });
        return result;
    }
    std::vector<float> adjoint(const core::Transient& light) {
        nlos::ConeField at_wall(convolution_.num_values());
        core::parallel_for(cone_.nx, [&](std::size_t x) {
            std::vector<float> time(time_.num_bins() * cone_.ny);
            for_each_bin(x, [&](std::size_t pair, std::size_t bin, std::size_t index) {
                time[index] = light.histogram(pair)[bin];
            });
            time_.apply_adjoint(
                time.data(), at_wall.data() + x * cone_.num_v() * cone_.ny, cone_.ny);
        });
        nlos::ConeField field(at_wall.size());
        {
            const std::lock_guard lock(one_at_a_time_);
            convolution_.adjoint(at_wall, field);
        }
        std::vector<float> volume(field.size());
        for_each_voxel(
            [&](std::size_t stored, std::size_t shown) { volume[shown] = field[stored]; });
        return volume;
    }

 private:
    static std::array<std::vector<double>, 3> columns_of(const core::Capture& capture) {
        const nlos::WallFrame wall = nlos::derive_wall_frame(capture.scan.wall());
        if (!capture.scan.wall().is_confocal() || !wall.grid) {
            throw core::Error("capture",
                              "is no confocal scan of an even planar grid",
                              "must be one; PairOperator takes any");
        }
        std::array<std::vector<double>, 3> columns;
        for (std::size_t i = 0; i < wall.grid->size[0]; ++i)
            columns[0].push_back(wall.grid->x_m(i));
        for (std::size_t i = 0; i < wall.grid->size[1]; ++i)
            columns[1].push_back(wall.grid->y_m(i));
        return columns;
    }
    nlos::Cone checked_cone(const OperatorSettings& settings) const {
        nlos::Cone cone = nlos::make_cone(domain_->input(settings), 1);
        if (!cone.is_same_for_all) {
            throw core::Error("capture",
                              "has device segments that differ from point to point",
                              "must have path lengths between wall points; PairOperator takes any");
        }
        core::require(settings.falloff != nlos::Falloff::Facing,
                      "falloff",
                      "facing",
                      "diffuse or retro; PairOperator takes any");
        return cone;
    }
    core::TimeAxis axis_from_wall() const {
        core::TimeAxis axis = domain_->axis;
        axis.opl_start_m -= cone_.min_segment_m;
        return axis;
    }
    /// Calls visit(place in [x][v][y], place in [x][y][v]).
    template <class Visit>
    void for_each_voxel(const Visit& visit) const {
        for (std::size_t x = 0; x < cone_.nx; ++x) {
            for (std::size_t v = 0; v < cone_.num_v(); ++v) {
                for (std::size_t y = 0; y < cone_.ny; ++y) {
                    visit((x * cone_.num_v() + v) * cone_.ny + y,
                          (x * cone_.ny + y) * cone_.num_v() + v);
                }
            }
        }
    }
    /// Calls visit(pair, bin, place in [bin][y]) for the observed bins of a row of wall points.
    template <class Visit>
    void for_each_bin(std::size_t x, const Visit& visit) const {
        for (std::size_t y = 0; y < cone_.ny; ++y) {
            const std::size_t pair = domain_->wall.grid->point(x, y);
            const core::BinRange range =
                core::observed_range(domain_->observed, pair, domain_->axis.num_bins);
            for (int b = range.begin; b < range.end; ++b) {
                const auto bin = static_cast<std::size_t>(b);
                visit(pair, bin, bin * cone_.ny + y);
            }
        }
    }

    std::unique_ptr<OperatorDomain> domain_;
    nlos::Cone cone_;
    nlos::ConeConvolution convolution_;
    nlos::TimeOperator time_;
    std::mutex one_at_a_time_;  // in the convolution, whose planes are shared
};

}  // namespace python
