// SPDX-License-Identifier: MIT
#include "calib/adjoint/part_kernel.h"

#include "calib/forward/knot_derivatives.h"

namespace calib {
namespace {

using core::Vec3;
using renderer::Gradients;

// A part's fraction of the element's area.
double fraction_of_area(const PartBarycentrics& s) {
    return s[0].dot(s[1].cross(s[2]));
}

// The inner product of a triangle's bins with `by_value`, slot by slot.
std::array<double, renderer::TriangleBins::kSlots> contract(const renderer::TriangleBins& bins,
                                                            std::span<const double> by_value) {
    std::array<double, renderer::TriangleBins::kSlots> sums{};
    const double* weight = by_value.data() + bins.first_bin;
    for (const auto& bin : bins.bins) {
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += *weight * bin.slots[i];
        ++weight;
    }
    return sums;
}

}  // namespace

ElementShape element_shape(const std::array<Vec3, 3>& corners) {
    const Vec3 across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const double norm = across.norm();
    return {corners, across / norm, 0.5 * norm};
}

std::array<Vec3, 3> ShapeGradients::by_corners(const ElementShape& shape) const {
    const Vec3 edge1 = shape.corners[1] - shape.corners[0];
    const Vec3 edge2 = shape.corners[2] - shape.corners[0];
    const Vec3 by_across =
        0.5 * area_m2 * shape.normal +
        (normal - shape.normal.dot(normal) * shape.normal) / (2.0 * shape.area_m2);
    const Vec3 by_edge1 = edge2.cross(by_across);
    const Vec3 by_edge2 = by_across.cross(edge1);
    return {corners[0] - by_edge1 - by_edge2, corners[1] + by_edge1, corners[2] + by_edge2};
}

Path PartKernel::path_to(const Vec3& x, const Vec3& normal, Gradients gradients) const {
    const Segment sensor = make_segment(light_.ends[1], x, normal, gradients);
    if (light_.is_confocal) return join_segments(sensor, sensor, gradients);
    return join_segments(make_segment(light_.ends[0], x, normal, gradients), sensor, gradients);
}

PartKernel::Paths PartKernel::find_paths(const ElementShape& element,
                                         const PartBarycentrics& barycentrics,
                                         Gradients gradients) const {
    std::array<Vec3, 3> x;
    for (std::size_t j = 0; j < 3; ++j) {
        x[j] = barycentrics[j][0] * element.corners[0] + barycentrics[j][1] * element.corners[1] +
               barycentrics[j][2] * element.corners[2];
    }
    Paths paths;
    for (std::size_t j = 0; j < 3; ++j) {
        paths[j] = path_to(x[j], element.normal, gradients);
        paths[3 + j] = path_to(0.5 * (x[j] + x[(j + 1) % 3]), element.normal, gradients);
    }
    return paths;
}

void PartKernel::add(const ElementShape& element,
                     const PartBarycentrics& barycentrics,
                     double albedo,
                     std::span<double> histogram) {
    const double factor =
        light_.radiance_factor * albedo * element.area_m2 * fraction_of_area(barycentrics);
    const KnotFit fit = fit_knots(
        find_paths(element, barycentrics, Gradients::Without), light_.device_segments_m, factor);
    evaluate_triangle(fit.knots(), light_.sigma_m, light_.axis, Gradients::Without, bins_);
    double* target = histogram.data() + bins_.first_bin;
    for (const auto& bin : bins_.bins) *target++ += bin.slots[0];
}

double PartKernel::pull(const ElementShape& element,
                        const PartBarycentrics& barycentrics,
                        double albedo,
                        std::span<const double> by_value,
                        ShapeGradients& by_shape,
                        PartBarycentrics& by_barycentrics) {
    const double fraction = fraction_of_area(barycentrics);
    const double per_area = light_.radiance_factor * fraction;
    const double factor = per_area * element.area_m2;
    const Paths paths = find_paths(element, barycentrics, Gradients::With);
    const KnotFit fit = fit_knots(paths, light_.device_segments_m, factor);
    evaluate_triangle(fit.knots(), light_.sigma_m, light_.axis, Gradients::With, bins_);
    const auto sums = contract(bins_, by_value);
    const NodeGradients by_nodes =
        fit.pull({{albedo * sums[1], albedo * sums[2], albedo * sums[3]},
                  {albedo * sums[4], albedo * sums[5], albedo * sums[6]}});
    std::array<Vec3, 6> by_node;
    double by_factor = 0.0;
    for (std::size_t i = 0; i < 6; ++i) {
        const double by_weight = factor * by_nodes.weight[i];
        by_node[i] =
            by_nodes.opl[i] * paths[i].opl_by_position + by_weight * paths[i].factor_by_position;
        by_shape.normal += by_weight * paths[i].factor_by_normal;
        by_factor += by_nodes.weight[i] * paths[i].factor;
    }
    by_shape.area_m2 += by_factor * per_area;
    const double by_fraction = by_factor * light_.radiance_factor * element.area_m2;
    for (std::size_t j = 0; j < 3; ++j) {
        const Vec3 by_x = by_node[j] + 0.5 * (by_node[3 + j] + by_node[3 + (j + 2) % 3]);
        by_barycentrics[j] =
            by_fraction * barycentrics[(j + 1) % 3].cross(barycentrics[(j + 2) % 3]);
        for (Eigen::Index i = 0; i < 3; ++i) {
            const auto k = static_cast<std::size_t>(i);
            by_shape.corners[k] += barycentrics[j][i] * by_x;
            by_barycentrics[j][i] += by_x.dot(element.corners[k] - element.corners[0]);
        }
    }
    return sums[0];
}

}  // namespace calib
