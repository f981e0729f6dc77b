// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/time_axis.h"
#include "renderer/scene/scene.h"
#include "renderer/settings/render_settings.h"

#include <string>
#include <vector>

namespace renderer {

/// Names of the objects excluded from ellipsoidal connections; see ExcludedFacets.
struct ExcludedObjects {
    std::vector<std::string> names;      ///< objects of which some facet is excluded
    std::vector<std::string> connected;  ///< those of them that `mis` connects to all the same
};

/// Which facets ellipsoidal connections leave out.
///
/// Unless the mode is `none`, these are objects with the role of a wall, objects marked as
/// excluded, and facets above a given area; there the technique has density 0. With `mis`, walks
/// must find what is left out, which they hardly ever do where the time axis covers only a small
/// part of the lengths of paths by way of a wall (2,000 times the variance on scenes/corner in a
/// gate of 10 mm). So `mis` still connects to an object, other than the relay wall, that is wider
/// than the axis is long.
struct ExcludedFacets {
    std::vector<bool> facets;  ///< per facet of the scene: whether the technique has density 0
    ExcludedObjects objects;

    /// axis   lengths asked for
    static ExcludedFacets of(const Scene& scene,
                             const core::TimeAxis& axis,
                             const RenderSettings& settings);
};

}  // namespace renderer
