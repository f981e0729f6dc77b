// SPDX-License-Identifier: MIT
#pragma once

#include "apps/dataset/item.h"
#include "nlos/pictures/panel.h"

#include <vector>

namespace apps {

/// Pictures of an item, of what it has: the scene as an eye at the wall sees it, lit from there;
/// the streak of its middle row of sensing points; true depth; and whose surface is seen.
std::vector<nlos::Panel> preview_panels(const Recipe& recipe, const Item& item);

}  // namespace apps
