// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace core {

/// The known name that was most likely meant: few characters more, less, other or swapped with
/// their neighbours, upper and lower case and `-` and `_` being the same; or the only one that
/// begins so. Empty when none is near.
std::string nearest_name(std::string_view found, const std::vector<std::string>& known);

/// A text with the letters of ASCII in lower case.
std::string lower_case(std::string text);

/// "did you mean 'NAME'? " to begin what is allowed with; empty when no name is near.
std::string did_you_mean(std::string_view found, const std::vector<std::string>& known);

}  // namespace core
