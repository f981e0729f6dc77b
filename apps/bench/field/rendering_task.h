// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/field/rendering_table.h"
#include "apps/bench/scene.h"
#include "renderer/core/settings/json_fwd.h"

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace apps {

/// A scene to an order, and what is known of the truth.
struct RenderedScene {
    std::string scene;
    int max_bounces = 3;
    int points = 0;                ///< along either side of the wall; 0: an image
    double reference_error = 0.0;  ///< relative L2 of what errors are measured against

    bool is_image() const { return points == 0; }
    std::string name() const;
    std::string path() const;
    std::vector<std::string> overrides() const;
};

/// How a peer draws directions, and how many paths it takes: few, and four times as many.
struct PeerSampling {
    std::string name;
    int few_samples = 0;
    bool is_unbiased = true;  ///< in scenes whose surfaces hide one another, too
};

/// One or two independent references of a scene, and the tools to run renderers on it.
class RenderingTask {
 public:
    RenderingTask(Baselines& baselines, RenderedScene task);

    RenderingRow run_own(const std::string& method, double target_error);
    RenderingRow run_peer(const PeerSampling& sampling, int samples);
    /// How independent runs of a peer agree with the references, a row as judge_agreement() takes
    /// it.
    core::Json agree(const PeerSampling& sampling);

 private:
    /// Histograms that a peer made, one transient for every seed; none where its run failed.
    using PeerRuns = std::pair<FieldRun, std::vector<core::Transient>>;

    RenderingRow row_of(const std::string& program,
                        const std::string& method,
                        std::optional<double> target_error,
                        const FieldRun& run) const;
    core::Transient mean_reference() const;
    void score(const core::Transient& found, RenderingRow& row) const;
    void set_samples(int samples, RenderingRow& row) const;
    PeerRuns ask_peer(const PeerSampling& sampling, int samples, const std::vector<int>& seeds);
    core::Transient read_histograms(const std::string& path) const;
    core::Json scene_request() const;
    /// Wall points or pixels along x and y.
    std::array<std::size_t, 2> grid() const;

    Baselines& baselines_;
    RenderedScene task_;
    BenchScene scene_;
    std::string stem_;
    std::vector<core::Transient> references_;
};

}  // namespace apps
