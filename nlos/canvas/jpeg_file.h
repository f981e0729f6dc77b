// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/canvas/raster.h"

#include <string>

namespace nlos {

/// The bytes of a .jpg: small, with fine lines and letters a little blurred.
/// throws   core::Failure when it cannot be packed
std::string encode_jpeg(const Raster& raster);

}  // namespace nlos
