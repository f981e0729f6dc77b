// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/compare/compare.h"

namespace report_test {

inline nlos::Metrics scores(double depth_mae_m, double mask_iou) {
    nlos::Metrics metrics;
    metrics.depth_mae_m = depth_mae_m;
    metrics.mask_iou = mask_iou;
    return metrics;
}

}  // namespace report_test
