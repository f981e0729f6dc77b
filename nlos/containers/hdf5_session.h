// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/hdf5_handle.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nlos {

/// An HDF5 file open for reading by the library, in this process; see Hdf5Reader.
///
/// Every failure is a core::Error that names file and dataset. Sizes are checked against the file's
/// own size before anything is allocated; what would not fit in memory is a core::Failure.
class Hdf5Session {
 public:
    explicit Hdf5Session(std::string path);

    const std::string& path() const { return path_; }

    /// How messages name a dataset: `file: name`.
    std::string where(const std::string& name) const { return path_ + ": " + name; }

    /// True when a dataset of this name holds something (a null dataspace is y-tal's "None").
    bool has(const std::string& name) const;
    /// True when the file has an object of this name, be it empty.
    bool has_object(const std::string& name) const;
    Shape shape(const std::string& name) const;
    Hdf5Kind kind(const std::string& name) const;

    /// All values of a numeric dataset of exactly the shape `wanted`, slowest index first.
    std::vector<float> read_floats(const std::string& name, const Shape& wanted) const;
    std::vector<double> read_doubles(const std::string& name, const Shape& wanted) const;

    /// The only value of a dataset of shape () or (1,).
    double read_real(const std::string& name) const;
    std::int64_t read_integer(const std::string& name) const;
    std::string read_text(const std::string& name) const;

    /// As many indices of the slowest axis as are best read at once.
    std::size_t rows_per_read(const std::string& name) const;

    /// Rows [first, first + count) of a numeric dataset.
    std::vector<float> read_row_range(const std::string& name,
                                      std::size_t first,
                                      std::size_t count) const;

    /// Attributes of an object ("/" is the file itself); nothing when missing.
    std::optional<std::string> text_attribute(const std::string& object,
                                              const std::string& name) const;
    std::optional<std::vector<double>> real_attribute(const std::string& object,
                                                      const std::string& name) const;

 private:
    Hdf5Handle open_dataset(const std::string& name) const;
    Hdf5Handle open_attribute(const std::string& object, const std::string& name) const;
    void require_numeric(const std::string& name) const;
    void check_size(const std::string& name) const;
    void check_texts() const;
    template <class T>
    std::vector<T> read_all(const std::string& name, const Shape& wanted) const;
    template <class T>
    T read_one(const std::string& name) const;

    std::string path_;
    std::uint64_t file_bytes_ = 0;
    mutable bool texts_checked_ = false;  ///< once, when a text is first asked for
    Hdf5Handle file_;
};

}  // namespace nlos
