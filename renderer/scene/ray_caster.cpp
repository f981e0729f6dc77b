// SPDX-License-Identifier: MIT
#include "renderer/scene/ray_caster.h"

#include "renderer/core/error.h"
#include "renderer/scene/embree.h"

#include <cmath>
#include <limits>

namespace renderer {
namespace {

using core::Vec3;

// Rounding a coordinate to float moves it by at most 2^-24 of its size; the intersection test and
// the subtraction of the ray's origin add a few such steps.
constexpr double kRoundingSteps = 16.0 * 0x1.0p-24;

void throw_embree_error(void*, RTCError code, const char* message) {
    if (code == RTC_ERROR_OUT_OF_MEMORY) throw core::Failure("ray tracing", "not enough memory");
    throw core::Failure("ray tracing", message != nullptr ? message : "unknown Embree error");
}

Vec3 moved_off(const Vec3& point, const Vec3& normal, const Vec3& towards, double offset) {
    return point + std::copysign(offset, normal.dot(towards)) * normal;
}

// A surface point and its normal.
struct PlainPoint {
    double x, y, z, normal_x, normal_y, normal_z;
};

// A single ray; `start` is relative to RayCaster::origin().
RTCRay make_ray(const Vec3& start, const Vec3& along, float end) {
    RTCRay ray{};
    ray.org_x = static_cast<float>(start.x());
    ray.org_y = static_cast<float>(start.y());
    ray.org_z = static_cast<float>(start.z());
    ray.dir_x = static_cast<float>(along.x());
    ray.dir_y = static_cast<float>(along.y());
    ray.dir_z = static_cast<float>(along.z());
    ray.tfar = end;
    ray.mask = ~0U;
    return ray;
}

bool is_ahead(double distance_m) {
    return std::isfinite(distance_m) && distance_m > 0.0;
}

}  // namespace

struct RayCaster::Embree {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    explicit Embree() {
        device = rtcNewDevice(nullptr);
        if (device == nullptr) throw core::Failure("ray tracing", "Embree does not start");
        rtcSetDeviceErrorFunction(device, throw_embree_error, nullptr);
        scene = rtcNewScene(device);
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    }
    ~Embree() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
    Embree(const Embree&) = delete;
    Embree& operator=(const Embree&) = delete;

    void add_triangles(std::span<const std::array<Vec3, 3>> corners, const Vec3& origin) {
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry,
                                                                     RTC_BUFFER_TYPE_VERTEX,
                                                                     0,
                                                                     RTC_FORMAT_FLOAT3,
                                                                     3 * sizeof(float),
                                                                     3 * corners.size()));
        auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry,
                                                                       RTC_BUFFER_TYPE_INDEX,
                                                                       0,
                                                                       RTC_FORMAT_UINT3,
                                                                       3 * sizeof(unsigned),
                                                                       corners.size()));
        for (std::size_t i = 0; i < 3 * corners.size(); ++i) {
            const Vec3 local = corners[i / 3][i % 3] - origin;
            for (int axis = 0; axis < 3; ++axis) {
                vertices[3 * i + static_cast<std::size_t>(axis)] = static_cast<float>(local[axis]);
            }
            indices[i] = static_cast<unsigned>(i);
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene);
    }
};

double ray_offset_m(const Eigen::AlignedBox3d& box) {
    return kRoundingSteps * 0.5 * box.sizes().maxCoeff();
}

RayCaster::RayCaster(std::span<const std::array<Vec3, 3>> corners, std::span<const Vec3> extra)
    : embree_(std::make_unique<Embree>()), corners_(corners.begin(), corners.end()) {
    Eigen::AlignedBox3d box;
    for (const auto& triangle : corners) {
        for (const Vec3& corner : triangle) box.extend(corner);
    }
    for (const Vec3& point : extra) box.extend(point);
    origin_ = box.center();
    half_size_m_ = 0.5 * box.sizes().maxCoeff();
    offset_m_ = ray_offset_m(box);
    embree_->add_triangles(corners, origin_);
}

RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

std::optional<RayHit> RayCaster::first_hit(const Vec3& from,
                                           const Vec3& normal,
                                           const Vec3& direction) const {
    const Vec3 start = moved_off(from, normal, direction, offset_m_) - origin_;
    RTCRayHit query{};
    query.ray = make_ray(start, direction, std::numeric_limits<float>::infinity());
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    auto options = embree::incoherent<embree::IntersectOptions>();
    rtcIntersect1(embree_->scene, NLOS_EMBREE_ARGUMENTS(&query, &options));
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

    const double distance = distance_to_plane(query.hit.primID, from, direction);
    if (!is_ahead(distance)) return std::nullopt;
    return RayHit{query.hit.primID, distance};
}

// The distance once more in double precision, from the facet's plane.
double RayCaster::distance_to_plane(std::uint32_t triangle,
                                    const Vec3& from,
                                    const Vec3& direction) const {
    const auto& [a, b, c] = corners_[triangle];
    const Vec3 area_vector = (b - a).cross(c - a);
    return area_vector.dot(a - from) / area_vector.dot(direction);
}

void RayCaster::first_hits(const Vec3& from, const Vec3& normal, DirectionPacket& packet) const {
    constexpr int kSize = DirectionPacket::kSize;
    const Vec3 start = from - origin_;
    const double normal_x = normal.x();
    const double normal_y = normal.y();
    const double normal_z = normal.z();
    alignas(64) std::array<int, kSize> valid;
    RTCRayHit16 query;
    for (int lane = 0; lane < kSize; ++lane) {
        const auto i = static_cast<std::size_t>(lane);
        const double off = std::copysign(
            offset_m_, normal_x * packet.x[i] + normal_y * packet.y[i] + normal_z * packet.z[i]);
        const bool is_valid = lane < packet.count;
        valid[i] = is_valid ? -1 : 0;
        query.ray.org_x[lane] = static_cast<float>(start.x() + off * normal_x);
        query.ray.org_y[lane] = static_cast<float>(start.y() + off * normal_y);
        query.ray.org_z[lane] = static_cast<float>(start.z() + off * normal_z);
        query.ray.dir_x[lane] = static_cast<float>(packet.x[i]);
        query.ray.dir_y[lane] = static_cast<float>(packet.y[i]);
        query.ray.dir_z[lane] = static_cast<float>(packet.z[i]);
        query.ray.tnear[lane] = 0.0F;
        // As in trace(): without 16-wide vectors Embree heeds the interval, not `valid`.
        query.ray.tfar[lane] = is_valid ? std::numeric_limits<float>::infinity() : -1.0F;
        query.ray.time[lane] = 0.0F;
        query.ray.mask[lane] = ~0U;
        query.ray.flags[lane] = 0;
        query.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    auto options = embree::incoherent<embree::IntersectOptions>();
    rtcIntersect16(valid.data(), embree_->scene, NLOS_EMBREE_ARGUMENTS(&query, &options));
    for (int lane = 0; lane < packet.count; ++lane) {
        const auto i = static_cast<std::size_t>(lane);
        packet.triangle[i] = DirectionPacket::kNone;
        if (query.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
        const Vec3 direction(packet.x[i], packet.y[i], packet.z[i]);
        packet.distance_m[i] = distance_to_plane(query.hit.primID[lane], from, direction);
        if (is_ahead(packet.distance_m[i])) packet.triangle[i] = query.hit.primID[lane];
    }
}

bool RayCaster::is_blocked(const Vec3& a,
                           const Vec3& normal_a,
                           const Vec3& b,
                           const Vec3& normal_b) const {
    const Vec3 from = moved_off(a, normal_a, b - a, offset_m_) - origin_;
    const Vec3 to = moved_off(b, normal_b, a - b, offset_m_) - origin_;
    RTCRay ray = make_ray(from, to - from, 1.0F);
    auto options = embree::incoherent<embree::OccludedOptions>();
    rtcOccluded1(embree_->scene, NLOS_EMBREE_ARGUMENTS(&ray, &options));
    return ray.tfar < 0.0F;
}

// Plain numbers in one loop over all lanes, which the compiler vectorizes.
template <class From>
[[gnu::always_inline]] inline void RayCaster::aim_from(SegmentPacket& packet,
                                                       const From& from_of,
                                                       const SurfacePointLanes& to,
                                                       int count) const {
    const double origin_x = origin_.x();
    const double origin_y = origin_.y();
    const double origin_z = origin_.z();
    const double offset = offset_m_;
    packet.count = count;
    for (std::size_t i = 0; i < SegmentPacket::kSize; ++i) {
        const auto [x, y, z, normal_x, normal_y, normal_z] = from_of(i);
        const double dx = to.x[i] - x;
        const double dy = to.y[i] - y;
        const double dz = to.z[i] - z;
        const double off = std::copysign(offset, normal_x * dx + normal_y * dy + normal_z * dz);
        const double facing = to.normal_x[i] * dx + to.normal_y[i] * dy + to.normal_z[i] * dz;
        const double off_end = std::copysign(offset, -facing);
        const double from_x = x + off * normal_x - origin_x;
        const double from_y = y + off * normal_y - origin_y;
        const double from_z = z + off * normal_z - origin_z;
        packet.from_x[i] = static_cast<float>(from_x);
        packet.from_y[i] = static_cast<float>(from_y);
        packet.from_z[i] = static_cast<float>(from_z);
        packet.along_x[i] =
            static_cast<float>(to.x[i] + off_end * to.normal_x[i] - origin_x - from_x);
        packet.along_y[i] =
            static_cast<float>(to.y[i] + off_end * to.normal_y[i] - origin_y - from_y);
        packet.along_z[i] =
            static_cast<float>(to.z[i] + off_end * to.normal_z[i] - origin_z - from_z);
    }
}

void RayCaster::aim(SegmentPacket& packet,
                    const Vec3& from,
                    const Vec3& normal,
                    const SurfacePointLanes& to,
                    int count) const {
    const PlainPoint point{from.x(), from.y(), from.z(), normal.x(), normal.y(), normal.z()};
    aim_from(
        packet, [&](std::size_t) { return point; }, to, count);
}

void RayCaster::aim(SegmentPacket& packet,
                    const SurfacePointLanes& from,
                    const SurfacePointLanes& to,
                    int count) const {
    aim_from(
        packet,
        [&](std::size_t i) {
            return PlainPoint{from.x[i],
                              from.y[i],
                              from.z[i],
                              from.normal_x[i],
                              from.normal_y[i],
                              from.normal_z[i]};
        },
        to,
        count);
}

void RayCaster::trace(SegmentPacket& packet) const {
    constexpr int kSize = SegmentPacket::kSize;
    alignas(64) std::array<int, kSize> valid;
    RTCRay16 rays;
    for (int lane = 0; lane < kSize; ++lane) {
        const auto i = static_cast<std::size_t>(lane);
        valid[i] = lane < packet.count ? -1 : 0;
        rays.org_x[lane] = packet.from_x[i];
        rays.org_y[lane] = packet.from_y[i];
        rays.org_z[lane] = packet.from_z[i];
        rays.dir_x[lane] = packet.along_x[i];
        rays.dir_y[lane] = packet.along_y[i];
        rays.dir_z[lane] = packet.along_z[i];
        rays.tnear[lane] = 0.0F;
        // On processors without 16-wide vectors Embree heeds the interval, not `valid`.
        rays.tfar[lane] = lane < packet.count ? 1.0F : -1.0F;
        rays.time[lane] = 0.0F;
        rays.mask[lane] = ~0U;
        rays.flags[lane] = 0;
    }
    auto options = embree::incoherent<embree::OccludedOptions>();
    rtcOccluded16(valid.data(), embree_->scene, NLOS_EMBREE_ARGUMENTS(&rays, &options));
    packet.blocked = 0;
    for (int lane = 0; lane < kSize; ++lane) {
        packet.blocked |= std::uint32_t{valid[lane] != 0 && rays.tfar[lane] < 0.0F} << lane;
    }
}

}  // namespace renderer
