// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings.h"
#include "renderer/material/material.h"

#include <string>
#include <vector>

namespace renderer {

/// True for a plugin that is a BSDF, by its type.
bool is_bsdf(const core::Json& plugin);

/// True for a BSDF, and for a reference unless it names something else of the scene.
bool leads_to_bsdf(const core::Json& plugin, const core::Json& scene);

/// The material that a BSDF of Mitsuba stands for.
///
/// bsdf             an object with a known type, or a reference to one of `scene`
/// scene            the whole scene, in which references are looked up
/// where            file and key, for messages
/// not_translated   gets a line for what is left out or taken as something else
Material mitsuba_material(const core::Json& bsdf,
                          const core::Json& scene,
                          const std::string& where,
                          std::vector<std::string>& not_translated);

}  // namespace renderer
