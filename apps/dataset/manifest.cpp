// SPDX-License-Identifier: MIT
#include "apps/dataset/manifest.h"

#include "apps/batch/checksum.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/output_file.h"

#include <fmt/core.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace apps {
namespace {

namespace fs = std::filesystem;

/// Reads every field, which throws where one lacks that need not or is of another type.
template <core::SettingsStruct Fields>
void read_whole(const core::Json& json, Fields& fields) {
    for_each_field(fields, [&]<class Field>(const char* name, Field& field, const char*) {
        if constexpr (core::SettingsStruct<Field>) {
            read_whole(json.at(name), field);
        } else if constexpr (std::is_same_v<Field, std::optional<ItemRange>>) {
            if (json.contains(name) && !json.at(name).is_null())
                field = json.at(name).get<ItemRange>();
        } else {
            json.at(name).get_to(field);
        }
    });
}

}  // namespace

void ItemTotals::add(const ItemTotals& other) {
    profile.add(other.profile);
    broken_meshes.insert(other.broken_meshes.begin(), other.broken_meshes.end());
    dark_items += other.dark_items;
    clipped_counts += other.clipped_counts;
}

std::string shard_name(std::uint64_t shard) {
    return fmt::format("shard-{:05}", shard);
}

std::string manifest_path(const std::string& folder, std::uint64_t shard) {
    return (fs::path(folder) / (shard_name(shard) + ".json")).string();
}

std::string preview_path(const std::string& folder, const std::string& suffix) {
    return (fs::path(folder) / ("preview" + suffix)).string();
}

void write_manifest(const Manifest& manifest, const std::string& path) {
    core::write_text_file(path, core::write_value(manifest).dump(1) + "\n");
}

std::optional<Manifest> read_manifest(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    const auto json = file ? core::json_if_valid(text.str()) : std::nullopt;
    if (!json) return std::nullopt;
    Manifest manifest;
    try {
        read_whole(*json, manifest);
    } catch (const core::Json::exception&) {
        return std::nullopt;
    }
    return manifest;
}

std::optional<std::string> find_wrong_size(const Manifest& manifest, const std::string& folder) {
    const fs::path path = fs::path(folder) / manifest.file;
    std::error_code error;
    const std::uint64_t bytes = fs::file_size(path, error);
    if (error) return manifest.file + " is missing";
    if (bytes != manifest.bytes) {
        return fmt::format("{} has {} bytes instead of {}", manifest.file, bytes, manifest.bytes);
    }
    return std::nullopt;
}

std::optional<std::string> find_damage(const Manifest& manifest, const std::string& folder) {
    if (auto wrong = find_wrong_size(manifest, folder)) return wrong;
    const auto checksum = file_checksum((fs::path(folder) / manifest.file).string());
    if (!checksum) return manifest.file + " cannot be read";
    if (*checksum != manifest.checksum) return manifest.file + " is damaged: its checksum differs";
    return std::nullopt;
}

}  // namespace apps
