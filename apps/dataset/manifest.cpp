// SPDX-License-Identifier: MIT
#include "apps/dataset/manifest.h"

#include "apps/batch/checksum.h"
#include "renderer/core/output_file.h"

#include <fmt/core.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace apps {
namespace {

namespace fs = std::filesystem;

core::Json write_profile(const ItemProfile& profile) {
    core::Json json;
    for (const auto& [step, name] : core::EnumNames<ItemStep>::value) {
        json[std::string(name)] = profile[static_cast<std::size_t>(step)];
    }
    return json;
}

ItemProfile read_profile(const core::Json& json) {
    ItemProfile profile{};
    for (const auto& [step, name] : core::EnumNames<ItemStep>::value) {
        profile[static_cast<std::size_t>(step)] = json.at(std::string(name)).get<double>();
    }
    return profile;
}

Manifest parse_manifest(const core::Json& json) {
    Manifest manifest;
    json.at("fingerprint").get_to(manifest.fingerprint);
    json.at("program").get_to(manifest.program);
    json.at("file").get_to(manifest.file);
    json.at("items").at(0).get_to(manifest.items.begin);
    json.at("items").at(1).get_to(manifest.items.end);
    json.at("bytes").get_to(manifest.bytes);
    json.at("xxh128").get_to(manifest.checksum);
    json.at("seconds").get_to(manifest.seconds);
    manifest.profile = read_profile(json.at("cpu_seconds"));
    json.at("broken_meshes").get_to(manifest.broken_meshes);
    json.at("dark_items").get_to(manifest.dark_items);
    json.at("clipped_counts").get_to(manifest.clipped_counts);
    json.at("drawn").get_to(manifest.drawn);
    return manifest;
}

}  // namespace

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
    const core::Json json = {{"fingerprint", manifest.fingerprint},
                             {"program", manifest.program},
                             {"file", manifest.file},
                             {"items", {manifest.items.begin, manifest.items.end}},
                             {"bytes", manifest.bytes},
                             {"xxh128", manifest.checksum},
                             {"seconds", manifest.seconds},
                             {"cpu_seconds", write_profile(manifest.profile)},
                             {"broken_meshes", manifest.broken_meshes},
                             {"dark_items", manifest.dark_items},
                             {"clipped_counts", manifest.clipped_counts},
                             {"drawn", manifest.drawn}};
    core::write_text_file(path, json.dump(1) + "\n");
}

std::optional<Manifest> read_manifest(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    const auto json = file ? core::json_if_valid(text.str()) : std::nullopt;
    if (!json) return std::nullopt;
    try {
        return parse_manifest(*json);
    } catch (const core::Json::exception&) {
        return std::nullopt;
    }
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
