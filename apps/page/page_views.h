// SPDX-License-Identifier: MIT
#pragma once

#include "apps/page/result_view.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/mesh.h"
#include "renderer/core/settings/json_fwd.h"

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// A capture as an animation: the light of every cell - wall point or pixel - by time or by frame.
struct AnimationView {
    enum class Kind { Wall, Camera, List };

    std::string name;    ///< of the file
    std::string detail;  ///< scan and size, in words
    std::string unit;    ///< of the values
    Kind kind = Kind::List;
    std::array<std::size_t, 2> size{};      ///< along x and y; of lists: points and 1
    std::array<double, 2> x_m{};            ///< outer edges of the cells of a wall
    std::array<double, 2> y_m{};            ///< likewise
    std::vector<core::Vec3> positions;      ///< of the points of a list [m, world]
    std::vector<std::string> labels;        ///< of frames; empty where time is shown
    std::size_t num_bins = 0;               ///< or frames
    double start_m = 0.0;                   ///< path length at the start of the first bin
    double step_m = 0.0;                    ///< width of a bin
    std::array<std::size_t, 2> lit_bins{};  ///< first and last of those with all but 0.2 % of light
    std::size_t merged = 1;                 ///< bins of the capture in one of these
    bool whole = true;                      ///< the values are whole numbers
    LogCoding coding;
    std::vector<std::uint8_t>
        codes;  ///< stored [cell][bin]; cells [x][y], of cameras [row][column]
};

/// A sequence by its frames, all bins of each together; everything else by path length, from the
/// first to the last bin with light. Of exhaustive scans: the middle illumination point.
AnimationView animation_view(const core::Capture& capture, const std::string& name);

/// The animation with pairs of bins as one; of frames: as it is.
AnimationView halved(const AnimationView& animation);

/// How often an animation can be halved until it has 16 bins or fewer; of frames: 0.
int halvings_of(const AnimationView& animation);

/// What the page's script reads of an animation.
///
/// frame_from_world   of the positions
/// halvings           how often it is halved, unless it is small before
core::Json animation_json(AnimationView animation,
                          const core::Transform& frame_from_world,
                          int halvings,
                          PageArrays& arrays);

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

/// What the interactive views of a page are about.
struct PageViews {
    std::vector<ResultView> results;
    std::vector<AnimationView> animations;
    std::optional<core::WallScan> scan;  ///< whose wall points are shown
    std::optional<TruthView> truth;
    std::size_t best = 0;  ///< of the results, to be shown first

    bool has_space() const { return !results.empty() || truth || scan; }
    bool empty() const { return !has_space() && animations.empty(); }
};

/// How much of the views a page has room for.
struct ViewDetail {
    int halvings = 0;  ///< of volumes and animations, each at most down to 16 voxels or bins
    std::size_t most = std::numeric_limits<std::size_t>::max();  ///< results, and animations, shown
    bool has_views = true;                                       ///< or there is no room for any

    /// Whether the result of this index is shown: the first ones are, and the best.
    bool shows_result(const PageViews& views, std::size_t index) const;
};

/// The views of a page, as far as there is room for them.
struct FittedViews {
    std::string data;          ///< script elements with all data of the views; empty: no views
    double whole_bytes = 0.0;  ///< of the data, if all were shown as it is
    ViewDetail detail;

    /// The data, and the scripts that show them: another 1 MB.
    std::string html() const;
};

/// Makes the data of the views as large as a page has room for.
///
/// The data have 8 bits per voxel and per bin, 16 per coordinate and per value of a map, and are
/// compressed. Where they would be larger than the limit, all volumes and animations are halved
/// along their longest axis until they are not, and the views say so. Where that is not enough,
/// only some results and animations are shown, and at last none.
///
/// limit_bytes   of the data
FittedViews fit_views(const PageViews& views, double limit_bytes);

}  // namespace apps
