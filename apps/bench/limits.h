// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/method_input.h"
#include "nlos/reconstruct_settings.h"
#include "renderer/scene.h"

namespace apps {

/// Work that a method cannot do without, run alone in cache on scratch data: the lower limit of its
/// time on this machine. Each returns CPU seconds.

/// The light-cone transform's FFTs: every wall point there and back along squared range, every
/// frequency there and back laterally, and every frequency's kernel.
double light_cone_fft_seconds(const nlos::MethodInput& input);

/// Those of f-k migration: every wall point along range, every frequency laterally, every lateral
/// frequency along depth, every depth back laterally.
double fk_fft_seconds(const nlos::MethodInput& input);

/// Those of the phasor field: for every depth and frequency the kernel and one plane back.
double phasor_fft_seconds(const nlos::MethodInput& input, const nlos::PhasorSettings& settings);

/// Two multiply-adds for every pair of histogram and voxel.
double multiply_add_seconds(double pairs);

/// One shadow ray from a scan's points to hidden surfaces, in packets from one point to places in
/// the order of the file: the lower limit of every path of `path`.
double shadow_ray_seconds(const renderer::Scene& scene, const core::Scan& scan);

}  // namespace apps
