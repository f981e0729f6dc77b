// SPDX-License-Identifier: MIT
#include "apps/dataset/shard_writer.h"

#include "nlos/containers/writers/npz_writer.h"
#include "nlos/containers/writers/packed_chunk.h"

#include <fmt/core.h>

#include <numeric>

namespace apps {
namespace {

/// Arrays from this size on are stored as one chunk per item, smaller ones in one piece.
constexpr std::size_t kLeastChunkBytes = 1024;

bool is_chunked(const ItemArray& array) {
    return nlos::total_bytes(array.shape, nlos::bytes_of(array.number)) >= kLeastChunkBytes;
}

class Hdf5Shard : public ShardWriter {
 public:
    Hdf5Shard(const Recipe& recipe,
              const std::string& path,
              const ItemRange& items,
              const std::string& program)
        : items_(items), compression_(recipe.storage.compression), file_(path) {
        file_.write_attribute("/", "recipe", write_identity(recipe).dump());
        file_.write_attribute("/", "program", program);
    }

    void add(PackedItem item) override {
        if (columns_.empty()) create(item.arrays);
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            const ItemArray& array = item.arrays.at(i);
            if (array.shape != columns_[i].shape) {
                throw core::Error(
                    fmt::format("item {}: {}", items_.begin + parameters_.size(), array.name),
                    "has the shape " + nlos::shape_text(array.shape),
                    "must have that of the first item, " + nlos::shape_text(columns_[i].shape) +
                        "; format webdataset allows others");
            }
            if (is_chunked(array)) {
                file_.write_packed_row(array.name, parameters_.size(), array.bytes);
            } else {
                columns_[i].bytes += array.bytes;
            }
        }
        parameters_.push_back(std::move(item.parameters));
    }

    void finish() override {
        for (const ItemArray& column : columns_) {
            if (!is_chunked(column)) write_whole(column);
            if (column.coordinates) {
                nlos::state_coordinates(file_, column.name, *column.coordinates);
            }
        }
        std::vector<std::uint64_t> numbers(items_.size());
        std::iota(numbers.begin(), numbers.end(), items_.begin);
        file_.write_numbers(
            "item",
            nlos::StoredNumber::UInt64,
            {numbers.size()},
            make_item_array<std::uint64_t>("item", {}, nlos::StoredNumber::UInt64, numbers).bytes);
        file_.write_texts("parameters", parameters_);
        file_.finish();
    }

 private:
    void write_whole(const ItemArray& column) {
        nlos::Shape shape = column.shape;
        shape.insert(shape.begin(), parameters_.size());
        file_.write_numbers(column.name, column.number, shape, column.bytes);
    }

    void create(const std::vector<ItemArray>& arrays) {
        for (const ItemArray& array : arrays) {
            columns_.push_back({array.name, array.shape, array.number, {}, array.coordinates});
            if (!is_chunked(array)) continue;
            file_.create_rows(array.name, array.number, items_.size(), array.shape, compression_);
        }
    }

    ItemRange items_;
    int compression_;
    nlos::Hdf5Writer file_;
    std::vector<ItemArray> columns_;  ///< with the bytes of those that are not chunked
    std::vector<std::string> parameters_;
};

class WebDatasetShard : public ShardWriter {
 public:
    WebDatasetShard(const std::string& path, const ItemRange& items)
        : next_(items.begin), archive_(path) {}

    void add(PackedItem item) override {
        const std::string key = fmt::format("{:09}", next_++);
        archive_.add(key + ".npz", item.archive);
        archive_.add(key + ".json", item.parameters);
    }

    void finish() override { archive_.finish(); }

 private:
    std::uint64_t next_;
    nlos::TarWriter archive_;
};

}  // namespace

PackedItem pack_item(const Recipe& recipe, Item& item) {
    PackedItem packed;
    packed.parameters = item.parameters.dump();
    if (recipe.format == DatasetFormat::WebDataset) {
        nlos::NpzWriter archive;
        for (const ItemArray& array : item.arrays) {
            archive.write_numbers(array.name, array.number, array.shape, array.bytes);
        }
        packed.archive = archive.finish_in_memory();
        return packed;
    }
    packed.arrays = std::move(item.arrays);
    for (ItemArray& array : packed.arrays) {
        if (!is_chunked(array)) continue;
        array.bytes =
            nlos::pack_chunk(array.bytes, nlos::bytes_of(array.number), recipe.storage.compression);
    }
    return packed;
}

std::unique_ptr<ShardWriter> make_shard_writer(const Recipe& recipe,
                                               const std::string& path,
                                               const ItemRange& items,
                                               const std::string& program) {
    if (recipe.format == DatasetFormat::WebDataset) {
        return std::make_unique<WebDatasetShard>(path, items);
    }
    return std::make_unique<Hdf5Shard>(recipe, path, items, program);
}

}  // namespace apps
