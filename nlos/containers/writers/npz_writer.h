// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/shape.h"
#include "nlos/containers/stored_number.h"
#include "renderer/core/system/output_file.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

struct zip;
struct zip_source;

namespace nlos {

/// A NumPy .npz file being written: a zip archive of deflated .npy members, which numpy.load()
/// opens without pickle. finish() writes it and puts it in place.
///
/// Writes that fail (disk full) throw core::Failure and leave an older file as it was. The same
/// arrays give the same bytes.
class NpzWriter {
 public:
    /// Writes rows [first, first + count) of the slowest index to `values`.
    using Fill =
        std::function<void(std::size_t first, std::size_t count, std::vector<float>& values)>;

    /// Throws core::Error when the target's folder does not exist or cannot be written.
    explicit NpzWriter(std::string target);
    /// Writes to memory, see finish_in_memory().
    NpzWriter();
    ~NpzWriter();

    void write(const std::string& name, const Shape& shape, std::span<const double> values);
    void write(const std::string& name, const Shape& shape, std::span<const int> values);
    /// Numbers as they lie in memory.
    void write_numbers(const std::string& name,
                       StoredNumber number,
                       const Shape& shape,
                       const std::string& bytes);
    void write_real(const std::string& name, double value);             ///< of shape ()
    void write_text(const std::string& name, const std::string& text);  ///< UTF-8; of shape ()

    /// A large float32 array, no extent 0. `fill` is asked for consecutive ranges of the slowest
    /// index while finish() runs, until when what it reads from must live.
    void write_rows(const std::string& name, const Shape& shape, Fill fill);

    void finish();
    /// The bytes of what was written to memory.
    std::string finish_in_memory();

 private:
    void add_member(const std::string& name, const std::string& header, std::string bytes);
    void add_source(const std::string& name, zip_source* source);
    void close();
    void check(bool ok) const;

    std::string target_;
    std::optional<core::OutputFile> output_;
    zip_source* memory_ = nullptr;  ///< what is written to memory; one reference is ours
    std::unique_ptr<zip, void (*)(zip*)> archive_;
};

}  // namespace nlos
