// SPDX-License-Identifier: MIT
#pragma once

#include "apps/report/results_folder.h"

namespace apps {

/// Names volumes, and what is scored of them, by their method; several of one method also by the
/// settings in which they differ, or, where they differ in none, by their files.
void label_by_method(ResultsFolder& results);

}  // namespace apps
