// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_format.h"

namespace nlos {

// Each is defined in the .cpp of its format.
CaptureFormat ytal_format();
CaptureFormat exr_format();
CaptureFormat stanford_format();
CaptureFormat point_list_format();

const std::vector<CaptureFormat>& capture_formats() {
    static const std::vector<CaptureFormat> formats{
        ytal_format(), exr_format(), stanford_format(), point_list_format()};
    return formats;
}

}  // namespace nlos
