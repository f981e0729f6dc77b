// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/array_file.h"
#include "nlos/containers/stored_number.h"

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nlos {

/// Numbers that lie in memory as a file stores them.
struct StoredArray {
    Shape shape;  ///< slowest first
    StoredNumber number = StoredNumber::Float64;
    std::endian order = std::endian::native;
    bool first_axis_fastest = false;  ///< stored in the reverse of shape: order of Fortran
    std::string_view bytes;           ///< as many as the shape asks for
    std::optional<ElementKind> kind;  ///< nothing: that of `number`
    std::string type;                 ///< empty: that of `number`
};

ArrayDescription describe_stored(const StoredArray& array);

/// The bytes of rows along the slowest axis of shape.
std::string read_stored(const StoredArray& array, const WantedRows& rows);

/// A file all of whose arrays and texts are known once it is open.
class StoredArrayFile : public ArrayFile {
 public:
    ArrayNames names() const override { return names_; }
    std::optional<ArrayDescription> describe(const std::string& name) const override;
    std::string read(const std::string& name, const WantedRows& rows) const override;

 protected:
    // Of two of the same name the first counts; what goes beyond ArrayNames::kMost is left out.
    void add_array(const std::string& name, StoredArray array);
    void add_values(const std::string& name,
                    const Shape& shape,
                    std::vector<double> values,
                    ElementKind kind,
                    const std::string& type);
    /// Of several texts, which no one reads, `shape` alone: it shows that they are there.
    void add_text(const std::string& name,
                  const Shape& shape,
                  const std::optional<std::string>& text);

    bool is_full() const { return !names_.is_complete; }

 private:
    bool add_name(const std::string& name);

    ArrayNames names_;
    std::map<std::string, StoredArray> arrays_;
    std::map<std::string, ArrayDescription> texts_;
    std::map<std::string, std::vector<double>> values_;  ///< of arrays that no file holds as such
};

}  // namespace nlos
