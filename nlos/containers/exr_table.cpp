// SPDX-License-Identifier: MIT
#include "nlos/containers/exr_table.h"

#include "nlos/containers/file_memory.h"
#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/output_file.h"
#include "renderer/core/system/sandboxed_process.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatVectorAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTestFile.h>
#include <fmt/core.h>
#include <zlib.h>

#include <cstdint>
#include <filesystem>

namespace nlos {
namespace {

constexpr std::size_t kColumnBytes = sizeof(float);
constexpr std::uint64_t kMaxChannels = 1 << 16;
constexpr const char* kChecksum = "nlosCrc32";

core::Error damaged_table(const std::string& path) {
    return {path, "is damaged or cut short", "must be a complete OpenEXR file"};
}

/// Throws unless the file is a single image of scan lines, no larger than its bytes can hold.
void check_kind_and_size(const std::string& path) {
    bool tiled = false;
    bool deep = false;
    bool multi_part = false;
    if (!Imf::isOpenExrFile(path.c_str(), tiled, deep, multi_part)) throw damaged_table(path);
    if (tiled || deep || multi_part) {
        throw core::Error(path,
                          fmt::format("is {}",
                                      tiled  ? "tiled"
                                      : deep ? "deep"
                                             : "of several parts"),
                          "must be a single image of scan lines");
    }
    // The library allocates by what the header claims, within these bounds.
    const std::uint64_t most_pixels = std::filesystem::file_size(path) * kLargestDeflateRatio;
    const int most = static_cast<int>(std::min<std::uint64_t>(most_pixels, INT32_MAX));
    Imf::Header::setMaxImageSize(most, most);
    const Imath::Box2i window = Imf::InputFile(path.c_str(), 0).header().dataWindow();
    const std::uint64_t width = static_cast<std::uint64_t>(window.max.x - window.min.x) + 1;
    const std::uint64_t height = static_cast<std::uint64_t>(window.max.y - window.min.y) + 1;
    if (width > most_pixels / height) throw damaged_table(path);
}

/// CRC-32 of the channels and of our attributes, which the format does not guard.
double checksum_of(const ExrTable& table) {
    uLong crc = 0;
    const auto add = [&](const std::string& name, const void* values, std::size_t bytes) {
        crc = ::crc32_z(crc, reinterpret_cast<const Bytef*>(name.data()), name.size());
        crc = ::crc32_z(crc, static_cast<const Bytef*>(values), bytes);
    };
    const auto is_ours = [](const std::string& name) {
        return name.starts_with("nlos") && name != kChecksum;
    };
    for (const auto& [name, values] : table.channels) {
        add(name, values.data(), values.size() * sizeof(float));
    }
    for (const auto& [name, value] : table.numbers) {
        if (is_ours(name)) add(name, &value, sizeof(value));
    }
    for (const auto& [name, text] : table.texts) {
        if (is_ours(name)) add(name, text.data(), text.size());
    }
    for (const auto& [name, values] : table.lists) {
        if (is_ours(name)) add(name, values.data(), values.size() * sizeof(float));
    }
    return static_cast<double>(crc);
}

core::Json to_json(const ExrTable& table) {
    core::Json json;
    json["size"] = {table.width, table.height};
    json["numbers"] = table.numbers;
    json["texts"] = table.texts;
    const auto add = [&](const char* key, const auto& lists) {
        json[key] = core::Json::object();
        for (const auto& [name, values] : lists) json[key][name] = core::to_binary(values);
    };
    add("lists", table.lists);
    add("channels", table.channels);
    return json;
}

ExrTable from_json(const core::Json& json) {
    ExrTable table;
    table.width = json.at("size").at(0);
    table.height = json.at("size").at(1);
    json.at("numbers").get_to(table.numbers);
    json.at("texts").get_to(table.texts);
    const auto take = [&](const char* key, auto& lists) {
        for (const auto& [name, value] : json.at(key).items()) {
            core::from_binary(value, lists[name]);
        }
    };
    take("lists", table.lists);
    take("channels", table.channels);
    return table;
}

/// Floats at consecutive columns and rows of a table.
Imf::Slice slice_of(float* values, const ExrTable& table, int first_x, int first_y) {
    // The library adds the pixel's coordinates to the base.
    const auto stride = static_cast<std::ptrdiff_t>(table.width * kColumnBytes);
    char* base = reinterpret_cast<char*>(values) -
                 static_cast<std::ptrdiff_t>(kColumnBytes) * first_x - stride * first_y;
    return {Imf::FLOAT, base, kColumnBytes, static_cast<std::size_t>(stride)};
}

ExrTable read_with_library(const std::string& path) {
    check_kind_and_size(path);
    Imf::InputFile file(path.c_str());
    const Imf::Header& header = file.header();
    const Imath::Box2i window = header.dataWindow();
    ExrTable table;
    table.width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
    table.height = static_cast<std::size_t>(window.max.y - window.min.y + 1);
    std::uint64_t channels = 0;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        if (c.channel().xSampling != 1 || c.channel().ySampling != 1 || ++channels > kMaxChannels) {
            throw core::Error(path, "has subsampled or too many channels", "must have full ones");
        }
    }
    require_memory(4 * channels * table.width * table.height * kColumnBytes, path);
    Imf::FrameBuffer buffer;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        std::vector<float>& values = table.channels[c.name()];
        values.resize(table.width * table.height);
        buffer.insert(c.name(), slice_of(values.data(), table, window.min.x, window.min.y));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    for (auto a = header.begin(); a != header.end(); ++a) {
        const Imf::Attribute& attribute = a.attribute();
        if (const auto* number = dynamic_cast<const Imf::DoubleAttribute*>(&attribute)) {
            table.numbers[a.name()] = number->value();
        } else if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute)) {
            table.texts[a.name()] = text->value();
        } else if (const auto* list = dynamic_cast<const Imf::FloatVectorAttribute*>(&attribute)) {
            table.lists[a.name()] = list->value();
        }
    }
    const auto stated = table.numbers.find(kChecksum);
    if (stated != table.numbers.end() && stated->second != checksum_of(table)) {
        throw damaged_table(path);
    }
    return table;
}

}  // namespace

bool is_exr_file(const std::string& path) {
    return core::first_bytes(path, 4) == "\x76\x2f\x31\x01";
}

ExrTable read_exr_table(const std::string& path) {
    return from_json(core::run_sandboxed(
        path,
        [&] { return to_json(read_with_library(path)); },
        [&](const std::string&) { return damaged_table(path); }));
}

void write_exr_table(const std::string& path, const ExrTable& table) {
    core::OutputFile output(path);
    Imf::Header header(static_cast<int>(table.width), static_cast<int>(table.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto& [name, value] : table.numbers) {
        header.insert(name, Imf::DoubleAttribute(value));
    }
    header.insert(kChecksum, Imf::DoubleAttribute(checksum_of(table)));
    for (const auto& [name, value] : table.texts) {
        header.insert(name, Imf::StringAttribute(value));
    }
    for (const auto& [name, values] : table.lists) {
        header.insert(name, Imf::FloatVectorAttribute(values));
    }
    Imf::FrameBuffer buffer;
    for (const auto& [name, values] : table.channels) {
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        buffer.insert(name, slice_of(const_cast<float*>(values.data()), table, 0, 0));
    }
    try {
        Imf::OutputFile file(output.temporary().c_str(), header);
        file.setFrameBuffer(buffer);
        file.writePixels(static_cast<int>(table.height));
    } catch (const std::exception&) {
        throw core::Failure(path, "cannot be written (disk full?)");
    }
    output.commit();
}

}  // namespace nlos
