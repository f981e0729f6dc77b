// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/detector/detector.h"
#include "renderer/core/capture/sensor_footprint.h"

namespace nlos {

/// The detector that a sensor's description gives: response, dark counts, dead time, the time of a
/// frame, and the radiometry of a zone.
DetectorSettings detector_of(const core::SensorSetup& setup);

/// What zones see of each other's light, and what the cover glass sends back at time zero.
///
/// Each zone gives the fraction `zone_crosstalk` of its light to each neighbour that shares a side
/// with it; what would go beyond the field's border it keeps, so that all zones together hold what
/// they held. The glass adds to every zone `cover_glass_crosstalk` times the direct return of a
/// white wall 1 m in front.
///
/// capture   radiance of the sensor's zones; its frames are changed too
/// throws    core::Error when the capture has not as many pairs as the sensor has zones, or the
///           glass is to be added to counts
void add_crosstalk(const core::SensorSetup& setup, core::Capture& capture);

/// Sets to zero, and marks as not observed, what the firmware cuts of every zone: the bins up to
/// that in which the farthest light comes straight back from the wall, and `cut_after_direct_bins`
/// more. Nothing where that is 0.
void cut_direct_return(const core::SensorSetup& setup, core::Capture& capture);

/// All of this around detect(): what the sensor's zones count.
///
/// settings   detector_of(), with what is to differ
/// throws     as add_crosstalk() and detect()
core::Capture detect_by_sensor(const core::SensorSetup& setup,
                               core::Capture capture,
                               const DetectorSettings& settings);

}  // namespace nlos
