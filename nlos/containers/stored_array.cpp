// SPDX-License-Identifier: MIT
#include "nlos/containers/stored_array.h"

#include <algorithm>

namespace nlos {
namespace {

/// Rows of an array whose first axis is the fastest, in the order of shape.
std::string gather_rows(const StoredArray& array, std::size_t first, std::size_t count) {
    const std::size_t size = bytes_of(array.number);
    const std::size_t row = values_per_row(array.shape);
    const std::size_t rank = array.shape.size();
    std::string rows(count * row * size, '\0');
    std::vector<std::size_t> index(rank, 0);
    for (std::size_t i = 0; i < row; ++i) {
        std::size_t column = 0;  // of the stored array, whose columns are as long as the first axis
        for (std::size_t axis = rank; axis-- > 1;)
            column = column * array.shape[axis] + index[axis];
        const char* from = array.bytes.data() + (column * array.shape[0] + first) * size;
        for (std::size_t j = 0; j < count; ++j) {
            std::copy_n(from + j * size, size, rows.data() + (j * row + i) * size);
        }
        for (std::size_t axis = rank; axis-- > 1;) {
            if (++index[axis] < array.shape[axis]) break;
            index[axis] = 0;
        }
    }
    return rows;
}

}  // namespace

ArrayDescription describe_stored(const StoredArray& array) {
    // So many rows use the whole of every cache line that is read of an array stored the other way.
    constexpr std::size_t kRowsOfColumns = 16;
    ArrayDescription description;
    description.shape = array.shape;
    description.kind = array.kind.value_or(kind_of(array.number));
    description.type = array.type.empty() ? type_name(array.number) : array.type;
    description.rows_per_read = rows_of_read(array.shape);
    if (array.first_axis_fastest) {
        description.rows_per_read = std::max(description.rows_per_read, kRowsOfColumns);
    }
    return description;
}

std::string read_stored(const StoredArray& array, const WantedRows& rows) {
    if (total_bytes(array.shape, 1) == 0) return {};
    const std::size_t row = values_per_row(array.shape);
    std::string gathered;
    const char* begin = array.bytes.data() + rows.first * row * bytes_of(array.number);
    if (array.first_axis_fastest && array.shape.size() > 1) {
        gathered = gather_rows(array, rows.first, rows.count);
        begin = gathered.data();
    }
    return convert_numbers(begin, rows.count * row, array.number, array.order, rows.precision);
}

std::optional<ArrayDescription> StoredArrayFile::describe(const std::string& name) const {
    if (name == "/") return ArrayDescription();
    if (const auto array = arrays_.find(name); array != arrays_.end()) {
        return describe_stored(array->second);
    }
    if (const auto text = texts_.find(name); text != texts_.end()) return text->second;
    return std::nullopt;
}

std::string StoredArrayFile::read(const std::string& name, const WantedRows& rows) const {
    return read_stored(arrays_.at(name), rows);
}

void StoredArrayFile::add_array(const std::string& name, StoredArray array) {
    if (add_name(name)) arrays_.emplace(name, std::move(array));
}

void StoredArrayFile::add_values(const std::string& name,
                                 const Shape& shape,
                                 std::vector<double> values,
                                 ElementKind kind,
                                 const std::string& type) {
    if (!add_name(name)) return;
    const std::vector<double>& kept = values_.emplace(name, std::move(values)).first->second;
    StoredArray array;
    array.shape = shape;
    array.bytes = {reinterpret_cast<const char*>(kept.data()), kept.size() * sizeof(double)};
    array.kind = kind;
    array.type = type;
    arrays_.emplace(name, std::move(array));
}

void StoredArrayFile::add_text(const std::string& name,
                               const Shape& shape,
                               const std::optional<std::string>& text) {
    if (!add_name(name)) return;
    ArrayDescription& description = texts_[name];
    description.shape = shape;
    description.kind = ElementKind::Text;
    description.type = "text";
    description.text = text;
}

bool StoredArrayFile::add_name(const std::string& name) {
    if (arrays_.contains(name) || texts_.contains(name)) return false;
    names_.is_complete = names_.is_complete && names_.names.size() < ArrayNames::kMost;
    if (names_.is_complete) names_.names.push_back(name);
    return names_.is_complete;
}

}  // namespace nlos
