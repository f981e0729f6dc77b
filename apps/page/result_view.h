// SPDX-License-Identifier: MIT
#pragma once

#include "apps/page/coding.h"
#include "nlos/reconstruction/reconstruction.h"
#include "renderer/core/settings/json_fwd.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// The voxels of a reconstruction, each in 255 steps up to the brightest.
struct VolumeView {
    std::array<std::size_t, 3> size{};
    std::array<std::array<double, 2>, 3> centres_m{};  ///< of the first and last voxel per axis
    double highest = 0.0;
    std::array<std::size_t, 3> merged{1, 1, 1};  ///< voxels of the reconstruction in one of these
    std::vector<std::uint8_t> codes;             ///< stored [x][y][z], by LinearCoding{0, highest}
};

/// A reconstruction, reduced to what a page shows of it.
struct ResultView {
    std::string name;    ///< the method, with what tells it from others of the same
    std::string detail;  ///< size and file
    core::DepthMap depth;
    std::vector<double> probability;  ///< per column of `depth`; empty: not given
    std::vector<double> sigma_m;      ///< likewise
    std::vector<float> projection;  ///< brightest along z per column, as fraction of the brightest
    VolumeView volume;
    std::optional<core::DepthMap> truth;  ///< seen from the columns of `depth`; nothing: not known
};

/// file   the volume's name, to be shown
ResultView result_view(const nlos::Reconstruction& result, const std::string& file);

/// The volume with pairs of voxels along its longest axis as one, which is as bright as the
/// brighter.
VolumeView halved(const VolumeView& volume);

/// How often so many voxels or bins can be halved until they are 16 or fewer.
int halvings_of(std::size_t count);
int halvings_of(const VolumeView& volume);

/// The scales of maps that stand beside one another: depth, its error, its standard deviation.
struct MapScales {
    std::array<double, 2> depth_m{0.0, 1.0};
    double error_mm = 1.0;
    double sigma_mm = 1.0;
};

/// From the truth where it is known, else from the results.
MapScales map_scales(const std::vector<ResultView>& results,
                     const std::optional<core::DepthMap>& truth);

/// What the page's script reads of a result.
///
/// frame_from_world   of the page; the volume is left out where the result's wall is another
/// halvings           how often its volume is halved, unless it is small before
core::Json result_json(const ResultView& result,
                       const MapScales& scales,
                       const core::Transform& frame_from_world,
                       int halvings,
                       PageArrays& arrays);

/// The same of the truth as a result of its own.
core::Json truth_json(const core::DepthMap& truth,
                      const std::string& scene,
                      const MapScales& scales,
                      const core::Transform& frame_from_world,
                      PageArrays& arrays);

}  // namespace apps
