// SPDX-License-Identifier: MIT
#include "nlos/containers/array_file.h"

#include <algorithm>

namespace nlos {

// Each is defined in the .cpp of its kind.
Container hdf5_container();
Container mat5_container();
Container npy_container();
Container npz_container();
Container ti_container();
Container json_container();
Container csv_container();

const std::vector<Container>& containers() {
    static const std::vector<Container> all{hdf5_container(),
                                            mat5_container(),
                                            npy_container(),
                                            npz_container(),
                                            ti_container(),
                                            json_container(),
                                            csv_container()};
    return all;
}

std::size_t rows_of_read(const Shape& shape) {
    constexpr std::size_t kValuesPerRead = std::size_t{1} << 20;
    if (shape.empty()) return 1;
    return std::max<std::size_t>(1,
                                 kValuesPerRead / std::max<std::size_t>(1, values_per_row(shape)));
}

}  // namespace nlos
