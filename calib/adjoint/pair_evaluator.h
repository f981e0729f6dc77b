// SPDX-License-Identifier: MIT
#pragma once

#include "calib/adjoint/adjoint_scene.h"
#include "calib/adjoint/occluder_views.h"
#include "calib/adjoint/part_kernel.h"
#include "calib/adjoint/polygon_clipper.h"

#include <array>
#include <span>
#include <vector>

namespace calib {

/// The third bounce of one pair after another, and its gradients in reverse.
///
/// An element's visible part is what is left of it once the shadows that all other facets cast from
/// both wall points are cut off, each along straight lines.
/// Nothing is kept between the histograms and the way back: pairs are cut again, in parallel.
class PairEvaluator {
 public:
    /// scene   must outlive this
    explicit PairEvaluator(const AdjointScene& scene);
    PairEvaluator(const PairEvaluator&) = delete;

    /// Adds the histogram of a pair.
    ///
    /// seen   per element, set; or empty
    void add(std::size_t pair, std::span<double> histogram, std::span<ElementVisibility> seen);

    /// Adds the gradients of the inner product of a pair's histogram with `by_value`.
    ///
    /// seen   as add() set it, which saves most of the cutting; or empty
    void pull(std::size_t pair,
              std::span<const double> by_value,
              std::span<const ElementVisibility> seen,
              MeshGradients& gradients);

    /// Area of each facet that both ends of a pair see [m^2].
    std::vector<double> visible_areas(std::size_t pair);

 private:
    void look_at(std::size_t pair);
    template <class Visit>
    void for_each_visible(std::span<const ElementVisibility> known, const Visit& visit);
    bool may_be_on_axis(const MeshElement& element) const;
    bool find_views(const MeshElement& element);
    bool cut(const MeshElement& element, std::size_t index);
    void pull_element(const MeshElement& element,
                      std::span<const double> by_value,
                      MeshGradients& gradients);

    const AdjointScene& scene_;
    PairLight light_;
    std::size_t num_ends_ = 1;
    std::vector<OccluderViews> views_;  ///< per end
    PartKernel kernel_;
    PolygonClipper clipper_;
    CutPullback cuts_;
    std::array<ElementView, 2> seen_;  ///< of one element, per end
    std::vector<core::Vec3> by_barycentrics_;
};

}  // namespace calib
