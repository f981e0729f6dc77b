// SPDX-License-Identifier: MIT
#pragma once

#include "apps/dataset/item.h"
#include "nlos/containers/writers/hdf5_writer.h"
#include "nlos/containers/writers/tar_writer.h"
#include "renderer/core/settings/json_fwd.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace apps {

/// An item made ready for its shard, so that writers only copy.
struct PackedItem {
    std::vector<ItemArray> arrays;  ///< of HDF5: chunks, where rows are chunks
    std::string archive;            ///< of WebDataset: the arrays as .npz
    std::string parameters;         ///< JSON
};

/// Packs the arrays of an item, which it takes, for a shard of the recipe's format.
PackedItem pack_item(const Recipe& recipe, Item& item);

/// Items [begin, end) of a data set.
struct ItemRange {
    std::uint64_t begin = 0;
    std::uint64_t end = 0;

    std::uint64_t size() const { return end - begin; }
    bool contains(const ItemRange& other) const { return begin <= other.begin && other.end <= end; }
    bool operator==(const ItemRange&) const = default;
};

inline void from_json(const core::Json& json, ItemRange& items) {
    json.at(0).get_to(items.begin);
    json.at(1).get_to(items.end);
}
inline core::Json write_value(const ItemRange& items) {
    return {items.begin, items.end};
}

/// A file of consecutive items being written; finish() puts it in place. The same items give the
/// same bytes.
class ShardWriter {
 public:
    virtual ~ShardWriter() = default;
    /// The next item.
    /// throws   core::Failure when the disk is full; core::Error when arrays differ in shape from
    ///          those of the first item and the format does not allow it
    virtual void add(PackedItem item) = 0;
    virtual void finish() = 0;
};

/// A shard of HDF5: one dataset per array with the items along its first axis, `item` with their
/// numbers, `parameters` with one JSON text each; attributes `recipe` and `program`. Or a tar
/// archive for WebDataset: 000000123.npz and 000000123.json per item.
///
/// program   what made it, for people
std::unique_ptr<ShardWriter> make_shard_writer(const Recipe& recipe,
                                               const std::string& path,
                                               const ItemRange& items,
                                               const std::string& program);

}  // namespace apps
