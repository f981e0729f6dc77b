// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/wall_scan.h"

#include <memory>
#include <string_view>

namespace core {

struct SensorSetup;

/// A kind of scan: the zones of a sensor. As a scan of wall points it is confocal, of the points
/// that the middles of the zones look at.
struct SensorScan : WallScan {
    std::shared_ptr<const SensorSetup> setup;

    std::string_view name() const { return "sensor"; }
};

}  // namespace core
