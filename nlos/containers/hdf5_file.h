// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/array_file.h"
#include "nlos/containers/hdf5_handle.h"

#include <cstdint>
#include <string>

namespace nlos {

/// An HDF5 file as the library reads it.
class Hdf5File : public ArrayFile {
 public:
    explicit Hdf5File(std::string path);

    std::string container() const override { return "hdf5"; }
    ArrayNames names() const override;
    std::optional<ArrayDescription> describe(const std::string& name) const override;
    std::string read(const std::string& name,
                     std::size_t first,
                     std::size_t count,
                     Precision precision) const override;

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
