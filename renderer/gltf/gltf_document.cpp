// SPDX-License-Identifier: MIT
#include "renderer/gltf/gltf_document.h"

#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/gltf/gltf_features.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string_view>

namespace renderer {
namespace {

constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;
constexpr const char* kAllowed = "must be a whole glTF 2.0 file (.gltf or .glb)";

bool is_binary_gltf(std::string_view bytes) {
    return bytes.starts_with("glTF");
}

std::uint32_t little_endian_word(std::string_view bytes, std::size_t offset) {
    std::uint32_t word = 0;
    for (std::size_t i = 4; i-- > 0;) {
        word = (word << 8) | static_cast<unsigned char>(bytes[offset + i]);
    }
    return word;
}

/// The JSON chunk of a .glb. Checks every chunk's extent itself: tinygltf 2.7 forgets a chunk's
/// header when it compares the length, and reads up to eight bytes past a truncated file.
std::string_view find_json_chunk(std::string_view bytes, const std::string& path) {
    const auto cut_short = [&](std::size_t needed) {
        return core::Error(path,
                           "is cut short (" + std::to_string(bytes.size()) + " of " +
                               std::to_string(needed) + " bytes)",
                           kAllowed);
    };
    if (bytes.size() < kHeaderBytes) throw cut_short(kHeaderBytes);
    if (const std::uint32_t version = little_endian_word(bytes, 4); version != 2) {
        throw core::Error(path, "is binary glTF version " + std::to_string(version), kAllowed);
    }
    const std::size_t length = little_endian_word(bytes, 8);
    if (length > bytes.size()) throw cut_short(length);

    std::string_view json;
    for (std::size_t at = kHeaderBytes, chunk = 0; at < length; ++chunk) {
        if (length - at < kChunkHeaderBytes ||
            little_endian_word(bytes, at) > length - at - kChunkHeaderBytes) {
            throw core::Error(path,
                              "chunk " + std::to_string(chunk) + " runs past the end of the file",
                              kAllowed);
        }
        const std::size_t chunk_bytes = little_endian_word(bytes, at);
        if (chunk == 0 && bytes.substr(at + 4, 4) == "JSON") {
            json = bytes.substr(at + kChunkHeaderBytes, chunk_bytes);
        }
        at += kChunkHeaderBytes + chunk_bytes;
    }
    if (json.empty()) throw core::Error(path, "has no JSON chunk", kAllowed);
    return json;
}

/// Keeps an image as the bytes it came in; only textures that are used get decoded.
bool keep_image_bytes(tinygltf::Image* image,
                      const int /*index*/,
                      std::string* /*error*/,
                      std::string* /*warning*/,
                      int /*width*/,
                      int /*height*/,
                      const unsigned char* bytes,
                      int num_bytes,
                      void* /*user_data*/) {
    image->image.assign(bytes, bytes + num_bytes);
    image->as_is = true;
    return true;
}

/// The first line of a message of tinygltf, shortened: it may quote whole data URIs.
std::string first_line(const std::string& message) {
    constexpr std::size_t kLongest = 160;
    std::string line = message.substr(0, message.find('\n'));
    if (line.size() > kLongest) line = line.substr(0, kLongest) + "...";
    std::replace_if(
        line.begin(), line.end(), [](unsigned char c) { return c < ' '; }, ' ');
    return line;
}

/// The size of the largest external file that makes sense [bytes]: an image, or a buffer of `json`.
std::uint64_t largest_external_file(const core::Json& json) {
    std::uint64_t largest = 256'000'000;
    const auto buffers = json.find("buffers");
    if (buffers == json.end()) return largest;
    for (const core::Json& buffer : *buffers) {
        largest = std::max(largest, buffer["byteLength"].get<std::uint64_t>());
    }
    return largest;
}

/// Reads a buffer or image for tinygltf, which would wait for pipes and read devices and files of
/// any size. Throws Error for what cannot be one.
bool read_external_file(std::vector<unsigned char>* bytes,
                        std::string* /*error*/,
                        const std::string& path,
                        void* largest) {
    const core::MappedFile file(path, "must be a buffer or an image of a glTF file");
    if (const auto most = *static_cast<const std::uint64_t*>(largest); file.bytes().size() > most) {
        throw core::Error(path,
                          "has " + std::to_string(file.bytes().size()) + " bytes",
                          "must have at most " + std::to_string(most));
    }
    file.require_stored();
    bytes->assign(file.bytes().begin(), file.bytes().end());
    return true;
}

bool external_file_exists(const std::string& path, void* /*user_data*/) {
    std::error_code ignored;
    return std::filesystem::exists(path, ignored);
}

template <class Callbacks>
Callbacks file_callbacks(std::uint64_t& largest) {
    Callbacks callbacks{};
    callbacks.FileExists = &external_file_exists;
    callbacks.ExpandFilePath = &tinygltf::ExpandFilePath;
    callbacks.ReadWholeFile = &read_external_file;
    callbacks.WriteWholeFile = &tinygltf::WriteWholeFile;
    // tinygltf 2.9 wants a function more than 2.7. It leaves all checks to read_external_file(),
    // whose messages say what is wrong.
    if constexpr (requires { callbacks.GetFileSizeInBytes; }) {
        callbacks.GetFileSizeInBytes =
            [](std::size_t* num_bytes, std::string*, const std::string&, void*) {
                *num_bytes = 0;
                return true;
            };
    }
    callbacks.user_data = &largest;
    return callbacks;
}

void append_word(std::string& bytes, std::size_t word) {
    for (int i = 0; i < 4; ++i) bytes += static_cast<char>(word >> (8 * i) & 0xff);
}

/// A file without its skins: tinygltf 2.7 refuses those without inverse bind matrices, which are
/// optional, and poses are read from the JSON.
std::string without_skins(std::string_view bytes, core::Json json) {
    json.erase("skins");
    std::string text = json.dump();
    if (!is_binary_gltf(bytes)) return text;
    text.append((4 - text.size() % 4) % 4, ' ');
    const std::size_t rest =
        kHeaderBytes + kChunkHeaderBytes + little_endian_word(bytes, kHeaderBytes);
    std::string file(bytes.substr(0, 8));
    append_word(file, kHeaderBytes + kChunkHeaderBytes + text.size() + (bytes.size() - rest));
    append_word(file, text.size());
    file += "JSON" + text;
    file += bytes.substr(rest);
    return file;
}

std::shared_ptr<const tinygltf::Model> load_model(std::string_view bytes,
                                                  const core::Json& json,
                                                  const std::string& path) {
    auto model = std::make_shared<tinygltf::Model>();
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(&keep_image_bytes, nullptr);
    std::uint64_t largest = largest_external_file(json);
    loader.SetFsCallbacks(file_callbacks<tinygltf::FsCallbacks>(largest));
    const std::string folder = std::filesystem::path(path).parent_path().string();
    const auto num_bytes = static_cast<unsigned int>(bytes.size());
    std::string error;
    std::string warning;
    bool loaded = false;
    try {
        loaded =
            is_binary_gltf(bytes)
                ? loader.LoadBinaryFromMemory(model.get(),
                                              &error,
                                              &warning,
                                              reinterpret_cast<const unsigned char*>(bytes.data()),
                                              num_bytes,
                                              folder)
                : loader.LoadASCIIFromString(
                      model.get(), &error, &warning, bytes.data(), num_bytes, folder);
    } catch (const core::Error&) {
        throw;
    } catch (const std::exception& exception) {
        error = exception.what();
    }
    if (!loaded || !error.empty()) {
        throw core::Error(path, "cannot be read (" + first_line(error) + ")", kAllowed);
    }
    return model;
}

}  // namespace

GltfDocument read_gltf_document(const std::string& path) {
    const core::MappedFile file(path, "must be a readable glTF file (.gltf or .glb)");
    const std::string_view bytes = file.bytes();
    if (bytes.size() > std::numeric_limits<std::uint32_t>::max()) {
        throw core::Error(path,
                          "has " + std::to_string(bytes.size()) + " bytes",
                          "a glTF file must be smaller than 4 GiB");
    }
    GltfDocument document;
    document.path = path;
    document.json =
        core::parse_json(is_binary_gltf(bytes) ? find_json_chunk(bytes, path) : bytes, path);
    check_gltf_json(document.json, path);
    note_features(GltfPart::File, document.json, document.json, "", path, document.warnings);
    document.model = document.json.contains("skins")
                         ? load_model(without_skins(bytes, document.json), document.json, path)
                         : load_model(bytes, document.json, path);
    return document;
}

}  // namespace renderer
