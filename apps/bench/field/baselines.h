// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/field/measured_process.h"
#include "renderer/core/settings/json_file.h"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace apps {

/// What a run of a method took, and why there is no result.
struct FieldRun {
    std::string failure{};         ///< empty: its files are there
    double work_cpu_s = 0.0;       ///< without start-up, reading and writing
    double process_cpu_s = 0.0;    ///< of the whole process
    std::uint64_t peak_bytes = 0;  ///< of the whole process
    core::Json said{};             ///< the program's last line; null where there is none
};

/// Enters what a run took, and why it failed, into a row of a table.
/// returns   whether it succeeded
template <class Row>
bool enter_run(const FieldRun& run, Row& row) {
    constexpr double kMegabyte = 1e6;
    row.reason = run.failure;
    if (!row.reason.empty()) return false;
    row.cpu_s = run.work_cpu_s;
    row.process_cpu_s = run.process_cpu_s;
    row.peak_mb = static_cast<double>(run.peak_bytes) / kMegabyte;
    return true;
}

/// Runs our program and, through adapters, its peers: each in a process of its own, on one thread.
///
/// Adapters are `apps/bench/field/peers/NAME.py`; the README there says what they read and write.
/// A kind of run that took longer than it may is not tried again.
class Baselines {
 public:
    /// peers     folder of the peers' Python environment; empty: there are none
    /// folder    where logs and requests go
    /// throws    core::Error when `peers` has no Python
    Baselines(const std::string& peers, std::string folder, double limit_s);

    const std::string& folder() const { return folder_; }

    /// Peers that ran so far, with their versions.
    const std::set<std::string>& versions() const { return versions_; }

    /// Runs a command of this program.
    ///
    /// kind        names runs that take alike, and logs
    /// arguments   after the program's name; `--threads 1 --json` is added
    FieldRun run_own(const std::string& kind, std::vector<std::string> arguments);

    /// Runs an adapter on a request.
    FieldRun run_peer(const std::string& kind,
                      const std::string& adapter,
                      const core::Json& request);

 private:
    FieldRun run(const std::string& kind,
                 const std::vector<std::string>& arguments,
                 const ProcessLimits& limits);

    std::string program_;
    std::string python_;
    std::string folder_;
    double limit_s_;
    int num_runs_ = 0;
    std::map<std::string, std::string> given_up_;  ///< why, by kind
    std::set<std::string> versions_;
};

}  // namespace apps
