// SPDX-License-Identifier: MIT
#include "renderer/core/capture/scan.h"

namespace core {

const WallScan& Scan::wall(const std::string& where) const {
    if (const auto* scan = as<WallScan>()) return *scan;
    throw Error(where, "found the image of a camera", "must be a scan of points on a relay wall");
}

void validate(const Scan& scan, const std::string& where) {
    scan.visit([&](const auto& kind) { validate(kind, where); });
}

}  // namespace core
