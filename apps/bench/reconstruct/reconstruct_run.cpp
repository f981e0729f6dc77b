// SPDX-License-Identifier: MIT
#include "apps/bench/reconstruct/reconstruct_run.h"

#include "renderer/core/process.h"

namespace apps {

ReconstructRun run_reconstruction(const core::Capture& capture, const Overrides& overrides) {
    nlos::ReconstructSettings settings;
    for (const std::string& text : overrides) core::apply_override(settings, text);
    core::reset_peak_rss();
    const auto before = static_cast<double>(core::peak_rss_bytes());
    const double start = core::cpu_seconds();
    ReconstructRun run{nlos::reconstruct(capture, settings, {}), 0.0, 0.0, 0.0};
    run.cpu_seconds = core::cpu_seconds() - start;
    run.peak_bytes = static_cast<double>(core::peak_rss_bytes());
    run.bytes = run.peak_bytes - before;
    return run;
}

}  // namespace apps
