// SPDX-License-Identifier: MIT
#include "apps/sweep/sweep.h"

#include <fmt/core.h>

#include <vector>

namespace apps {

SweepProgress do_share(const SweepPlan& plan,
                       const SweepResults& results,
                       const WorkShare& share,
                       const core::Progress& progress) {
    SweepProgress done;
    std::vector<std::size_t> left;
    const auto pieces = plan.pieces(share.count);
    for (std::size_t piece = 0; piece < pieces.size(); ++piece) {
        if (!share.takes(piece)) continue;
        for (const std::size_t run : pieces[piece]) {
            if (results.has(run)) {
                ++done.num_kept;
            } else {
                left.push_back(run);
            }
        }
    }
    SweepRunner runner;
    for (const std::size_t number : left) {
        const double share_done = static_cast<double>(done.num_new);
        const auto num_left = static_cast<double>(left.size());
        core::Progress of_run = progress;
        of_run.report = [&](double part, const std::string&) {
            progress.update((share_done + part) / num_left,
                            fmt::format("{} of {} runs", done.num_new, left.size()));
        };
        const SweepRun run = plan.run(number);
        const std::optional<SweepResult> result = runner.do_run(run, of_run);
        done.interrupted = !result;
        if (!result) break;
        results.write(run, *result);
        ++done.num_new;
        progress.update(static_cast<double>(done.num_new) / num_left,
                        fmt::format("{} of {} runs", done.num_new, left.size()));
    }
    return done;
}

}  // namespace apps
