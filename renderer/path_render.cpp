// SPDX-License-Identifier: MIT
#include "renderer/path_render.h"

namespace renderer {

RenderResult render_by_paths(const RenderTask& task) {
    return trace_paths(task, ThirdBounceScope::All, {}, render_passes);
}

RenderResult trace_paths(const RenderTask& task,
                         ThirdBounceScope scope,
                         const PrecomputedPart& precomputed,
                         RenderResult (*render)(const RenderTask&, const PassWork&)) {
    const int last = task.settings.max_bounces;
    const bool is_all = scope == ThirdBounceScope::All;
    PassWork work{nullptr, precomputed};
    if (!task.scan.has_wall() || last >= 3) {
        work.tracer = std::make_shared<const PathTracer>(task.scene, task.settings, scope);
    }
    RenderResult result = render(task, work);
    const int first = is_all ? first_order(task.scan) : 4;
    if (!task.scan.has_wall() || last >= first) {
        result.sources.push_back({first, last, Estimator::Path, "all"});
    }
    return result;
}

}  // namespace renderer
