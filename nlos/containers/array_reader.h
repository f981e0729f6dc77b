// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/array_file.h"
#include "renderer/core/settings/json_fwd.h"

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

/// A file of named arrays open for reading, whatever its container.
///
/// Libraries for file formats crash on some damaged files, whatever is asked of them. They
/// therefore run in a process of their own, which describes objects and reads rows of values. Every
/// failure is a core::Error that names file and array; what would not fit in memory is a
/// core::Failure.
///
/// Names are paths: members of HDF5 groups are "nlos/variance"; fields of MATLAB structs
/// "dataset.laserPos", of arrays of structs "dataset(0).laserPos", elements of cells "accum{0}";
/// leaves of JSON "configuration.range" (see JsonLeaves). The array of a .npy file is "array", that
/// of a .csv file "table", beside its columns by name.
class ArrayReader {
 public:
    /// Opens a regular file, whose container is recognised by its content (CSV by its suffix).
    explicit ArrayReader(std::string path);
    ~ArrayReader();

    const std::string& path() const { return path_; }

    /// How messages name an array: `file: name`.
    std::string where(const std::string& name) const { return path_ + ": " + name; }

    /// "hdf5", "matlab-v5", "matlab-v7.3", "npy", "npz", "bonn-ti", "json" or "csv".
    const std::string& container() const { return container_; }

    /// True for MATLAB files, whose writers count axes in the reverse of shape(): shapes are always
    /// as stored, slowest first.
    bool first_index_fastest() const { return first_index_fastest_; }

    /// Arrays and texts, at most ArrayNames::kMost of them; names_are_complete() tells whether
    /// there are more.
    const std::vector<std::string>& names() const { return listed().names; }
    bool names_are_complete() const { return listed().is_complete; }

    /// True when an array of this name holds something (a null dataspace is y-tal's "None").
    bool has(const std::string& name) const;
    /// True when the file has an object of this name, be it empty or no array.
    bool has_object(const std::string& name) const;
    Shape shape(const std::string& name) const;
    ElementKind kind(const std::string& name) const;
    /// What the elements are, for people: "float32", "uint16", "text", "cell", "struct".
    std::string type(const std::string& name) const;

    /// All values of a numeric array of exactly the shape `wanted`, slowest index first.
    std::vector<float> read_floats(const std::string& name, const Shape& wanted) const;
    std::vector<double> read_doubles(const std::string& name, const Shape& wanted) const;

    /// The only value of an array: shape (), (1,), (1, 1) and so on.
    double read_real(const std::string& name) const;
    std::int64_t read_integer(const std::string& name) const;
    std::string read_text(const std::string& name) const;

    /// Reads a large numeric array piece by piece: calls `take(first, count, values)` for
    /// consecutive ranges of the slowest index; `values` holds `count` rows.
    template <class Take>
    void read_rows(const std::string& name, Take&& take) const {
        const std::size_t rows = row_count(name);
        const std::size_t step = rows_per_read(name);
        for (std::size_t first = 0; first < rows; first += step) {
            const std::size_t count = std::min(step, rows - first);
            const std::vector<float> values = read_values<float>(name, first, count);
            take(first, count, values);
        }
    }

    /// Attributes of an HDF5 object ("/" is the file itself); nothing when missing.
    std::optional<std::string> text_attribute(const std::string& object,
                                              const std::string& name) const;
    std::optional<std::vector<double>> real_attribute(const std::string& object,
                                                      const std::string& name) const;

 private:
    core::Json ask(const core::Json& request) const;
    const ArrayNames& listed() const;
    const std::optional<ArrayDescription>& describe(const std::string& name) const;
    const ArrayDescription& describe_array(const std::string& name) const;
    const core::Json* find_attribute(const std::string& object, const std::string& name) const;
    void check_text(const std::string& text,
                    const std::string& object,
                    const std::string& checksum) const;
    void require_numeric(const std::string& name) const;
    std::size_t row_count(const std::string& name) const;
    std::size_t rows_per_read(const std::string& name) const;
    template <class T>
    std::vector<T> read_all(const std::string& name, const Shape& wanted) const;
    template <class T>
    std::vector<T> read_values(const std::string& name, std::size_t first, std::size_t count) const;

    std::string path_;
    std::string container_;
    bool first_index_fastest_ = false;
    std::unique_ptr<core::SandboxedProcess> process_;
    mutable std::optional<ArrayNames> names_;
    /// Objects asked for so far.
    mutable std::map<std::string, std::optional<ArrayDescription>> described_;
};

/// The file open for reading; nothing when ArrayReader knows no container for it.
/// Throws core::Error when a file of a known container is damaged.
std::shared_ptr<const ArrayReader> open_arrays(const std::string& path);

/// The container of a file, by content; nothing when ArrayReader knows none for it.
/// Throws core::Error when a file of a known container is damaged.
std::optional<std::string> container_of(const std::string& path);

}  // namespace nlos
