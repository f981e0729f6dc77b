// SPDX-License-Identifier: MIT
#include "nlos/preparation/memory_limit.h"

#include "renderer/core/error.h"
#include "renderer/core/system/process.h"

#include <fmt/format.h>

#include <algorithm>

namespace nlos {

double memory_budget(std::optional<double> limit_gb) {
    const auto available = static_cast<double>(core::available_memory_bytes());
    return limit_gb ? std::min(1e9 * *limit_gb, available) : available;
}

void require_memory(double needed_bytes, std::optional<double> limit_gb) {
    const double available = memory_budget(limit_gb);
    if (needed_bytes <= available) return;
    throw core::Failure(
        "reconstruct",
        fmt::format("needs {:.3g} GB of memory and {:.3g} GB are available; fewer volume.voxels, "
                    "larger merge_bins or a smaller crop need less",
                    1e-9 * needed_bytes,
                    1e-9 * available));
}

}  // namespace nlos
