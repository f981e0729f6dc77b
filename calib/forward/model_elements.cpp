// SPDX-License-Identifier: MIT
#include "calib/forward/model_elements.h"

#include "renderer/core/error.h"

#include <algorithm>
#include <limits>

namespace calib {
namespace {

using core::Vec3;

constexpr double kErrorPerKappa = 0.05;
// Weights are linear over an element only while it is small against its distance: squared edge over
// squared distance per tolerance.
constexpr double kSquaredAspectPerTolerance = 6.0;
constexpr std::size_t kMaxElements = 200'000;
constexpr int kMaxBisections = 24;

struct SplitElement {
    ModelElement element;
    int depth = 0;
};

double nearest_wall_point(const core::WallScan& scan, const Vec3& point) {
    double least = std::numeric_limits<double>::infinity();
    for (const core::WallPoints* points : {&scan.sensing, &scan.illumination}) {
        for (const Vec3& w : points->positions) least = std::min(least, (w - point).squaredNorm());
    }
    return std::sqrt(least);
}

}  // namespace

void append_elements(const std::array<Vec3, 3>& corners,
                     std::uint32_t facet,
                     const core::WallScan& scan,
                     double sigma_m,
                     double tolerance,
                     std::vector<ModelElement>& elements) {
    const auto position = [&](const Vec3& weights) {
        return Vec3(weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2]);
    };
    std::vector<SplitElement> stack{
        {{facet, {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}, 1.0}, 0}};
    while (!stack.empty()) {
        const SplitElement candidate = stack.back();
        stack.pop_back();
        const auto& barycentrics = candidate.element.barycentric;
        std::size_t longest = 0;
        std::array<double, 3> squared{};
        for (std::size_t i = 0; i < 3; ++i) {
            squared[i] =
                (position(barycentrics[(i + 1) % 3]) - position(barycentrics[i])).squaredNorm();
            if (squared[i] > squared[longest]) longest = i;
        }
        const double distance = nearest_wall_point(
            scan, position((barycentrics[0] + barycentrics[1] + barycentrics[2]) / 3.0));
        const double kappa = squared[longest] / (8.0 * distance * 0.5 * sigma_m);
        const bool is_small =
            kErrorPerKappa * kappa <= tolerance &&
            squared[longest] <= kSquaredAspectPerTolerance * tolerance * distance * distance;
        if (is_small || candidate.depth == kMaxBisections) {
            elements.push_back(candidate.element);
            if (elements.size() > kMaxElements) {
                throw core::Failure("surface elements",
                                    "the model needs more than 200,000 elements");
            }
            continue;
        }
        const Vec3 middle = 0.5 * (barycentrics[longest] + barycentrics[(longest + 1) % 3]);
        SplitElement first = candidate;
        first.depth = candidate.depth + 1;
        first.element.area_fraction = 0.5 * candidate.element.area_fraction;
        SplitElement second = first;
        first.element.barycentric[(longest + 1) % 3] = middle;
        second.element.barycentric[longest] = middle;
        stack.push_back(second);
        stack.push_back(first);
    }
}

std::vector<ModelElement> cut_elements(const SceneModel& model,
                                       const SceneState& state,
                                       const core::WallScan& scan,
                                       double sigma_m,
                                       double tolerance) {
    std::vector<ModelElement> elements;
    for (std::uint32_t f = 0; f < model.facets().size(); ++f) {
        append_elements(model.motion(state, f).corners, f, scan, sigma_m, tolerance, elements);
    }
    return elements;
}

}  // namespace calib
