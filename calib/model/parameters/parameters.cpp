// SPDX-License-Identifier: MIT
// The list of all fit parameters.
#include "calib/model/parameters/albedo.h"
#include "calib/model/parameters/ambient.h"
#include "calib/model/parameters/heights.h"
#include "calib/model/parameters/point.h"
#include "calib/model/parameters/response_width.h"
#include "calib/model/parameters/rotation.h"
#include "calib/model/parameters/scale.h"
#include "calib/model/parameters/size.h"
#include "calib/model/parameters/time_zero.h"
#include "calib/model/parameters/translation.h"
#include "calib/model/parameters/wall.h"

namespace calib {

const std::vector<const Parameter*>& parameters() {
    static const std::vector<const Parameter*> kParameters{&kTranslation,
                                                           &kRotation,
                                                           &kSize,
                                                           &kAlbedo,
                                                           &kHeights,
                                                           &kPointPosition,
                                                           &kPointAlbedo,
                                                           &kTimeZero,
                                                           &kAmbient,
                                                           &kResponseWidth,
                                                           &kWallBow,
                                                           &kWallScale,
                                                           &kScale};
    return kParameters;
}

}  // namespace calib
