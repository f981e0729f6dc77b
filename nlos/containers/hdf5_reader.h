// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/hdf5_handle.h"
#include "renderer/core/settings.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace core {
class SandboxedProcess;
}

namespace nlos {

/// An HDF5 file open for reading.
///
/// The library (1.10) crashes on some files with damaged headers of the older kind, which have no
/// checksums, whatever is asked of it. It therefore runs in a process of its own, which describes
/// objects and reads rows of values. Every failure is a core::Error that names file and dataset;
/// what would not fit in memory is a core::Failure.
class Hdf5Reader {
 public:
    explicit Hdf5Reader(std::string path);
    ~Hdf5Reader();

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

    /// Reads a large numeric array piece by piece: calls `take(first, count, values)` for
    /// consecutive ranges of the slowest index; `values` holds `count` rows.
    template <class Take>
    void read_rows(const std::string& name, Take&& take) const {
        const std::size_t rows = shape(name).at(0);
        const std::size_t step = rows_per_read(name);
        for (std::size_t first = 0; first < rows; first += step) {
            const std::size_t count = std::min(step, rows - first);
            const std::vector<float> values = read_values<float>(name, first, count);
            take(first, count, values);
        }
    }

    /// Attributes of an object ("/" is the file itself); nothing when missing.
    std::optional<std::string> text_attribute(const std::string& object,
                                              const std::string& name) const;
    std::optional<std::vector<double>> real_attribute(const std::string& object,
                                                      const std::string& name) const;

 private:
    const core::Json& describe(const std::string& name) const;
    const core::Json& describe_dataset(const std::string& name) const;
    void require_numeric(const std::string& name) const;
    std::size_t rows_per_read(const std::string& name) const;
    template <class T>
    std::vector<T> read_all(const std::string& name, const Shape& wanted) const;
    template <class T>
    std::vector<T> read_values(const std::string& name, std::size_t first, std::size_t count) const;

    std::string path_;
    std::unique_ptr<core::SandboxedProcess> process_;
    mutable std::map<std::string, core::Json> described_;  ///< objects asked for so far
};

}  // namespace nlos
