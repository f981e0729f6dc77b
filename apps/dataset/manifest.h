// SPDX-License-Identifier: MIT
#pragma once

#include "apps/dataset/item.h"
#include "apps/dataset/shard_writer.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// What items took, and what was odd about them.
struct ItemTotals {
    ItemProfile profile;
    std::map<std::string, std::string> broken_meshes;  ///< drawn, and why they were skipped
    std::size_t dark_items = 0;
    std::size_t clipped_counts = 0;

    void add(const ItemTotals& other);
};

/// What stands beside a shard and says that it is whole: written after it.
struct Manifest : ItemTotals {
    std::string fingerprint;
    std::string program;
    std::string file;  ///< name of the shard, in the same folder
    ItemRange items;
    std::optional<ItemRange> asked;  ///< of the run that made it; nothing: all
    std::uint64_t bytes = 0;
    std::string checksum;
    double seconds = 0.0;  ///< of the wall clock
    std::map<std::string, std::vector<double>> drawn;
};

template <class Visitor>
void for_each_field(Manifest& m, Visitor&& visit) {
    visit("fingerprint", m.fingerprint, "of the recipe and its meshes");
    visit("program", m.program, "that made it");
    visit("file", m.file, "name of the shard");
    visit("items", m.items, "first, and one past the last");
    visit("asked", m.asked, "the items that the run was asked for; null: all");
    visit("bytes", m.bytes, "of the file");
    visit("xxh128", m.checksum, "XXH3 of 128 bits, as `xxh128sum` prints it");
    visit("seconds", m.seconds, "of the wall clock");
    visit("cpu_seconds", m.profile, "processor time of all its items");
    visit("broken_meshes", m.broken_meshes, "drawn, and why they were skipped");
    visit("dark_items", m.dark_items, "without light of their scene");
    visit("clipped_counts", m.clipped_counts, "beyond what the histograms' type can hold");
    visit("drawn", m.drawn, "numbers drawn, per item, by key");
}

/// The name of a shard, without suffix.
std::string shard_name(std::uint64_t shard);

/// The path of the manifest that stands beside shard `shard`.
std::string manifest_path(const std::string& folder, std::uint64_t shard);

/// The picture of the first items, beside the first shard. suffix: .png or .svg
std::string preview_path(const std::string& folder, const std::string& suffix);

void write_manifest(const Manifest& manifest, const std::string& path);

/// Nothing when there is none, or it is not one of ours.
std::optional<Manifest> read_manifest(const std::string& path);

/// Says so when the file of a shard is missing or has another size than its manifest says.
std::optional<std::string> find_wrong_size(const Manifest& manifest, const std::string& folder);

/// What is wrong with a shard that its manifest describes; nothing when it checks out.
std::optional<std::string> find_damage(const Manifest& manifest, const std::string& folder);

}  // namespace apps
