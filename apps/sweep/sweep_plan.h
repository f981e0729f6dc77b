// SPDX-License-Identifier: MIT
#pragma once

#include "apps/sweep/sweep_settings.h"
#include "nlos/detector/detector.h"
#include "nlos/reconstruction/reconstruct_settings.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/scene/scene_file.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// What one run of a sweep does.
struct SweepRun {
    std::size_t number = 0;
    int repeat = 0;     ///< added to the seed of the noise
    core::Json values;  ///< of the grid's keys, in their order
    renderer::SceneDescription scene;
    std::string scene_changes;                    ///< runs with equal texts have equal captures
    std::optional<nlos::DetectorSettings> noise;  ///< nothing: the capture without noise
    std::string noise_changes;                    ///< likewise, within equal captures
    nlos::ReconstructSettings reconstruct;
};

/// The numbered runs of a sweep: the points of the grid in row-major order, the last key fastest,
/// each as often as it is repeated.
class SweepPlan {
 public:
    /// Reads a sweep file, the scene it names and that scene's geometry.
    ///
    /// overrides   `key.path=value` texts for the sweep file's own keys
    /// throws      core::Error for whatever is wrong with any value of any run: an unknown key, a
    ///             wrong type, a value out of range, a file that is missing
    SweepPlan(const std::string& path, const std::vector<std::string>& overrides);

    const SweepSettings& settings() const { return settings_; }
    std::size_t num_runs() const { return num_runs_; }

    /// The values of the grid's keys in a run, without what they mean.
    core::Json values_of(std::size_t run) const;
    SweepRun run(std::size_t number) const;

    /// All runs in pieces that processes can do apart from each other. Runs of one capture stand in
    /// one piece, unless there would be fewer pieces than shares.
    std::vector<std::vector<std::size_t>> pieces(std::size_t num_shares) const;

    /// A number that other settings, or other content of the files read, would change; what is
    /// plotted does not.
    const std::string& fingerprint() const { return fingerprint_; }

 private:
    core::Json changes_of(const char* part, const core::Json& values) const;
    /// Calls `body` on the changes of a part; what it refuses is said to stand in the sweep file.
    template <class Body>
    auto read_part(const char* part, const core::Json& values, const Body& body) const;
    renderer::SceneDescription scene_of(const core::Json& values) const;
    std::optional<nlos::DetectorSettings> noise_of(const core::Json& values) const;
    nlos::ReconstructSettings reconstruct_of(const core::Json& values) const;
    void check_parts() const;
    void take_fingerprint();

    std::string path_;
    SweepSettings settings_;
    renderer::SceneDescription scene_;  ///< as its file says
    std::size_t num_runs_ = 1;
    std::string fingerprint_;
};

}  // namespace apps
