// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

namespace nlos {

/// True when the file starts like an HDF5 file. Throws nothing.
bool is_hdf5_file(const std::string& path);

/// Closes what an HDF5 identifier stands for. Identifiers are 64-bit integers, so that headers need
/// nothing of HDF5.
class Hdf5Handle {
 public:
    using Close = int (*)(std::int64_t);

    Hdf5Handle() = default;
    Hdf5Handle(std::int64_t id, Close close_function) : id_(id), close_(close_function) {}
    ~Hdf5Handle() { close(); }
    Hdf5Handle(Hdf5Handle&& other) noexcept { swap(other); }
    Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
        swap(other);
        return *this;
    }

    bool is_valid() const { return id_ >= 0; }
    std::int64_t id() const { return id_; }

    /// Closes now; false when the library reports an error.
    bool close() {
        const std::int64_t id = std::exchange(id_, -1);
        return id < 0 || close_(id) >= 0;
    }

 private:
    void swap(Hdf5Handle& other) noexcept {
        std::swap(id_, other.id_);
        std::swap(close_, other.close_);
    }

    std::int64_t id_ = -1;
    Close close_ = nullptr;
};

/// Selects rows, along the slowest index, of a dataset's space; no rank: its only value. Returns
/// the space of as many values in memory.
Hdf5Handle select_rows(const Hdf5Handle& space, std::size_t first, std::size_t count);

/// Keeps the HDF5 library from printing its own messages; to be called before any use of it.
void prepare_hdf5();

}  // namespace nlos
