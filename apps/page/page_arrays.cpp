// SPDX-License-Identifier: MIT
#include "apps/page/page_arrays.h"

#include "apps/page/html.h"
#include "renderer/core/error.h"
#include "renderer/core/parallel.h"

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

}  // namespace apps
