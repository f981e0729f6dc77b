// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/third_bounce/surface_subdivider.h"

#include <gtest/gtest.h>

namespace test_support {

/// The only batch of a small cut.
inline renderer::ElementSet single_cut(const renderer::SurfaceSubdivider& subdivider,
                                       double tolerance) {
    renderer::ElementSet only;
    subdivider.cut(tolerance, [&](renderer::ElementSet&& batch) {
        EXPECT_EQ(batch.fraction, 1.0);
        only = std::move(batch);
        return true;
    });
    return only;
}

}  // namespace test_support
