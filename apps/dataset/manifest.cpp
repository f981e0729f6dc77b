// SPDX-License-Identifier: MIT
#include "apps/dataset/manifest.h"

#include "renderer/core/output_file.h"

#include <fmt/core.h>
#include <xxhash.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

namespace apps {
namespace {

namespace fs = std::filesystem;

std::string hexadecimal(const XXH128_hash_t& hash) {
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

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

std::string preview_path(const std::string& folder) {
    return (fs::path(folder) / "preview.png").string();
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

std::optional<std::string> file_checksum(const std::string& path) {
    constexpr std::size_t kBytesAtOnce = std::size_t{1} << 20;
    std::ifstream file(path, std::ios::binary);
    if (!file) return std::nullopt;
    const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                                XXH3_freeState);
    XXH3_128bits_reset(state.get());
    std::string bytes(kBytesAtOnce, '\0');
    while (file.read(bytes.data(), kBytesAtOnce) || file.gcount() > 0) {
        XXH3_128bits_update(state.get(), bytes.data(), static_cast<std::size_t>(file.gcount()));
    }
    if (file.bad()) return std::nullopt;
    return hexadecimal(XXH3_128bits_digest(state.get()));
}

std::string text_checksum(const std::string& text) {
    return hexadecimal(XXH3_128bits(text.data(), text.size()));
}

std::optional<std::string> find_damage(const Manifest& manifest, const std::string& folder) {
    const fs::path path = fs::path(folder) / manifest.file;
    std::error_code error;
    const std::uint64_t bytes = fs::file_size(path, error);
    if (error) return manifest.file + " is missing";
    if (bytes != manifest.bytes) {
        return fmt::format("{} has {} bytes instead of {}", manifest.file, bytes, manifest.bytes);
    }
    const auto checksum = file_checksum(path.string());
    if (!checksum) return manifest.file + " cannot be read";
    if (*checksum != manifest.checksum) return manifest.file + " is damaged: its checksum differs";
    return std::nullopt;
}

}  // namespace apps
