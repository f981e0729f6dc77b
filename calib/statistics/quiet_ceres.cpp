// SPDX-License-Identifier: MIT
#include "calib/statistics/quiet_ceres.h"

#include <glog/logging.h>

namespace calib {

void quiet_ceres() {
    FLAGS_minloglevel = google::GLOG_FATAL;
}

}  // namespace calib
