// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/restir/restir_frame.h"

#include <vector>

namespace renderer {

/// Which pairs are near each other: pixels by position in the image, wall points by distance, so
/// that scans need not be grids.
class RestirNeighbours {
 public:
    /// scan   of which the pairs are
    explicit RestirNeighbours(const core::Scan& scan);

    /// Picks different pairs near a pair at random, fewer where there are not as many.
    void pick(std::size_t pair, int count, core::Rng& rng, std::vector<std::size_t>& picked) const;

 private:
    void list(const core::WallScan& scan, std::size_t pair, std::vector<std::size_t>& near) const;
    void list(const core::ImageScan& image,
              std::size_t pixel,
              std::vector<std::size_t>& near) const;

    core::Scan scan_;
    std::size_t near_sensing_count_ = 0;  ///< per point
    std::size_t near_illumination_count_ = 0;
    std::vector<std::size_t> near_sensing_;       ///< (points, count)
    std::vector<std::size_t> near_illumination_;  ///< likewise; empty unless exhaustive
};

/// Spatio-temporal resampling of paths (source [Kim2026], [Lin2022]): every pair and bin keeps one
/// path that represents all its candidates, and reuses the paths of the previous frame and of its
/// neighbours, shifted to the path length of its own gate.
class RestirRenderer {
 public:
    /// scan   of every frame
    RestirRenderer(const core::Scan& scan, const RenderSettings& settings);

    /// Memory needed to render frames [bytes].
    double bytes_needed(const core::HistogramAxes& axes) const;

    /// The inputs of one frame.
    struct FrameInput {
        std::shared_ptr<RestirScene> scene;
        core::HistogramAxes axes;
        const RestirFrame* previous = nullptr;  ///< whose reservoirs to reuse; null: none
        std::uint64_t number = 0;               ///< unique among the frames of one seed
    };
    /// Renders a frame. Its estimates are those of its reservoirs.
    RestirFrame render(const FrameInput& input);

    const RestirCounts& counts() const { return counts_; }

 private:
    struct Worker;

    void find_domains(const FrameInput& input, RestirFrame& frame) const;
    void generate_candidates(const FrameInput& input, RestirFrame& frame);
    void reuse_spatially(const FrameInput& input, int round, RestirFrame& frame);
    void for_each_pair(const FrameInput& input,
                       const RestirFrame& frame,
                       int stage,
                       const std::function<void(Worker&)>& body);

    core::Scan scan_;
    RenderSettings settings_;
    int max_vertices_;
    RestirNeighbours neighbours_;
    RestirCounts counts_;
};

}  // namespace renderer
