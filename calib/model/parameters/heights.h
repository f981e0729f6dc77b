// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/parameter.h"

#include <fmt/core.h>

#include <cmath>

namespace calib {

/// Heights of a body's vertices along the start's normals; a weak Laplacian keeps them smooth.
inline const Parameter kHeights{
    .name = "vertices",
    .owner = Owner::Body,
    .effect = Effect::Deforms,
    .body_columns =
        [](const ModelBody& body) {
            std::vector<std::string> names;
            for (std::size_t v = 0; v < body.vertices.size(); ++v) {
                names.push_back(fmt::format("height_{}", v));
            }
            return names;
        },
    .storage = [](SceneState& state,
                  std::size_t body) { return std::span<double>(state.bodies[body].heights_m); },
    .start_body =
        [](const ModelBody& body, bool is_free, BodyState& state) {
            if (is_free) state.heights_m.assign(body.vertices.size(), 0.0);
        },
    .move_facet =
        [](const FacetPosition& at, FacetMotion& motion) {
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t v = at.facet.vertices[k];
                std::array<core::Vec3, 3> raised;
                raised.fill(core::Vec3::Zero());
                raised[k] =
                    std::exp(at.state.log_size) * (at.state.rotation * at.body.vertices[v].normal);
                motion.add(at.column + static_cast<int>(v), raised);
            }
        },
    // Height of every vertex against the mean of its neighbours.
    .body_prior = [](const ModelBody& body,
                     const PriorSettings& settings) -> std::optional<LinearPrior> {
        constexpr double kRoughness_m = 1e-3;  // that costs laplacian_weight
        if (!(settings.laplacian_weight > 0.0)) return std::nullopt;
        const auto size = static_cast<Eigen::Index>(body.vertices.size());
        Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(size, size);
        const double factor = std::sqrt(settings.laplacian_weight) / kRoughness_m;
        for (Eigen::Index v = 0; v < size; ++v) {
            const auto& neighbours = body.neighbours[static_cast<std::size_t>(v)];
            if (neighbours.empty()) continue;
            rows(v, v) = factor;
            for (const std::uint32_t n : neighbours) {
                rows(v, n) -= factor / static_cast<double>(neighbours.size());
            }
        }
        return LinearPrior{rows};
    },
    .report_body =
        [](const BodyPosition& at, std::span<const double> sigma, FittedObject& object) {
            object.heights_m = at.state.heights_m;
            if (at.state.heights_m.empty()) return;
            object.heights_sigma_m.assign(sigma.begin(), sigma.end());
        }};

}  // namespace calib
