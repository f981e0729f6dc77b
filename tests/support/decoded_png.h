// SPDX-License-Identifier: MIT
#pragma once

#include <opencv2/core.hpp>
#include <png.h>

#include <string>

namespace test_support {

/// Blue, green and red of a PNG file's pixels, as libpng alone reads them; nothing of no PNG.
inline cv::Mat decoded_png(const std::string& bytes) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0) return {};
    image.format = PNG_FORMAT_BGR;
    cv::Mat picture(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC3);
    if (png_image_finish_read(&image, nullptr, picture.data, 0, nullptr) == 0) return {};
    return picture;
}

}  // namespace test_support
