// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/writers/hdf5_writer.h"

namespace nlos {

/// A MATLAB v7.3 file being written: HDF5 behind a block of 512 bytes that names it, each array
/// with its MATLAB class. Shapes are slowest first as everywhere, the reverse of MATLAB's.
///
/// Throws and leaves older files as Hdf5Writer does.
class Mat73Writer {
 public:
    explicit Mat73Writer(std::string target);

    /// A MATLAB array of class double.
    void write(const std::string& name, const Shape& shape, std::span<const double> values);

    /// A large MATLAB array of class single, see Hdf5Writer::write_rows().
    template <class Fill>
    void write_rows(const std::string& name, const Shape& shape, Fill&& fill) {
        file_.write_rows(name, shape, std::forward<Fill>(fill));
        write_class(name, "single");
    }

    void finish() { file_.finish(); }

 private:
    void write_class(const std::string& name, const char* matlab_class);

    Hdf5Writer file_;
};

}  // namespace nlos
