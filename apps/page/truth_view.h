// SPDX-License-Identifier: MIT
#pragma once

#include "apps/page/result_view.h"
#include "renderer/core/mesh.h"

#include <string>
#include <vector>

namespace apps {

/// The hidden scene as it is.
struct TruthView {
    std::string name;         ///< of the scene
    core::TriangleMesh mesh;  ///< its hidden surfaces [m, world]; of very many, a simpler shape
    core::DepthMap depth;     ///< seen from the first result's columns, else from the whole wall
};

/// Loads a scene and traces what the wall sees of it, also from the columns of each result, whose
/// `truth` it sets.
///
/// throws   core::Error as reading the scene does, and when it has no relay wall
TruthView truth_view(const std::string& scene_path, std::vector<ResultView>& results);

}  // namespace apps
