// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/array_file.h"
#include "nlos/containers/hdf5_handle.h"
#include "renderer/core/settings/json_fwd.h"

#include <cstdint>
#include <memory>
#include <string>

namespace nlos {

/// An HDF5 file as the library reads it. Nothing outside the file is ever opened: external links,
/// external storage and virtual datasets are refused.
class Hdf5File : public ArrayFile {
 public:
    explicit Hdf5File(std::string path);

    std::string container() const override { return "hdf5"; }
    ArrayNames names() const override;
    std::optional<ArrayDescription> describe(const std::string& name) const override;
    std::string read(const std::string& name, const WantedRows& rows) const override;

    /// The file's root group.
    Hdf5Handle open_root() const;

 protected:
    std::string where(const std::string& name) const { return path_ + ": " + name; }

    /// The object of a name; not valid when there is none.
    virtual Hdf5Handle open_object(const std::string& name) const;
    Hdf5Handle open_member(const Hdf5Handle& group, const std::string& path) const;

    ArrayDescription describe_object(const Hdf5Handle& object, const std::string& name) const;

    /// Throws unless what a dataset claims to hold is stored in the file and fits in memory.
    void check_size(const Hdf5Handle& dataset, const Shape& shape, const std::string& where) const;

 private:
    core::Json describe_attributes(const Hdf5Handle& object, const std::string& name) const;

    std::string path_;
    std::uint64_t file_bytes_ = 0;
    Hdf5Handle file_;
};

/// Throws the core::Error of what the library could not read.
[[noreturn]] void throw_damaged_hdf5(const std::string& where);

/// The extents of a dataspace. Throws core::Error when it is damaged.
Shape extents_of(const Hdf5Handle& space, const std::string& where);

/// The names of a group's links that stay within the file, in the order in which they are stored.
ArrayNames links_of(const Hdf5Handle& group);

/// True when the file says of itself that MATLAB 7.3 wrote it, or its root's datasets do.
bool is_mat73_file(const Hdf5File& file, const std::string& path);

/// The same file with the names that MATLAB gives.
std::unique_ptr<ArrayFile> open_mat73_file(const std::string& path);

}  // namespace nlos
