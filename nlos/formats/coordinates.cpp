// SPDX-License-Identifier: MIT
#include "nlos/formats/coordinates.h"

namespace nlos {

void state_coordinates(Hdf5Writer& file,
                       const std::string& dataset,
                       const Coordinates& coordinates) {
    file.write_attribute(dataset, "frame", coordinates.frame);
    file.write_attribute(dataset, "units", coordinates.unit);
}

}  // namespace nlos
