// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/writers/hdf5_writer.h"

#include <string>

namespace nlos {

/// What the numbers of a dataset are measured in, as its attributes `frame` and `units` say for
/// people and their programs; our own readers need neither. README.md says what the frames are.
struct Coordinates {
    const char* frame;
    const char* unit;
};

inline constexpr Coordinates kWorldPositions{"world", "m"};
inline constexpr Coordinates kWorldDirections{"world", "1"};
inline constexpr Coordinates kWallPositions{"wall", "m"};
inline constexpr Coordinates kWallDirections{"wall", "1"};

/// Writes both attributes of a dataset.
void state_coordinates(Hdf5Writer& file,
                       const std::string& dataset,
                       const Coordinates& coordinates);

}  // namespace nlos
