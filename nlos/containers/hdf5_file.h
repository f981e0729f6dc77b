// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/hdf5_handle.h"
#include "renderer/core/settings.h"

#include <cstdint>
#include <string>

namespace nlos {

/// An HDF5 file as the library reads it, in this process; see Hdf5Reader.
///
/// Every failure is a core::Error that names file and dataset. Sizes are checked against the file's
/// own size before anything is allocated; what would not fit in memory is a core::Failure.
class Hdf5File {
 public:
    // Keys of describe().
    static constexpr const char* kShape = "shape";  ///< of a dataset that is not null
    static constexpr const char* kKind = "kind";    ///< an Hdf5Kind
    static constexpr const char* kText = "text";    ///< the only text of a dataset
    static constexpr const char* kRowsPerRead =
        "rows_per_read";  ///< whole chunks, as many as fit a read
    static constexpr const char* kAttributes = "attributes";  ///< texts, lists of numbers, or null

    explicit Hdf5File(std::string path);

    /// What an object is ("/" is the file itself); null when there is none of this name.
    core::Json describe(const std::string& name) const;

    /// The bytes of rows [first, first + count) of a numeric dataset as T, which is float or
    /// double; of a scalar one, those of its only value.
    template <class T>
    std::string read(const std::string& name, std::size_t first, std::size_t count) const;

 private:
    std::string where(const std::string& name) const { return path_ + ": " + name; }
    bool exists(const std::string& name) const;
    core::Json describe_attributes(const Hdf5Handle& object, const std::string& name) const;
    void check_size(const Hdf5Handle& dataset, const Shape& shape, const std::string& where) const;

    std::string path_;
    std::uint64_t file_bytes_ = 0;
    Hdf5Handle file_;
};

}  // namespace nlos
