// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/scene.h"
#include "renderer/core/random.h"
#include "renderer/scene/area_sampler.h"
#include "renderer/shift/shift_mapping.h"

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// A shift to try: a hidden vertex, the ends of the paths through it, and what changes.
struct Shift {
    renderer::SurfacePoint x;
    renderer::ShiftEnd source;
    renderer::ShiftEnd target;
    renderer::ConstraintChange change;
};

/// A scene with shifts to try on it, those of spatial and temporal reuse: a vertex drawn by area
/// and by the cosines at it, visible from its measurement pair, goes to a pair next to it and to a
/// length up to a bin off.
class ShiftWorkbench {
 public:
    /// Throws core::Error for a scene of whose surfaces the scan sees nothing.
    ShiftWorkbench(const std::string& path, int num_shifts) : bench_(path) {
        const renderer::AreaSampler sampler(scene());
        // Behind or beside everything the scan sees nothing; such a scene ends after many tries.
        const std::uint64_t most = 1000 * static_cast<std::uint64_t>(num_shifts);
        for (std::uint64_t i = 0; i < most && int(shifts_.size()) < num_shifts; ++i) {
            core::Rng rng(0, i, 0);
            if (const auto shift = draw(sampler, rng)) shifts_.push_back(*shift);
        }
        if (shifts_.empty()) {
            throw core::Error(path, "found no surface that the scan sees", "must have one");
        }
    }

    const renderer::Scene& scene() const { return bench_.scene(); }
    const std::vector<Shift>& shifts() const { return shifts_; }

 private:
    renderer::ShiftEnd end_of(std::size_t pair) const {
        const core::Scan& scan = bench_.scan();
        const std::size_t l = scan.illumination_index(pair);
        const core::WallPoints& lit = scan.illumination;
        return {scan.sensing.positions[scan.sensing_index(pair)], lit.positions[l], lit.normals[l]};
    }

    // Cosine at x towards a point that sees it, 0 when it does not.
    double seen_cosine(const renderer::SurfacePoint& x,
                       const core::Vec3& from,
                       const core::Vec3& n) const {
        const core::Vec3& normal = scene().facet(x.facet).normal;
        const core::Vec3 to_x = (x.position - from).normalized();
        if (n.dot(to_x) <= 0.0) return 0.0;
        if (scene().rays().is_blocked(from, n, x.position, normal)) return 0.0;
        return std::abs(normal.dot(to_x));
    }

    std::optional<Shift> draw(const renderer::AreaSampler& sampler, core::Rng& rng) const {
        const core::Scan& scan = bench_.scan();
        const std::size_t pairs = scan.num_pairs();
        const auto pair = static_cast<std::size_t>(rng.uniform() * double(pairs));
        const std::size_t next = pair + 1 < pairs ? pair + 1 : pair - 1;
        Shift shift;
        const double u = rng.uniform();
        shift.x = sampler.sample(u, rng.uniform());
        shift.source = end_of(pair);
        shift.target = end_of(next);
        const core::Vec3& sensing_normal = scan.sensing.normals[scan.sensing_index(pair)];
        const double accept = seen_cosine(shift.x, shift.source.a, sensing_normal) *
                              seen_cosine(shift.x, shift.source.y, shift.source.normal_y);
        if (rng.uniform() >= accept) return std::nullopt;
        shift.change.offset_m = bench_.axis().bin_width_m * (2.0 * rng.uniform() - 1.0);
        return shift;
    }

    BenchScene bench_;
    std::vector<Shift> shifts_;
};

}  // namespace apps
