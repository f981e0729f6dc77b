// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_format.h"

namespace nlos {

// Each is defined in the .cpp of its format.
CaptureFormat ytal_format();
CaptureFormat npz_format();
CaptureFormat exr_format();
WriteCapture write_ytal, write_npz, write_exr;
WriteCapture write_stanford_2018, write_stanford_fk_2019, write_conv_nlos;

const std::vector<CaptureFormat>& capture_formats() {
    static const std::vector<CaptureFormat> formats{ytal_format(), npz_format(), exr_format()};
    return formats;
}

const std::vector<CaptureWriter>& capture_writers() {
    static const std::vector<CaptureWriter> writers{
        {"y-tal", {".h5", ".hdf5"}, write_ytal},
        {"npz", {".npz"}, write_npz},
        {"exr", {".exr"}, write_exr},
        {"stanford-2018", {".mat"}, write_stanford_2018},
        {"stanford-fk-2019", {".mat"}, write_stanford_fk_2019},
        {"conv-nlos", {".mat"}, write_conv_nlos}};
    return writers;
}

std::optional<std::string> extras_left_out(const core::Capture& capture) {
    std::string names;
    const auto add = [&](bool is_there, const char* name) {
        if (is_there) names += (names.empty() ? "" : ", ") + std::string(name);
    };
    add(capture.variance.has_value(), "variance");
    add(!capture.orders.empty(), "orders of bounces");
    add(capture.velocity.has_value(), "velocities");
    add(capture.sequence.has_value(), "frames");
    add(capture.observed.has_value(), "observed bins");
    add(!capture.scene_info->empty(), "scene_info");
    if (names.empty()) return std::nullopt;
    return "the file has no place for " + names;
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
