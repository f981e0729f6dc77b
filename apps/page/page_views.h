// SPDX-License-Identifier: MIT
#pragma once

#include "apps/page/film_view.h"
#include "apps/page/result_view.h"
#include "apps/page/truth_view.h"

#include <optional>
#include <string>
#include <vector>

namespace apps {

/// What the interactive views of a page are about.
struct PageViews {
    std::vector<ResultView> results;
    std::vector<FilmView> films;
    std::optional<core::Scan> scan;  ///< whose wall points are shown
    std::optional<TruthView> truth;
    std::size_t best = 0;  ///< of the results, to be shown first

    bool has_space() const { return !results.empty() || truth || (scan && !scan->camera); }
    bool empty() const { return !has_space() && films.empty(); }
};

/// Script elements with all data of the views, and with the scripts that show them.
///
/// The data have 8 bits per voxel and per bin, 16 per coordinate and per value of a map, and are
/// compressed. Where they would be larger than the limit, all volumes and films are halved along
/// their longest axis until they are not, and the views say so.
///
/// limit_bytes   of the data; the scripts are another 0.9 MB
/// returns       nothing for no views
std::string views_html(const PageViews& views, double limit_bytes);

}  // namespace apps
