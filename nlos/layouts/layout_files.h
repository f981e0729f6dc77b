// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/array_reader.h"
#include "nlos/layouts/layout.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// The file that a layout is about, and those beside it that its arrays name.
class LayoutFiles {
 public:
    /// path    a file of named arrays, of which other files are siblings
    /// throws  core::Error when it cannot be read
    explicit LayoutFiles(std::string path);

    const std::string& path() const { return path_; }
    const ArrayReader& main() const { return *main_; }

    /// Whether an array is there: in the main file or, named "other.mat:name", in one beside it.
    bool has(const std::string& array) const;

    /// How messages name an array.
    std::string where(const std::string& array) const;

    /// Extents as the writer of the file counts axes.
    Shape shape(const std::string& array) const;

    /// Whether the first axis of shape() runs fastest in what read() returns.
    bool first_index_fastest(const std::string& array) const;

    /// All values, in storage order.
    std::vector<double> read(const std::string& array) const;

    /// Calls take(values) for consecutive runs of values in storage order.
    template <class Take>
    void read_runs(const std::string& array, Take&& take) const {
        const Source source = find(array);
        if (source.reader->shape(source.name).empty()) {
            take(source.reader->read_floats(source.name, {}));
            return;
        }
        source.reader->read_rows(
            source.name,
            [&](std::size_t, std::size_t, const std::vector<float>& values) { take(values); });
    }

    /// A number as the layout says; nothing when the layout leaves it out.
    ///
    /// throws   core::Error when an array is missing or its element is, or the number must be asked
    ///          for; then the message names `setting`
    std::optional<double> number(const LayoutNumber& number, const std::string& setting) const;

 private:
    struct Source {
        const ArrayReader* reader;
        std::string name;
    };
    std::optional<Source> find_source(const std::string& array) const;
    Source find(const std::string& array) const;

    /// The bin, along the axis that runs fastest in storage, in which the sum of all histograms of
    /// an array peaks.
    std::size_t peak_bin(const std::string& array) const;

    std::string path_;
    std::unique_ptr<ArrayReader> main_;
    mutable std::map<std::string, std::unique_ptr<ArrayReader>> beside_;
};

}  // namespace nlos
