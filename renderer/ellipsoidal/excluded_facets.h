// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/time_axis.h"
#include "renderer/scene/scene.h"
#include "renderer/settings/render_settings.h"

#include <string>
#include <vector>

namespace renderer {

/// What is excluded from ellipsoidal connections, by name; see ExcludedFacets.
struct ExcludedObjects {
    std::vector<std::string> names;      ///< objects of which some facet is excluded
    std::vector<std::string> connected;  ///< those of them that `mis` connects to nonetheless
};

/// Which facets ellipsoidal connections leave out, and why that is known.
///
/// Excluded are, unless the mode is `none`, objects with the role of a wall, objects that say so,
/// and facets above an area. There the technique has density 0, with an exception: what `mis`
/// leaves out walks must find, and where the time axis asks for a small part only of the lengths
/// that a wall gives rise to, they hardly ever do (on scenes/corner, in a gate of 10 mm, 2,000
/// times the variance). So `mis` connects to an object, unless it is the relay wall, while the axis
/// is shorter than the object is wide.
struct ExcludedFacets {
    std::vector<bool> facets;  ///< per facet of the scene: whether the technique has density 0
    ExcludedObjects objects;

    /// axis   lengths asked for
    static ExcludedFacets of(const Scene& scene,
                             const core::TimeAxis& axis,
                             const RenderSettings& settings);
};

}  // namespace renderer
