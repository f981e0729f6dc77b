// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/array_reader.h"
#include "nlos/layouts/capture_settings.h"
#include "renderer/core/capture/capture.h"

namespace nlos {

// The arrays of capture_arrays.h, read. All throw core::Error that names file and array for what is
// missing or wrong, and core::Failure for what does not fit in memory.

/// Reads scene_info, camera or points, the axis and H.
core::Capture read_histograms(const ArrayReader& file, const CaptureReadSettings& settings);

/// The counts that a unit of radiance gives, found at `where`; throws unless they are a positive
/// number.
double checked_scale(double counts_per_radiance, const std::string& where);

/// An empty transient for the pairs of `capture`, if there is memory for it.
core::Transient make_transient(const ArrayReader& file,
                               const std::string& name,
                               const core::Capture& capture,
                               int num_bins);

/// Reads what a capture may hold beside H where the file has it: observed_bins, H_by_order with
/// orders, frames (not their steps) and variance.
///
/// prefix   before these names
void read_optional_arrays(const ArrayReader& file,
                          const std::string& prefix,
                          core::Capture& capture);

void require_shape(const ArrayReader& file, const std::string& name, const Shape& wanted);

/// Throws unless all values are finite and not negative.
void require_variances(const ArrayReader& file,
                       const std::string& name,
                       const core::Transient& variance);

/// Reads camera or wall points, how they pair up and where the devices stand from a capture in
/// y-tal's layout; scene_info must be in the capture. What is missing and assumed is noted there.
///
/// Throws core::Error when something needed is missing, not finite, or H does not have one
/// histogram per pair.
void read_ytal_scan(const ArrayReader& file, core::Capture& capture);

}  // namespace nlos
