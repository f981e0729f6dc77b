// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/hdf5_handle.h"

namespace nlos {

/// The filters of a dataset that this HDF5 library does not have, by name; empty: it can be read.
std::string missing_filters(const Hdf5Handle& dataset);

/// Throws core::Error that names them and how to do without.
///
/// path   of the file
/// name   of the dataset
void require_filters(const Hdf5Handle& dataset, const std::string& path, const std::string& name);

}  // namespace nlos
