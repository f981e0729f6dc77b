// SPDX-License-Identifier: MIT
// How close an estimator comes to the ray tracer's own speed: renders a scene on one thread,
// records the rays by wrapping Embree's entry points at link time, and replays exactly these rays
// with nothing in between. Of third_bounce, also its tracing phase alone: aiming the rays, tracing
// them and reading the answers; and the same rays in packets of one wall point each, since packets
// of neighbouring points, which third_bounce makes, are faster for Embree, too.
//   ray_rate SCENE.json [SAMPLES] [MAX_BOUNCES] [REPEATS] [METHOD]
#include "renderer/core/system/parallel.h"
#include "renderer/core/system/process.h"
#include "renderer/render.h"
#include "renderer/scene/embree.h"
#include "renderer/scene/scene_file.h"
#include "renderer/third_bounce/third_bounce.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

using renderer::embree::IntersectOptions;
using renderer::embree::OccludedOptions;

template <class Rays>
struct Recorded {
    alignas(64) int valid[16];
    Rays rays;
};

// Calls in the order in which the tracer made them, so that the replay meets the same caches.
enum class Call : char { Segments, FirstHits, FirstHit, Segment };

struct Recording {
    RTCScene scene = nullptr;
    std::vector<Call> calls;
    std::vector<Recorded<RTCRay16>> segment_packets;
    std::vector<Recorded<RTCRayHit16>> first_hit_packets;
    std::vector<RTCRayHit> first_hits;
    std::vector<RTCRay> segments;
    std::size_t num_rays = 0;
};

Recording* g_recording = nullptr;

template <class Rays>
void record_packet(Call call,
                   const int* valid,
                   const Rays& rays,
                   std::vector<Recorded<Rays>>& packets) {
    g_recording->calls.push_back(call);
    Recorded<Rays>& packet = packets.emplace_back();
    std::copy(valid, valid + 16, packet.valid);
    packet.rays = rays;
    g_recording->num_rays += static_cast<std::size_t>(std::count(valid, valid + 16, -1));
}

RTCRay ray_of(const RTCRay16& packet, int lane) {
    RTCRay ray{};
    ray.org_x = packet.org_x[lane];
    ray.org_y = packet.org_y[lane];
    ray.org_z = packet.org_z[lane];
    ray.dir_x = packet.dir_x[lane];
    ray.dir_y = packet.dir_y[lane];
    ray.dir_z = packet.dir_z[lane];
    ray.tfar = packet.tfar[lane];
    ray.mask = packet.mask[lane];
    return ray;
}

void set_ray(RTCRay16& packet, int lane, const RTCRay& ray) {
    packet.org_x[lane] = ray.org_x;
    packet.org_y[lane] = ray.org_y;
    packet.org_z[lane] = ray.org_z;
    packet.dir_x[lane] = ray.dir_x;
    packet.dir_y[lane] = ray.dir_y;
    packet.dir_z[lane] = ray.dir_z;
    packet.tnear[lane] = ray.tnear;
    packet.tfar[lane] = ray.tfar;
    packet.time[lane] = ray.time;
    packet.mask[lane] = ray.mask;
    packet.flags[lane] = ray.flags;
}

}  // namespace

extern "C" {
void __real_rtcOccluded16(const int*, RTCScene, NLOS_EMBREE_ARGUMENTS(RTCRay16*, OccludedOptions*));
void __real_rtcIntersect16(const int*,
                           RTCScene,
                           NLOS_EMBREE_ARGUMENTS(RTCRayHit16*, IntersectOptions*));
void __real_rtcIntersect1(RTCScene, NLOS_EMBREE_ARGUMENTS(RTCRayHit*, IntersectOptions*));
void __real_rtcOccluded1(RTCScene, NLOS_EMBREE_ARGUMENTS(RTCRay*, OccludedOptions*));

void __wrap_rtcOccluded16(const int* valid,
                          RTCScene scene,
                          NLOS_EMBREE_ARGUMENTS(RTCRay16* rays, OccludedOptions* options)) {
    if (g_recording != nullptr) {
        g_recording->scene = scene;
        record_packet(Call::Segments, valid, *rays, g_recording->segment_packets);
    }
    __real_rtcOccluded16(valid, scene, NLOS_EMBREE_ARGUMENTS(rays, options));
}

void __wrap_rtcIntersect16(const int* valid,
                           RTCScene scene,
                           NLOS_EMBREE_ARGUMENTS(RTCRayHit16* rays, IntersectOptions* options)) {
    if (g_recording != nullptr) {
        record_packet(Call::FirstHits, valid, *rays, g_recording->first_hit_packets);
    }
    __real_rtcIntersect16(valid, scene, NLOS_EMBREE_ARGUMENTS(rays, options));
}

void __wrap_rtcIntersect1(RTCScene scene,
                          NLOS_EMBREE_ARGUMENTS(RTCRayHit* ray, IntersectOptions* options)) {
    if (g_recording != nullptr) {
        g_recording->calls.push_back(Call::FirstHit);
        g_recording->first_hits.push_back(*ray);
        ++g_recording->num_rays;
    }
    __real_rtcIntersect1(scene, NLOS_EMBREE_ARGUMENTS(ray, options));
}

void __wrap_rtcOccluded1(RTCScene scene,
                         NLOS_EMBREE_ARGUMENTS(RTCRay* ray, OccludedOptions* options)) {
    if (g_recording != nullptr) {
        g_recording->calls.push_back(Call::Segment);
        g_recording->segments.push_back(*ray);
        ++g_recording->num_rays;
    }
    __real_rtcOccluded1(scene, NLOS_EMBREE_ARGUMENTS(ray, options));
}
}

namespace {

// CPU seconds of tracing the recorded rays once. The rays are copies: tracing changes them.
double replay(Recording recording) {
    auto hit_options = renderer::embree::incoherent<IntersectOptions>();
    auto shadow_options = renderer::embree::incoherent<OccludedOptions>();
    auto segment_packet = recording.segment_packets.begin();
    auto first_hit_packet = recording.first_hit_packets.begin();
    auto first_hit = recording.first_hits.begin();
    auto segment = recording.segments.begin();
    const double start = core::cpu_seconds();
    for (const Call call : recording.calls) {
        switch (call) {
            case Call::Segments:
                __real_rtcOccluded16(segment_packet->valid,
                                     recording.scene,
                                     NLOS_EMBREE_ARGUMENTS(&segment_packet->rays, &shadow_options));
                ++segment_packet;
                break;
            case Call::FirstHits:
                __real_rtcIntersect16(first_hit_packet->valid,
                                      recording.scene,
                                      NLOS_EMBREE_ARGUMENTS(&first_hit_packet->rays, &hit_options));
                ++first_hit_packet;
                break;
            case Call::FirstHit:
                __real_rtcIntersect1(recording.scene,
                                     NLOS_EMBREE_ARGUMENTS(&*first_hit++, &hit_options));
                break;
            case Call::Segment:
                __real_rtcOccluded1(recording.scene,
                                    NLOS_EMBREE_ARGUMENTS(&*segment++, &shadow_options));
                break;
        }
    }
    return core::cpu_seconds() - start;
}

// The shadow rays of all packets in packets of one origin each, in the order of calls.
Recording packed_by_origin(const Recording& recording) {
    std::vector<RTCRay> rays;
    for (const auto& [valid, packet] : recording.segment_packets) {
        for (int lane = 0; lane < 16; ++lane) {
            if (valid[lane] != 0) rays.push_back(ray_of(packet, lane));
        }
    }
    const auto origin = [](const RTCRay& ray) {
        return std::array{ray.org_x, ray.org_y, ray.org_z};
    };
    std::stable_sort(rays.begin(), rays.end(), [&](const RTCRay& a, const RTCRay& b) {
        return origin(a) < origin(b);
    });
    Recording packed;
    packed.scene = recording.scene;
    packed.num_rays = rays.size();
    for (auto begin = rays.begin(); begin != rays.end();) {
        Recorded<RTCRay16>& packet = packed.segment_packets.emplace_back();
        packed.calls.push_back(Call::Segments);
        auto end = begin;
        for (int lane = 0; lane < 16; ++lane) {
            const bool is_next = end != rays.end() && origin(*end) == origin(*begin);
            packet.valid[lane] = is_next ? -1 : 0;
            set_ray(packet.rays, lane, is_next ? *end++ : *begin);
        }
        begin = end;
    }
    return packed;
}

// What other programs on the machine disturbed least.
double least(const std::vector<double>& values) {
    return *std::min_element(values.begin(), values.end());
}

int argument(int argc, char** argv, int index, int otherwise) {
    return argc > index ? std::atoi(argv[index]) : otherwise;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        fmt::print(stderr,
                   "usage: ray_rate SCENE.json [SAMPLES] [MAX_BOUNCES] [REPEATS] [METHOD]\n");
        return 2;
    }
    const core::ThreadLimit one_thread(1);
    const std::string method = argc > 5 ? argv[5] : "path";
    auto description = renderer::read_scene_description(argv[1], {"render.method=" + method});
    description.render.samples = argument(argc, argv, 2, 256);
    description.render.max_bounces = argument(argc, argv, 3, 3);
    const core::Scan scan = renderer::make_scan(description);
    const renderer::Scene scene = renderer::load_scene(description, scan);
    const auto render = [&] {
        return renderer::render(scene, scan, description.time_axis, description.render, {});
    };

    Recording recording;
    g_recording = &recording;
    render();
    g_recording = nullptr;
    std::vector<double> render_seconds;
    std::vector<double> replay_seconds;
    std::vector<double> tracing_seconds;
    std::vector<double> repacked_seconds;
    const bool is_integrated = description.render.method == renderer::Estimator::ThirdBounce;
    const Recording repacked = is_integrated ? packed_by_origin(recording) : Recording{};
    for (int i = 0; i < argument(argc, argv, 4, 5); ++i) {
        const double start = core::cpu_seconds();
        render();
        render_seconds.push_back(core::cpu_seconds() - start);
        replay_seconds.push_back(replay(recording));
        if (!is_integrated) continue;
        repacked_seconds.push_back(replay(repacked));
        tracing_seconds.push_back(
            renderer::integrate_third_bounce(
                scene, scan.wall(), description.time_axis, description.render, {})
                .tracing_seconds);
    }
    const double rays = static_cast<double>(recording.num_rays);
    fmt::print("{} facets, {:.2f} M rays\n", scene.facets().size(), rays * 1e-6);
    fmt::print("render   {:6.2f} M rays/s\n", rays / least(render_seconds) * 1e-6);
    fmt::print("replay   {:6.2f} M rays/s\n", rays / least(replay_seconds) * 1e-6);
    fmt::print("ratio    {:6.3f}\n", least(replay_seconds) / least(render_seconds));
    if (!is_integrated) return 0;
    fmt::print("tracing  {:6.2f} M rays/s\n", rays / least(tracing_seconds) * 1e-6);
    fmt::print("ratio    {:6.3f}\n", least(replay_seconds) / least(tracing_seconds));
    fmt::print("in packets of one wall point\n");
    fmt::print("replay   {:6.2f} M rays/s\n", rays / least(repacked_seconds) * 1e-6);
    fmt::print("ratios   {:6.3f} of render, {:.3f} of tracing\n",
               least(repacked_seconds) / least(render_seconds),
               least(repacked_seconds) / least(tracing_seconds));
    return 0;
}
