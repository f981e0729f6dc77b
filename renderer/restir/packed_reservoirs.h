// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/restir/resampling.h"
#include "renderer/restir/reusable_path.h"

#include <cstdint>
#include <vector>

namespace renderer {

/// Many finished reservoirs of paths, stored compactly for paths of limited length.
class PackedReservoirs {
 public:
    PackedReservoirs(std::size_t count, int max_vertices)
        : max_vertices_(static_cast<std::size_t>(max_vertices)),
          heads_(count),
          vertices_(count * max_vertices_) {}

    std::size_t size() const { return heads_.size(); }

    /// Memory of one reservoir [bytes].
    static double bytes_per_reservoir(int max_vertices) {
        return static_cast<double>(sizeof(Head)) +
               static_cast<double>(max_vertices) * static_cast<double>(sizeof(SurfacePoint));
    }

    double confidence(std::size_t index) const { return heads_[index].confidence; }

    Reservoir<ReusablePath> load(std::size_t index) const {
        const Head& head = heads_[index];
        Reservoir<ReusablePath> reservoir;
        reservoir.target_value = head.target_value;
        reservoir.contribution_weight = head.contribution_weight;
        reservoir.confidence = double{head.confidence};
        reservoir.sample.num_vertices = head.num_vertices;
        reservoir.sample.pixel_u = head.pixel_u;
        const SurfacePoint* const stored = vertices_.data() + index * max_vertices_;
        std::copy(stored, stored + head.num_vertices, reservoir.sample.vertices.begin());
        return reservoir;
    }

    void store(std::size_t index, const Reservoir<ReusablePath>& reservoir) {
        Head& head = heads_[index];
        head.target_value = reservoir.target_value;
        head.contribution_weight = reservoir.contribution_weight;
        head.confidence = static_cast<float>(reservoir.confidence);
        head.num_vertices = reservoir.empty() ? 0 : reservoir.sample.num_vertices;
        head.pixel_u = reservoir.sample.pixel_u;
        std::copy_n(reservoir.sample.vertices.begin(),
                    head.num_vertices,
                    vertices_.data() + index * max_vertices_);
    }

 private:
    struct Head {
        double target_value = 0.0;
        double contribution_weight = 0.0;
        core::Vec2 pixel_u = core::Vec2::Zero();
        float confidence = 0.0F;
        std::int32_t num_vertices = 0;
    };

    std::size_t max_vertices_;
    std::vector<Head> heads_;
    std::vector<SurfacePoint> vertices_;
};

}  // namespace renderer
