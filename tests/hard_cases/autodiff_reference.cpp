// SPDX-License-Identifier: MIT
#include "tests/hard_cases/autodiff_reference.h"

#include "renderer/triangle/triangle_splines.h"

#include <ceres/jet.h>

namespace hard_cases {
namespace {

using core::Vec3;
using Jet = ceres::Jet<double, 6>;
using JetVec3 = Eigen::Matrix<Jet, 3, 1>;

// A corner under a small translation and turn: x + t + w x (x - c), exact to first order.
JetVec3 move(const Vec3& corner, const Vec3& center) {
    const JetVec3 translation(Jet(0.0, 0), Jet(0.0, 1), Jet(0.0, 2));
    const JetVec3 turn(Jet(0.0, 3), Jet(0.0, 4), Jet(0.0, 5));
    const JetVec3 offset = (corner - center).cast<Jet>();
    return corner.cast<Jet>() + translation + turn.cross(offset);
}

struct Nodes {
    std::array<Jet, 6> opl;
    std::array<Jet, 6> weight;
};

Nodes nodes_of(const std::array<JetVec3, 3>& corners,
               const JetVec3& normal,
               const Vec3& wall_point,
               const Vec3& wall_normal) {
    Nodes nodes;
    for (std::size_t i = 0; i < 6; ++i) {
        const JetVec3 x =
            i < 3 ? corners[i] : JetVec3((corners[i - 3] + corners[(i - 2) % 3]) * Jet(0.5));
        const JetVec3 d = x - wall_point.cast<Jet>();
        const Jet squared = d.squaredNorm();
        const Jet product = d.dot(wall_normal.cast<Jet>()) * d.dot(normal);
        nodes.opl[i] = 2.0 * sqrt(squared);
        nodes.weight[i] = product * product / (squared * squared * squared * squared);
    }
    return nodes;
}

// The knots that keep the midpoints' mean.
std::array<Jet, 3> knots_of(const std::array<Jet, 6>& v) {
    const Jet shift = (v[3] + v[4] + v[5] - v[0] - v[1] - v[2]) * (1.0 / 3.0);
    return {v[0] + shift, v[1] + shift, v[2] + shift};
}

}  // namespace

std::vector<double> autodiff_jacobian(const calib::SceneModel& model,
                                      const calib::SceneState& state,
                                      const calib::ForwardModel& light,
                                      std::size_t pair) {
    const core::WallScan& scan = light.scan();
    const core::TimeAxis& axis = light.settings().axis;
    const double sigma_m = light.settings().sigma_m;
    const auto bins = static_cast<std::size_t>(axis.num_bins);
    std::vector<double> gradients(bins * 6, 0.0);
    for (const calib::ModelElement& element : light.elements()) {
        const auto start = model.motion(state, element.facet).corners;
        std::array<JetVec3, 3> corners;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3& b = element.barycentric[i];
            corners[i] = move(b[0] * start[0] + b[1] * start[1] + b[2] * start[2],
                              state.bodies[0].position_m);
        }
        JetVec3 normal = JetVec3(corners[1] - corners[0]).cross(JetVec3(corners[2] - corners[0]));
        const Jet norm = sqrt(normal.squaredNorm());
        normal /= norm;
        const Nodes nodes =
            nodes_of(corners, normal, scan.sensing.positions[pair], scan.sensing.normals[pair]);
        const std::array<Jet, 3> opl = knots_of(nodes.opl);
        const std::array<Jet, 3> weight = knots_of(nodes.weight);
        std::array<Jet, 3> scaled;
        for (std::size_t j = 0; j < 3; ++j) scaled[j] = (opl[j] - axis.opl_start_m) / sigma_m;
        const renderer::TriangleSplines<Jet> splines(scaled, renderer::Smear::Gaussian);
        renderer::TriangleSplines<Jet>::Values values;
        Jet below(0.0);
        for (std::size_t edge = 0; edge <= bins; ++edge) {
            splines.evaluate(static_cast<double>(edge) * axis.bin_width_m / sigma_m, false, values);
            Jet cumulative(0.0);
            for (std::size_t j = 0; j < 3; ++j) cumulative += values.fraction[j] * weight[j];
            cumulative *= norm;  // twice the area, of which the barycentric triangle is half
            if (edge > 0) {
                for (int c = 0; c < 6; ++c) {
                    gradients[(edge - 1) * 6 + static_cast<std::size_t>(c)] +=
                        cumulative.v[c] - below.v[c];
                }
            }
            below = cumulative;
        }
    }
    return gradients;
}

}  // namespace hard_cases
