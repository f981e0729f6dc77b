// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_format.h"

namespace nlos {

// Each is defined in the .cpp of its format.
CaptureFormat ytal_format();
CaptureFormat exr_format();
CaptureFormat stanford_format();

const std::vector<CaptureFormat>& capture_formats() {
    static const std::vector<CaptureFormat> formats{
        ytal_format(), exr_format(), stanford_format()};
    return formats;
}

std::vector<float> to_floats(const std::vector<core::Vec3>& points) {
    std::vector<float> values;
    values.reserve(3 * points.size());
    for (const core::Vec3& point : points) {
        for (const double coordinate : point) values.push_back(static_cast<float>(coordinate));
    }
    return values;
}

}  // namespace nlos
