// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/volume.h"

namespace nlos {

float brightest_value(std::span<const float> column) {
    return Eigen::Map<const Eigen::ArrayXf>(column.data(), static_cast<Eigen::Index>(column.size()))
        .maxCoeff();
}

std::vector<float> max_projection(const Volume& volume) {
    const std::size_t nz = volume.axes.z_m.size();
    std::vector<float> projection(volume.axes.x_m.size() * volume.axes.y_m.size(), 0.0F);
    if (nz == 0) return projection;
    for (std::size_t column = 0; column < projection.size(); ++column) {
        projection[column] = brightest_value({volume.values.data() + column * nz, nz});
    }
    return projection;
}

std::vector<double> cell_centers(double begin, double end, std::size_t count) {
    std::vector<double> centers(count);
    for (std::size_t i = 0; i < count; ++i) {
        centers[i] =
            begin + (end - begin) * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    }
    return centers;
}

}  // namespace nlos
