// SPDX-License-Identifier: MIT
#include "renderer/pixel_places.h"

#include "renderer/core/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace renderer {
namespace {

using core::Vec2;

// Of places drawn for their length.
constexpr double kWantedShare = 0.5;

// Smaller shares of a pixel are rounding.
constexpr double kLeastShare = 1e-6;

// P(a U + b V < t) for uniform U, V and a >= b >= 0, a > 0.
double share_below(double a, double b, double t) {
    if (t <= 0.0) return 0.0;
    if (t >= a + b) return 1.0;
    if (t < b) return t * t / (2.0 * a * b);
    if (t <= a) return (t - 0.5 * b) / a;
    return 1.0 - (a + b - t) * (a + b - t) / (2.0 * a * b);
}

// Its inverse.
double below_share(double a, double b, double share) {
    if (share * 2.0 * a < b) return std::sqrt(2.0 * a * b * share);
    if ((1.0 - share) * 2.0 * a < b) return a + b - std::sqrt(2.0 * a * b * (1.0 - share));
    return share * a + 0.5 * b;
}

}  // namespace

PixelPlaces::Band::Band(double start_m, const Vec2& slope_m, const OplBand& wanted)
    : start_m_(start_m), slope_m_(slope_m), wanted_(wanted) {
    const double a = slope_m.cwiseAbs().maxCoeff();
    const double b = slope_m.cwiseAbs().minCoeff();
    if (!(a > 0.0) || !std::isfinite(a)) return;
    const double shortest = start_m + slope_m.cwiseMin(0.0).sum();
    below_ = share_below(a, b, wanted.low_m - shortest);
    const double share = share_below(a, b, wanted.high_m - shortest) - below_;
    if (share > kLeastShare && share < 1.0) share_ = share;
}

// The length along the steeper side is drawn first, then the place on the line of that length.
Vec2 PixelPlaces::Band::sample(const Vec2& u) const {
    if (share_ == 0.0) return u;
    if (u.x() >= kWantedShare) return {(u.x() - kWantedShare) / (1.0 - kWantedShare), u.y()};
    const int steep = std::abs(slope_m_.x()) >= std::abs(slope_m_.y()) ? 0 : 1;
    const int flat = 1 - steep;
    const double a = std::abs(slope_m_[steep]);
    const double b = std::abs(slope_m_[flat]);
    const double t = below_share(a, b, below_ + u.x() / kWantedShare * share_);
    const double first = b > 0.0 ? std::max(0.0, (t - a) / b) : 0.0;
    const double last = b > 0.0 ? std::min(1.0, t / b) : 1.0;
    Vec2 place;
    place[flat] = first + u.y() * (last - first);
    place[steep] = std::clamp((t - b * place[flat]) / a, 0.0, 1.0);
    for (const int side : {0, 1}) {
        if (slope_m_[side] < 0.0) place[side] = 1.0 - place[side];
    }
    return place;
}

double PixelPlaces::Band::pdf(const Vec2& place) const {
    if (share_ == 0.0) return 1.0;
    const double opl_m = start_m_ + slope_m_.dot(place);
    const bool is_wanted = opl_m >= wanted_.low_m && opl_m <= wanted_.high_m;
    return 1.0 - kWantedShare + (is_wanted ? kWantedShare / share_ : 0.0);
}

PixelPlaces::PixelPlaces(const Measurement& measurement, std::size_t height)
    : opl_m_(measurement.num_pairs(), std::numeric_limits<double>::infinity()),
      normals_(measurement.num_pairs(), core::Vec3::Zero()),
      height_(height) {
    const core::Vec3 light = measurement.ends(0).light.position;
    core::parallel_for(opl_m_.size(), [&](std::size_t pixel) {
        const auto seen = measurement.first_vertex(pixel, {0.5, 0.5});
        if (!seen) return;
        opl_m_[pixel] = seen->extent.opl_m + (light - seen->point.position).norm();
        normals_[pixel] = seen->normal;
    });
}

PixelPlaces::Band PixelPlaces::band(std::size_t pixel, const OplBand& wanted) const {
    const double here = opl_m_[pixel];
    if (!std::isfinite(here)) return {};
    // Half of the difference of the neighbours; at the image's edges of one neighbour and this.
    const auto slope = [&](bool has_before, bool has_after, std::size_t step) {
        const double before = has_before ? opl_m_[pixel - step] : here;
        const double after = has_after ? opl_m_[pixel + step] : here;
        return (after - before) / ((has_before ? 1.0 : 0.0) + (has_after ? 1.0 : 0.0));
    };
    const std::size_t row = pixel % height_;
    const Vec2 slopes{slope(pixel >= height_, pixel + height_ < opl_m_.size(), height_),
                      slope(row > 0, row + 1 < height_, 1)};
    return {here - 0.5 * slopes.sum(), slopes, wanted};
}

OplBand PixelPlaces::around(std::size_t pixel) const {
    OplBand lengths{opl_m_[pixel], opl_m_[pixel]};
    for (const std::size_t other : {pixel - 1, pixel + 1, pixel - height_, pixel + height_}) {
        if (other >= opl_m_.size()) continue;  // also below 0
        lengths.low_m = std::min(lengths.low_m, opl_m_[other]);
        lengths.high_m = std::max(lengths.high_m, opl_m_[other]);
    }
    return lengths;
}

}  // namespace renderer
