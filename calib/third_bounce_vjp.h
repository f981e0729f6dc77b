// SPDX-License-Identifier: MIT
#pragma once

#include "calib/adjoint/adjoint_scene.h"
#include "calib/adjoint/counted_mesh.h"
#include "calib/adjoint/facet_tree.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/mesh.h"
#include "renderer/core/progress.h"
#include "renderer/core/settings/settings.h"

#include <span>
#include <vector>

namespace calib {

/// How the third bounce of a mesh is computed.
struct ThirdBounceVjpSettings {
    double tolerance = 0.02;
    double sigma_m = 0.0;
    double wall_albedo = 1.0;
};

template <class Visitor>
void for_each_field(ThirdBounceVjpSettings& settings, Visitor&& visit) {
    visit("tolerance",
          settings.tolerance,
          core::between(1e-5, 1.0, "relative L2 error that sizes the surface elements"));
    visit("sigma_m",
          settings.sigma_m,
          core::at_least(0, "standard deviation of a Gaussian response in path length [m]"));
    visit("wall_albedo", settings.wall_albedo, core::between(0, 1, "albedo of the relay wall"));
}

/// The third bounce of a triangle mesh, and gradients of what depends on it by the mesh.
///
/// Facets are diffuse on both sides and hide one another; the wall hides nothing. What both points
/// of a pair see of a facet is found exactly, as polygons whose corners move with the shadows that
/// bound them, so that gradients count how shadows move. They are those of the histograms returned,
/// to rounding. The histograms are exact up to the settings' tolerance, and the gradients, as
/// derivatives of them, up to several times that.
/// Histograms jump by part of their own error where a corner of one shadow moves over the edge of
/// another, so that only differences over short steps, about 1e-7 m, agree with gradients.
class ThirdBounceVjp {
 public:
    /// Computes the histograms.
    ///
    /// mesh       vertices [m, world]; facets without area count for nothing, of facets at one
    /// place
    ///            the first counts; normals are ignored
    /// albedo     per facet, at least 0
    /// scan       of wall points: single, confocal or exhaustive
    /// progress   asked now and then whether to stop
    /// throws     core::Error when one of these is not as said; core::Failure when stopped, and
    ///            beyond 200,000 surface elements
    ThirdBounceVjp(core::TriangleMesh mesh,
                   const std::vector<double>& albedo,
                   core::WallScan scan,
                   const core::TimeAxis& axis,
                   const ThirdBounceVjpSettings& settings,
                   const core::Progress& progress = {});

    /// Radiance leaving the sensing points for 1 W on the illumination points [W/(m^2 sr)], per bin
    /// (the bin's integral), as renderer::render() gives it: [pair][bin], bin fastest.
    const std::vector<double>& histograms() const { return histograms_; }

    /// Gradients of a number by the mesh, from its gradients by the histograms.
    ///
    /// by_value   as many as histograms(), in the same order
    /// progress   asked now and then whether to stop
    /// returns    the same bits for any number of threads
    /// throws     core::Error when `by_value` has another size or is not finite; core::Failure when
    ///            stopped
    MeshGradients pullback(std::span<const double> by_value,
                           const core::Progress& progress = {}) const;

 private:
    AdjointScene scene() const;

    CountedMesh counted_;
    std::vector<double> albedo_;  ///< per facet that counts
    core::WallScan scan_;
    core::TimeAxis axis_;
    ThirdBounceVjpSettings settings_;
    FacetTree tree_;
    std::vector<MeshElement> elements_;
    std::vector<double> histograms_;
    std::vector<ElementVisibility> visibility_;  ///< [pair][element]; empty where that is too much
};

}  // namespace calib
