// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit.h"

namespace python {

/// What Python calls a FitResult: a fit and what it was of.
struct FitObject {
    calib::FitInput input;
    calib::FitResult result;
};

}  // namespace python
