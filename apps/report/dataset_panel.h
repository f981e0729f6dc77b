// SPDX-License-Identifier: MIT
#pragma once

#include "apps/report/result_panels.h"

#include <string>

namespace apps {

/// True for a folder that `nlos generate` made.
bool is_dataset(const std::string& folder);

/// True for the files of a data set, which a page shows together.
bool belongs_to_dataset(const std::string& file_name);

/// What a page shows of a data set.
struct DatasetPanel {
    ResultPanel panel;           ///< its picture shows the first items
    std::string histograms_png;  ///< of what was drawn; empty: nothing was
};

/// throws   core::Error when the folder's recipe is damaged
DatasetPanel dataset_panel(const std::string& folder);

}  // namespace apps
