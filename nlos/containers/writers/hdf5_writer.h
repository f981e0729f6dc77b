// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/hdf5_handle.h"
#include "nlos/containers/shape.h"
#include "nlos/containers/stored_number.h"
#include "nlos/containers/writers/hdf5_storage.h"
#include "renderer/core/system/output_file.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace nlos {

/// An HDF5 file being written under a temporary name; finish() puts it in place.
///
/// Checksums guard arrays (see hdf5_storage.h), headers (by the library) and texts
/// (text_checksum.h).
///
/// Writes that fail (disk full) throw core::Failure and leave an older file as it was.
class Hdf5Writer {
 public:
    /// user_block   bytes in front of the HDF5 file that say to other programs what it is; their
    ///              number is 0 or a power of two from 512 on
    /// throws       core::Error when the target's folder does not exist or cannot be written
    explicit Hdf5Writer(std::string target, std::string user_block = {});

    void create_group(const std::string& name);
    void write(const std::string& name, const Shape& shape, std::span<const float> values);
    void write(const std::string& name, const Shape& shape, std::span<const double> values);
    void write(const std::string& name, const Shape& shape, std::span<const int> values);
    void write(const std::string& name, const Shape& shape, std::span<const std::uint8_t> values);
    void write_real(const std::string& name, double value);             ///< scalar float64
    void write_bool(const std::string& name, bool value);               ///< as h5py writes a bool
    void write_text(const std::string& name, const std::string& text);  ///< UTF-8, any length
    void write_null(const std::string& name);  ///< what h5py calls Empty and y-tal None

    /// A named value as h5py writes an enumeration: shape (1,), on 32-bit integers.
    void write_enum(const std::string& name,
                    const std::vector<std::pair<const char*, int>>& members,
                    int value);

    /// Writes a large float array piece by piece: `fill(first, count, values)` is asked for
    /// consecutive ranges of the slowest index.
    template <class Fill>
    void write_rows(const std::string& name, const Shape& shape, Fill&& fill) {
        const std::size_t row_values = values_per_row(shape);
        const std::size_t step = rows_of_write(shape, sizeof(float));
        const Hdf5Handle dataset = create_float_dataset(name, shape);
        std::vector<float> values;
        for (std::size_t first = 0; first < shape[0]; first += step) {
            const std::size_t count = std::min(step, shape[0] - first);
            values.resize(count * row_values);
            fill(first, count, values);
            write_row_range(dataset, first, count, values);
        }
    }

    /// A dataset whose rows, along the slowest index, are written one by one, each as a chunk.
    ///
    /// row_shape   of each row
    /// level       of deflate, as in pack_chunk()
    void create_rows(const std::string& name,
                     StoredNumber number,
                     std::size_t rows,
                     const Shape& row_shape,
                     int level);
    /// A row of it, packed by pack_chunk() at its level.
    void write_packed_row(const std::string& name, std::size_t row, const std::string& chunk);

    /// The numbers of a dataset as they lie in memory.
    void write_numbers(const std::string& name,
                       StoredNumber number,
                       const Shape& shape,
                       const std::string& bytes);
    void write_texts(const std::string& name, const std::vector<std::string>& texts);  ///< UTF-8

    /// Attributes of an object ("/" is the file itself).
    void write_attribute(const std::string& object,
                         const std::string& name,
                         const std::string& text);
    /// And beside it its checksum, see text_checksum.h.
    void write_guarded_attribute(const std::string& object,
                                 const std::string& name,
                                 const std::string& text);
    void write_attribute(const std::string& object,
                         const std::string& name,
                         const Shape& shape,
                         std::span<const double> values);
    /// ASCII of fixed length, not empty, as MATLAB wants it.
    void write_ascii_attribute(const std::string& object,
                               const std::string& name,
                               const std::string& text);

    /// Closes the file and moves it to its final name.
    void finish();

 private:
    Hdf5Handle create_dataset(const std::string& name,
                              std::int64_t type,
                              const Hdf5Handle& space,
                              const Hdf5Handle& plan);
    Hdf5Handle create_float_dataset(const std::string& name, const Shape& shape);
    void write_row_range(const Hdf5Handle& dataset,
                         std::size_t first,
                         std::size_t count,
                         const std::vector<float>& values);
    void write_dataset(const std::string& name,
                       std::int64_t type,
                       const Shape& shape,
                       const void* values);
    void write_attribute_values(const std::string& object,
                                const std::string& name,
                                std::int64_t type,
                                const Shape& shape,
                                const void* values);
    void write_user_block();
    void check(bool ok) const;

    std::string target_;
    std::string user_block_;
    core::OutputFile output_;
    Hdf5Handle file_;
    std::map<std::string, Hdf5Handle> row_datasets_;  ///< of create_rows()
};

}  // namespace nlos
