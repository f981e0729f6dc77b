// SPDX-License-Identifier: MIT
#include "apps/python/arrays.h"

#include <fmt/ranges.h>
#include <nanobind/stl/string.h>

namespace python {

namespace nb = nanobind;

nb::object numbers_from(nb::handle value, const char* dtype, const std::string& name) {
    const nb::module_ numpy = nb::module_::import_("numpy");
    if (nb::cast<bool>(numpy.attr("ma").attr("is_masked")(value))) {
        throw core::Error(name,
                          "is a masked array, and nothing here keeps its mask",
                          "must be a plain array, such as its filled(0)");
    }
    const nb::object array = numpy.attr("asarray")(value);
    const auto kind = nb::cast<std::string>(array.attr("dtype").attr("kind"));
    const bool is_whole = kind == "u" || kind == "i";
    const bool wants_whole = dtype[0] == 'i';
    const bool is_empty = nb::cast<std::size_t>(array.attr("size")) == 0;
    if (!is_empty && !is_whole && (wants_whole || kind != "f")) {
        throw core::Error(
            name,
            "holds values of type " + nb::cast<std::string>(array.attr("dtype").attr("__str__")()),
            wants_whole ? "must be whole numbers" : "must be real numbers");
    }
    return array.attr("astype")(dtype, nb::arg("copy") = false);
}

std::string shape_text(const Extents& shape) {
    return fmt::format("({})", fmt::join(shape, ", "));
}

void require_shape(const Extents& found, const Extents& wanted, const std::string& name) {
    if (found == wanted) return;
    throw core::Error(
        name, "has shape " + shape_text(found), "must have shape " + shape_text(wanted));
}

std::vector<core::Vec3> vectors_from(nb::handle value, const std::string& name) {
    const auto array = doubles_from(value, name);
    if (array.size() > 0 && (array.ndim() < 1 || array.shape(array.ndim() - 1) != 3)) {
        throw core::Error(
            name, "has shape " + shape_text(shape_of(array)), "must have shape (..., 3)");
    }
    std::vector<core::Vec3> vectors(array.size() / 3);
    for (std::size_t i = 0; i < vectors.size(); ++i) {
        vectors[i] = Eigen::Map<const core::Vec3>(array.data() + 3 * i);
        if (!vectors[i].allFinite()) {
            throw core::Error(name, "holds a number that is not finite", "must be finite");
        }
    }
    return vectors;
}

}  // namespace python
