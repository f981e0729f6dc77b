// SPDX-License-Identifier: MIT
#include "nlos/methods/backprojection.h"

#include "nlos/methods/slabs.h"
#include "renderer/core/system/large_memory.h"

namespace nlos {
namespace {

bool takes_fast_way(const MethodInput& input) {
    return input.scan.pattern == core::ScanPattern::Confocal && input.wall.grid &&
           common_lattice(*input.wall.grid, input.axes.y_m).has_value();
}

std::vector<double> device_segments(const core::WallScan& scan,
                                    const core::WallPoints& points,
                                    const core::Vec3& device) {
    std::vector<double> segments(points.size(), 0.0);
    if (scan.opl_origin == core::OplOrigin::RelayWall) return segments;
    for (std::size_t i = 0; i < segments.size(); ++i) {
        segments[i] = (points.positions[i] - device).norm();
    }
    return segments;
}

void run_fast(const MethodInput& input,
              Compensation compensation,
              std::size_t num_slabs,
              std::span<float> values) {
    ConfocalGrid<float> data{
        *input.wall.grid, input.time_axis, input.transient.values(), {}, compensation};
    if (input.scan.opl_origin == core::OplOrigin::Device) {
        for (std::size_t pair = 0; pair < input.scan.num_pairs(); ++pair) {
            data.device_segments_m.push_back(input.scan.device_segments_m(pair));
        }
    }
    backproject_confocal_grid<float>(data, input.axes, values, input.progress, num_slabs);
}

void run_general(const MethodInput& input, Compensation compensation, std::span<float> values) {
    const core::WallScan& scan = input.scan;
    const PairList<float> data{scan.pattern,
                               input.time_axis,
                               input.transient.values(),
                               in_wall_frame(input, scan.illumination),
                               in_wall_frame(input, scan.sensing),
                               device_segments(scan, scan.illumination, scan.laser_position),
                               device_segments(scan, scan.sensing, scan.detector_position),
                               compensation};
    backproject_pairs<float>(data, input.axes, values, input.progress);
}

}  // namespace

Volume backproject(const MethodInput& input,
                   const ReconstructSettings& settings,
                   std::size_t num_slabs) {
    if (input.observed) {
        const core::Progress progress = input.progress.part(0.0, 1.0 / 3.0);
        Volume volume =
            backproject(with_histograms(input, input.time_axis, input.transient, progress),
                        settings,
                        num_slabs);
        divide_by_observed_fraction(input, num_slabs, volume);
        return volume;
    }
    Volume volume{input.axes, core::zeros(input.axes.num_voxels()), {}};
    if (takes_fast_way(input)) {
        run_fast(input, settings.compensation, num_slabs, volume.values);
    } else {
        run_general(input, settings.compensation, volume.values);
    }
    return volume;
}

double backproject_bytes(const MethodInput& input,
                         const ReconstructSettings& /*settings*/,
                         std::size_t num_slabs) {
    const double volume =
        4.0 * static_cast<double>(input.axes.num_voxels()) + observed_fraction_bytes(input);
    if (takes_fast_way(input)) {
        const auto bins = static_cast<double>(input.time_axis.num_bins);
        const WallGrid& grid = *input.wall.grid;
        const auto rows = static_cast<double>(largest_slab(grid.size[0], num_slabs));
        const auto row = static_cast<double>(grid.size[1] + 120);  // four classes, padded
        return volume + 4.0 * rows * (bins + 2.0) * row;
    }
    const auto points =
        static_cast<double>(input.scan.illumination.size() + input.scan.sensing.size());
    return volume + points * (4096.0 * core::thread_count() + 64.0);
}

LeastWork least_backprojection_work(const MethodInput& input,
                                    const ReconstructSettings& /*settings*/) {
    return {.multiply_adds = static_cast<double>(input.scan.num_pairs()) *
                             static_cast<double>(input.axes.num_voxels())};
}

const MethodTraits kBp{.method = Method::Bp,
                       .meaning = "backprojection",
                       .captures = "all, walls of any shape",
                       .run = backproject,
                       .bytes = backproject_bytes,
                       .errors = {{.model_fraction = 0.042,
                                   .noise_fraction = 0.45,
                                   .doubt = 5.0,
                                   .plateau = {0.0, 0.75, 7.0}},  // leaves no edges
                                  {0.0, 0.75, 7.0}},
                       .explains_gaps = true,
                       .least_work = least_backprojection_work};

}  // namespace nlos
