// SPDX-License-Identifier: MIT
#include "nlos/containers/array_file.h"

#include <algorithm>
#include <filesystem>

namespace nlos {

// Each is defined in the .cpp of its kind.
Container lfs_pointer_refusal();
Container gzip_container();
Container hdf5_container();
Container mat5_container();
Container npy_container();
Container npz_container();
Container ti_container();
Container mat4_refusal();
Container json_container();
Container csv_container();

const std::vector<Container>& containers() {
    static const std::vector<Container> all{lfs_pointer_refusal(),
                                            hdf5_container(),
                                            mat5_container(),
                                            npy_container(),
                                            npz_container(),
                                            ti_container(),
                                            mat4_refusal(),
                                            json_container(),
                                            csv_container(),
                                            gzip_container()};
    return all;
}

const Container* find_container(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return nullptr;
    for (const Container& container : containers()) {
        if (container.recognise(path)) return &container;
    }
    return nullptr;
}

std::size_t rows_of_read(const Shape& shape) {
    constexpr std::size_t kValuesPerRead = std::size_t{1} << 20;
    if (shape.empty()) return 1;
    return std::max<std::size_t>(1,
                                 kValuesPerRead / std::max<std::size_t>(1, values_per_row(shape)));
}

}  // namespace nlos
