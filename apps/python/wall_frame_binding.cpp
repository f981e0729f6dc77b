// SPDX-License-Identifier: MIT
#include "apps/python/wall_frame_binding.h"

namespace python {

namespace nb = nanobind;

Array<double> matrix_of(const core::Transform& transform) {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = transform.matrix();
    return array_of(std::vector<double>(matrix.data(), matrix.data() + matrix.size()), {4, 4});
}

Array<double> world_places(const core::Transform& world_from_wall,
                           nb::handle x_m,
                           nb::handle y_m,
                           nb::handle depth_m) {
    const nb::module_ numpy = nb::module_::import_("numpy");
    const nb::object each =
        numpy.attr("broadcast_arrays")(numbers_from(x_m, "float64", "x_m"),
                                       numbers_from(y_m, "float64", "y_m"),
                                       numbers_from(depth_m, "float64", "depth_m"));
    const DoubleArray places =
        doubles_from(numpy.attr("stack")(each, nb::arg("axis") = -1), "places");
    std::vector<double> world(places.size());
    for (std::size_t i = 0; i < world.size(); i += 3) {
        Eigen::Map<core::Vec3>(world.data() + i) =
            world_from_wall * Eigen::Map<const core::Vec3>(places.data() + i);
    }
    return array_of(std::move(world), shape_of(places));
}

}  // namespace python
