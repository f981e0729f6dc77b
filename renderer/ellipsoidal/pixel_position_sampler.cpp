// SPDX-License-Identifier: MIT
#include "renderer/ellipsoidal/pixel_position_sampler.h"

#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace renderer {
namespace {

using core::Vec2;
using core::Vec3;

// Fraction of the positions drawn by length.
constexpr double kWantedFraction = 0.5;

// Strips that differ by less than this fraction of their width count as the same.
constexpr double kSameStrip = 0.25;

// Smaller fractions of a pixel are rounding errors.
constexpr double kMinFraction = 1e-6;

// P(a U + b V < t) for uniform U, V and a >= b >= 0, a > 0.
double fraction_below(double a, double b, double t) {
    if (t <= 0.0) return 0.0;
    if (t >= a + b) return 1.0;
    if (t < b) return t * t / (2.0 * a * b);
    if (t <= a) return (t - 0.5 * b) / a;
    return 1.0 - (a + b - t) * (a + b - t) / (2.0 * a * b);
}

// Its inverse.
double below_fraction(double a, double b, double fraction) {
    if (fraction * 2.0 * a < b) return std::sqrt(2.0 * a * b * fraction);
    if ((1.0 - fraction) * 2.0 * a < b) return a + b - std::sqrt(2.0 * a * b * (1.0 - fraction));
    return fraction * a + 0.5 * b;
}

}  // namespace

void PixelPositionSampler::Band::add_strip(double start_m,
                                           const Vec2& slope_m,
                                           const OplBand& lengths) {
    const double a = slope_m.cwiseAbs().maxCoeff();
    const double b = slope_m.cwiseAbs().minCoeff();
    if (num_strips_ == kMaxStrips || !(a > 0.0) || !std::isfinite(a)) return;
    for (std::size_t i = 0; i < num_strips_; ++i) {
        const double start_off = start_m - strips_[i].start_m;
        const Vec2 slope_off = slope_m - strips_[i].slope_m;
        const double most = std::max(std::abs(start_off + slope_off.cwiseMin(0.0).sum()),
                                     std::abs(start_off + slope_off.cwiseMax(0.0).sum()));
        if (most < kSameStrip * (lengths.high_m - lengths.low_m)) return;
    }
    const double shortest = start_m + slope_m.cwiseMin(0.0).sum();
    const double below = fraction_below(a, b, lengths.low_m - shortest);
    const double fraction = fraction_below(a, b, lengths.high_m - shortest) - below;
    if (fraction > kMinFraction && fraction < 1.0) {
        strips_[num_strips_++] = {start_m, slope_m, lengths, below, fraction};
    }
}

// The length is drawn first, then the position on the line of that length.
Vec2 PixelPositionSampler::Band::Strip::sample(const Vec2& u) const {
    const int steep = std::abs(slope_m.x()) >= std::abs(slope_m.y()) ? 0 : 1;
    const int flat = 1 - steep;
    const double a = std::abs(slope_m[steep]);
    const double b = std::abs(slope_m[flat]);
    const double t = below_fraction(a, b, below + u.x() * fraction);
    const double first = b > 0.0 ? std::max(0.0, (t - a) / b) : 0.0;
    const double last = b > 0.0 ? std::min(1.0, t / b) : 1.0;
    Vec2 position;
    position[flat] = first + u.y() * (last - first);
    position[steep] = std::clamp((t - b * position[flat]) / a, 0.0, 1.0);
    for (const int side : {0, 1}) {
        if (slope_m[side] < 0.0) position[side] = 1.0 - position[side];
    }
    return position;
}

Vec2 PixelPositionSampler::Band::sample(const Vec2& u) const {
    if (num_strips_ == 0) return u;
    if (u.x() >= kWantedFraction)
        return {(u.x() - kWantedFraction) / (1.0 - kWantedFraction), u.y()};
    const double scaled = u.x() / kWantedFraction * static_cast<double>(num_strips_);
    const std::size_t strip = std::min(static_cast<std::size_t>(scaled), num_strips_ - 1);
    return strips_[strip].sample({scaled - static_cast<double>(strip), u.y()});
}

double PixelPositionSampler::Band::pdf(const Vec2& position) const {
    if (num_strips_ == 0) return 1.0;
    double wanted = 0.0;
    for (std::size_t i = 0; i < num_strips_; ++i) {
        const Strip& strip = strips_[i];
        const double opl_m = strip.start_m + strip.slope_m.dot(position);
        if (opl_m >= strip.lengths.low_m && opl_m <= strip.lengths.high_m) {
            wanted += 1.0 / strip.fraction;
        }
    }
    return 1.0 - kWantedFraction + kWantedFraction * wanted / static_cast<double>(num_strips_);
}

// Lengths at the positions of a pixel as if it showed the plane seen at the centre of another one.
class PixelPositionSampler::PlaneLengths {
 public:
    PlaneLengths(const PixelPositionSampler& sampler, std::size_t pixel, std::size_t seen_by)
        : sampler_(sampler),
          corner_(static_cast<double>(pixel / sampler.height_),
                  static_cast<double>(pixel % sampler.height_),
                  1.0),
          normal_(sampler.normals_[seen_by]),
          distance_m_(normal_.dot(sampler.positions_[seen_by] - sampler.pinhole_)) {}

    // Adds a strip about the line of the middle of the wanted lengths, as wide as the interval and
    // widened by the error of the linearisation where the line leaves the pixel.
    void add_strip(const OplBand& wanted, Band& band) const {
        constexpr int kSteps = 3;
        constexpr double kFarthest = 1.5;  // from the middle, in pixels
        Line line = tangent({0.5, 0.5});
        const double shortest = line.start_m + line.slope_m.cwiseMin(0.0).sum();
        const double longest = line.start_m + line.slope_m.cwiseMax(0.0).sum();
        const double middle_m = 0.5 * (std::clamp(wanted.low_m, shortest, longest) +
                                       std::clamp(wanted.high_m, shortest, longest));
        Vec2 position(0.5, 0.5);
        for (int i = 0; i < kSteps; ++i) {
            const double off = middle_m - line.start_m - line.slope_m.dot(position);
            position += off / line.slope_m.squaredNorm() * line.slope_m;
            if (!((position - Vec2(0.5, 0.5)).norm() < kFarthest)) return;
            line = tangent(position);
        }
        double off = 0.0;
        for (const double end : {0.0, 1.0}) {
            off = std::max(off, std::abs(opl_m(line.position_at_end(middle_m, end)) - middle_m));
        }
        band.add_strip(line.start_m, line.slope_m, {wanted.low_m - off, wanted.high_m + off});
    }

 private:
    struct Line {
        double start_m;
        Vec2 slope_m;

        // Where the line of a length leaves the pixel on one side.
        Vec2 position_at_end(double opl, double end) const {
            const int steep = std::abs(slope_m.x()) >= std::abs(slope_m.y()) ? 0 : 1;
            const int flat = 1 - steep;
            Vec2 position;
            position[flat] = end;
            position[steep] =
                std::clamp((opl - start_m - end * slope_m[flat]) / slope_m[steep], 0.0, 1.0);
            if (slope_m[flat] != 0.0) {
                position[flat] = std::clamp(
                    (opl - start_m - slope_m[steep] * position[steep]) / slope_m[flat], 0.0, 1.0);
            }
            return position;
        }
    };

    Vec3 ray(const Vec2& position) const {
        return sampler_.world_from_image_ * (corner_ + Vec3(position.x(), position.y(), 0.0));
    }

    double opl_m(const Vec2& position) const {
        const Vec3 along = ray(position);
        const Vec3 segment = distance_m_ / normal_.dot(along) * along;
        return segment.norm() + (sampler_.pinhole_ + segment - sampler_.light_).norm();
    }

    // The ray d meets the plane after t = distance / n.d times itself; with t' = -t n.d' / n.d the
    // gradients of both segments follow. Not a number when the plane is not seen.
    Line tangent(const Vec2& position) const {
        const Vec3 along = ray(position);
        const double towards = normal_.dot(along);
        const double t = distance_m_ / towards;
        if (!(t > 0.0)) return {std::nan(""), Vec2::Constant(std::nan(""))};
        const Vec3 seen = sampler_.pinhole_ + t * along;
        const Vec3 growth = along.normalized() + (seen - sampler_.light_).normalized();
        Line line;
        for (const int side : {0, 1}) {
            const Vec3 turn = sampler_.world_from_image_.col(side);
            line.slope_m[side] = growth.dot(t * turn - t * normal_.dot(turn) / towards * along);
        }
        line.start_m =
            t * along.norm() + (seen - sampler_.light_).norm() - line.slope_m.dot(position);
        return line;
    }

    const PixelPositionSampler& sampler_;
    Vec3 corner_;
    Vec3 normal_;
    double distance_m_;
};

PixelPositionSampler::PixelPositionSampler(const SensorPairs& sensor_pairs,
                                           const core::PinholeCamera& camera)
    : opl_m_(sensor_pairs.num_pairs(), std::numeric_limits<double>::infinity()),
      positions_(sensor_pairs.num_pairs(), Vec3::Zero()),
      normals_(sensor_pairs.num_pairs(), Vec3::Zero()),
      height_(camera.height()),
      pinhole_(camera.position_m),
      light_(sensor_pairs.ends(0).light.position),
      world_from_image_(camera.world_from_image()) {
    core::parallel_for(opl_m_.size(), [&](std::size_t pixel) {
        const auto seen = sensor_pairs.first_vertex(pixel, {0.5, 0.5});
        if (!seen) return;
        positions_[pixel] = seen->point.position;
        normals_[pixel] = seen->normal;
        opl_m_[pixel] = seen->optical_path.opl_m + (light_ - positions_[pixel]).norm();
    });
}

PixelPositionSampler::Band PixelPositionSampler::band(std::size_t pixel,
                                                      const OplBand& wanted) const {
    constexpr std::array<std::array<int, 2>, 9> kAround{
        {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {-1, 1}, {1, -1}, {1, 1}}};
    Band band;
    std::array<std::size_t, kAround.size()> planes;
    std::size_t num_planes = 0;
    const auto width = static_cast<std::ptrdiff_t>(opl_m_.size() / height_);
    const auto height = static_cast<std::ptrdiff_t>(height_);
    for (const auto& [right, down] : kAround) {
        const std::ptrdiff_t x = static_cast<std::ptrdiff_t>(pixel) / height + right;
        const std::ptrdiff_t y = static_cast<std::ptrdiff_t>(pixel) % height + down;
        if (x < 0 || x >= width || y < 0 || y >= height) continue;
        const auto seen_by = static_cast<std::size_t>(x * height + y);
        if (std::any_of(planes.begin(), planes.begin() + num_planes, [&](std::size_t other) {
                return see_the_same_plane(other, seen_by);
            })) {
            continue;
        }
        planes[num_planes++] = seen_by;
        PlaneLengths(*this, pixel, seen_by).add_strip(wanted, band);
    }
    return band;
}

bool PixelPositionSampler::see_the_same_plane(std::size_t a, std::size_t b) const {
    constexpr double kRounding = 1e-12;  // of unit normals, and of lengths beside the distance
    const Vec3 apart = positions_[a] - positions_[b];
    return (normals_[a] - normals_[b]).squaredNorm() < kRounding * kRounding &&
           std::abs(normals_[a].dot(apart)) <= kRounding * (positions_[a] - pinhole_).norm();
}

OplBand PixelPositionSampler::around(std::size_t pixel) const {
    OplBand lengths{opl_m_[pixel], opl_m_[pixel]};
    for (const std::size_t other : {pixel - 1, pixel + 1, pixel - height_, pixel + height_}) {
        if (other >= opl_m_.size()) continue;  // also below 0
        lengths.low_m = std::min(lengths.low_m, opl_m_[other]);
        lengths.high_m = std::max(lengths.high_m, opl_m_[other]);
    }
    return lengths;
}

}  // namespace renderer
