// SPDX-License-Identifier: MIT
#include "apps/page/coding.h"

#include "apps/page/html.h"
#include "renderer/core/error.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/parallel.h"

#include <fmt/core.h>
#include <zlib.h>

namespace apps {
namespace {

std::string compressed(const std::string& bytes) {
    uLongf size = ::compressBound(bytes.size());
    std::string result(size, '\0');
    const int status = ::compress2(reinterpret_cast<Bytef*>(result.data()),
                                   &size,
                                   reinterpret_cast<const Bytef*>(bytes.data()),
                                   bytes.size(),
                                   Z_DEFAULT_COMPRESSION);
    if (status != Z_OK) throw core::Failure("page", "its data cannot be compressed");
    result.resize(size);
    return result;
}

}  // namespace

std::string PageArrays::html() const {
    std::vector<std::string> elements(bytes_.size());
    core::parallel_for(bytes_.size(), [&](std::size_t i) {
        elements[i] = fmt::format("<script type=\"text/plain\" id=\"nlos-array-{}\">{}</script>\n",
                                  i,
                                  encode_base64(compressed(bytes_[i])));
    });
    std::string html;
    for (const std::string& element : elements) html += element;
    return html;
}

core::Json add_points(PageArrays& arrays,
                      const std::vector<core::Vec3>& points,
                      const core::Transform& frame_from_world) {
    constexpr double kSteps = std::numeric_limits<std::uint16_t>::max();
    std::vector<core::Vec3> placed;
    Eigen::AlignedBox3d box;
    for (const core::Vec3& point : points) {
        placed.push_back(frame_from_world * point);
        box.extend(placed.back());
    }
    if (points.empty()) box.extend(core::Vec3(0.0, 0.0, 0.0));
    const core::Vec3 low = box.min();
    const core::Vec3 high = box.max();
    std::vector<std::uint16_t> codes;
    codes.reserve(3 * points.size());
    for (const core::Vec3& point : placed) {
        for (int axis = 0; axis < 3; ++axis) {
            const double size = high[axis] - low[axis];
            const double fraction = size > 0.0 ? (point[axis] - low[axis]) / size : 0.0;
            codes.push_back(static_cast<std::uint16_t>(0.5 + kSteps * fraction));
        }
    }
    core::Json json = arrays.add(codes);
    json.update({{"count", points.size()},
                 {"low", {low[0], low[1], low[2]}},
                 {"high", {high[0], high[1], high[2]}}});
    return json;
}

}  // namespace apps
