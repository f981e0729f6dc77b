// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/layout_files.h"

#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// The array of histograms of a file, with its axes as the layout names them.
struct HistogramArray {
    std::string name;
    std::vector<std::string> axes;  ///< in the writer's order
    Shape extents;
    bool reversed = false;  ///< whether they stand in reverse of the layout's order

    std::optional<std::size_t> extent(const std::string& axis) const;
};

/// Finds it. Nothing when the file holds none that fits the layout's axes.
std::optional<HistogramArray> find_histograms(const LayoutFiles& files, const Layout& layout);

/// What a file lacks to be of this layout, a few words each; nothing: it is of this layout.
std::vector<std::string> mismatches(const LayoutFiles& files, const Layout& layout);

}  // namespace nlos
