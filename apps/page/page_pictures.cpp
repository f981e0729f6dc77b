// SPDX-License-Identifier: MIT
#include "apps/page/page_pictures.h"

#include "apps/page/html.h"
#include "nlos/canvas/jpeg_file.h"
#include "nlos/canvas/png_file.h"
#include "renderer/core/system/parallel.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace apps {
namespace {

// Pictures of results have two pixels for each one on an ordinary screen.
constexpr int kPixelDensity = 2;
constexpr int kNarrowest = 560;  // smaller pictures of others are shown as large as they are
constexpr int kNarrowestThumbnail = 96;        // [px]
constexpr double kSmallestThumbnail = 4000.0;  // bytes as text that one of these takes at most

/// The width that a PNG file gives: bytes 16 to 19, the highest first; nothing for other files.
std::optional<int> png_width(std::string_view bytes) {
    if (bytes.size() < 24 || !bytes.starts_with("\x89PNG\r\n\x1a\n")) return std::nullopt;
    int width = 0;
    for (std::size_t i = 16; i < 20; ++i)
        width = width * 256 + static_cast<unsigned char>(bytes[i]);
    return width;
}

std::string_view mime_type(std::string_view bytes) {
    if (bytes.starts_with("\x89PNG")) return "image/png";
    return bytes.starts_with("\xff\xd8") ? "image/jpeg" : "image/svg+xml";
}

double bytes_as_text(std::string_view bytes) {
    return 4.0 * std::ceil(static_cast<double>(bytes.size()) / 3.0);
}

/// What each may take so that all together take at most `limit`, where those that need less leave
/// more to the others.
double even_share(std::vector<double> sizes, double limit) {
    std::sort(sizes.begin(), sizes.end());
    auto others = static_cast<double>(sizes.size());
    for (const double size : sizes) {
        if (size * others > limit) return limit / others;
        limit -= size;
        others -= 1.0;
    }
    return std::numeric_limits<double>::infinity();
}

/// The picture as a JPEG that takes at most so many bytes as text, unless it is no PNG file or
/// would be too small to see anything.
std::string thumbnail(std::string_view png, double limit) {
    std::optional<nlos::Raster> picture = nlos::decode_png(png);
    if (!picture) return "";
    constexpr double kGain = 3.0;  // about, of JPEG against PNG at the same size
    double scale = std::min(1.0, std::sqrt(kGain * limit / bytes_as_text(png)));
    for (;;) {
        const int least = std::min(picture->columns, kNarrowestThumbnail);
        const int columns = std::max(least, static_cast<int>(scale * picture->columns));
        const int rows = std::max(1, columns * picture->rows / picture->columns);
        picture = nlos::resized(*picture, columns, rows);
        std::string jpeg = nlos::encode_jpeg(*picture);
        if (bytes_as_text(jpeg) <= limit || columns <= kNarrowestThumbnail) return jpeg;
        scale = std::clamp(std::sqrt(limit / bytes_as_text(jpeg)), 0.5, 0.9);
    }
}

}  // namespace

std::string PagePictures::image(std::string_view bytes, std::string_view alternative) {
    const auto [entry, is_new] = index_.emplace(bytes.data(), pictures_.size());
    if (is_new) pictures_.push_back({bytes});
    const Picture& picture = pictures_[entry->second];
    const std::string name = escape_html(alternative);
    if (!is_fitted_) uses_.push_back(entry->second);
    if (picture.is_left_out) return "<span class=\"hint\">" + name + " (left out)</span>";
    std::string width;
    if (const std::optional<int> pixels = png_width(picture.shown())) {
        const int shown = std::max(*pixels / kPixelDensity, std::min(*pixels, kNarrowest));
        width = fmt::format(" width=\"{}\"", shown);
    }
    return fmt::format("<img src=\"data:{};base64,{}\"{} alt=\"{}\">",
                       mime_type(picture.shown()),
                       is_fitted_ ? encode_base64(picture.shown()) : "",
                       width,
                       name);
}

void PagePictures::fit(double limit_bytes) {
    is_fitted_ = true;
    std::vector<double> sizes;
    for (const std::size_t use : uses_) sizes.push_back(bytes_as_text(pictures_[use].whole));
    const double share = std::max(kSmallestThumbnail, even_share(std::move(sizes), limit_bytes));
    std::vector<Picture*> large;
    for (Picture& picture : pictures_) {
        if (bytes_as_text(picture.whole) > share) large.push_back(&picture);
    }
    const auto most = static_cast<std::size_t>(std::max(0.0, limit_bytes / share));
    core::parallel_for(std::min(most, large.size()), [&](std::size_t i) {
        large[i]->reduced = thumbnail(large[i]->whole, share);
    });
    double left = limit_bytes;
    for (const std::size_t use : uses_) {
        Picture& picture = pictures_[use];
        const double bytes = bytes_as_text(picture.shown());
        picture.is_left_out = picture.is_left_out || bytes > std::min(left, share);
        if (!picture.is_left_out) left -= bytes;
    }
    for (const std::size_t use : uses_) {
        num_left_out_ += pictures_[use].is_left_out ? 1 : 0;
        num_reduced_ += !pictures_[use].is_left_out && !pictures_[use].reduced.empty() ? 1 : 0;
    }
}

double PagePictures::whole_bytes() const {
    double bytes = 0.0;
    for (const std::size_t use : uses_) bytes += bytes_as_text(pictures_[use].whole);
    return bytes;
}

}  // namespace apps
