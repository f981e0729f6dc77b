// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/restir/restir_frame.h"
#include "renderer/restir/restir_neighbours.h"
#include "renderer/restir/reuse_statistics.h"

#include <array>
#include <functional>
#include <optional>

namespace renderer {

/// Spatio-temporal resampling of paths (source [Kim2026], [Lin2022]): every pair and bin keeps one
/// path that represents all its candidates, and reuses those of its neighbours and the path of the
/// previous frame, shifted to the path length of its own gate.
///
/// Neighbours hand on the candidates of their frame alone, before each meets its own past. A past
/// is one path, too, whatever number of frames it represents: shifted to a neighbour it is as noisy
/// as any path, and what came of that would be the past of the next frame. Where nothing has
/// changed the past needs no shift, and frames add up to their mean; elsewhere it counts as many
/// frames as the measured noise of shifts lets it be worth.
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
        /// The same frame with other random numbers, from which candidates' noise is told; null:
        /// their weights tell it, which overestimates that of stratified ones.
        const RestirFrame* twin = nullptr;
        std::uint64_t number = 0;  ///< unique among the frames of one seed
    };
    /// Renders a frame. Its estimates are those of its reservoirs.
    RestirFrame render(const FrameInput& input);

    /// Takes over what another renderer has measured of the noise of frames and shifts.
    void learn_from(const RestirRenderer& other);

    const RestirCounts& counts() const { return counts_; }

 private:
    struct Worker;

    void find_domains(const FrameInput& input, RestirFrame& frame) const;
    void generate_candidates(const FrameInput& input, RestirFrame& frame);
    int rounds_of_spatial_reuse(const FrameInput& input) const;
    void reuse_spatially(const FrameInput& input, int round, RestirFrame& frame);
    void reuse_temporally(const FrameInput& input, RestirFrame& frame);
    void end_statistics_of_frame(bool had_spatial_reuse);
    void for_each_pair(const FrameInput& input,
                       const RestirFrame& frame,
                       int stage,
                       const std::function<void(Worker&)>& body);

    core::Scan scan_;
    RenderSettings settings_;
    int max_vertices_;
    RestirNeighbours neighbours_;
    RestirCounts counts_;
    // Of even and of odd pairs: each half takes what the other one tells, since confidences must
    // not follow from the samples that they weigh.
    std::array<ReuseStatistics, 2> statistics_{};  ///< of earlier frames, fading
    std::array<ReuseStatistics, 2> statistics_of_frame_{};
    std::optional<double> gain_of_spatial_reuse_;  ///< in the last frame that had it
};

}  // namespace renderer
