// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/shape.h"
#include "renderer/core/settings/boxed_json.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// What the elements of an array are. Enumerations and truth values count as integers.
enum class ElementKind { Integer, Real, Text, Other };

enum class Precision { Single, Double };

/// Rows [first, first + count) along the slowest index of an array, as float or double.
struct WantedRows {
    std::size_t first = 0;
    std::size_t count = 0;
    Precision precision = Precision::Single;
};

/// What a name in a file stands for.
struct ArrayDescription {
    std::optional<Shape> shape;  ///< nothing: a group, a struct, or nothing stored
    ElementKind kind = ElementKind::Other;
    std::string type = "file";        ///< of the elements, for people: "float32", "text", "cell"
    std::optional<std::string> text;  ///< of an array that holds one text
    std::size_t rows_per_read = 1;    ///< how much of the slowest index is best read at once
    core::BoxedJson attributes;       ///< texts, lists of numbers, or null
};

/// The names in a file, as many of them as an answer may hold.
struct ArrayNames {
    static constexpr std::size_t kMost = 4096;

    std::vector<std::string> names;
    bool is_complete = true;
};

/// A file of named arrays as its library reads it, in this process; see ArrayReader, which runs it
/// in a process of its own.
///
/// Every failure is a core::Error that names file and array. Sizes are checked against the file's
/// own size before anything is allocated; what would not fit in memory is a core::Failure.
class ArrayFile {
 public:
    virtual ~ArrayFile() = default;

    /// The container's name: "hdf5", "npz", ...; see ArrayReader::container().
    virtual std::string container() const = 0;

    /// Whether those who write such files count axes in the reverse of the stored order.
    virtual bool first_index_fastest() const { return false; }

    /// Arrays and texts, in the order of the file where it has one.
    virtual ArrayNames names() const = 0;

    /// Nothing when there is no object of this name. "/" is the file itself.
    virtual std::optional<ArrayDescription> describe(const std::string& name) const = 0;

    /// The bytes of rows of a numeric array; of one without axes, those of its only value. The
    /// array is one that describe() calls numeric.
    virtual std::string read(const std::string& name, const WantedRows& rows) const = 0;
};

/// A kind of file. To add one: write a .cpp with a function that returns its row, and list that
/// function in array_file.cpp. Files that nobody can read as they are, though they are often taken
/// for captures, are kinds too: `open` throws what is to be done.
struct Container {
    const char* content;  ///< for messages about files of other kinds: "HDF5"; null: never read

    /// True when a regular file starts like one of this kind, be it damaged further on.
    bool (*recognise)(const std::string& path);
    std::unique_ptr<ArrayFile> (*open)(const std::string& path);
};

/// For Container::open, of a class that is made from a path.
template <class File>
std::unique_ptr<ArrayFile> open_as(const std::string& path) {
    return std::make_unique<File>(path);
}

/// All kinds, in the order in which a file is tried.
const std::vector<Container>& containers();

/// The kind of a file by its content; null when it is of none, or no regular file.
const Container* find_container(const std::string& path);

/// How many rows of an array make a read of some megabytes.
std::size_t rows_of_read(const Shape& shape);

}  // namespace nlos
