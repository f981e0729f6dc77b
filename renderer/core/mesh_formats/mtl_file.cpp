// SPDX-License-Identifier: MIT
#include "renderer/core/mesh_formats/mtl_file.h"

#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/mesh_formats/file_words.h"
#include "renderer/core/mesh_formats/wavefront_lines.h"

#include <algorithm>

namespace core {
namespace {

constexpr const char* kAllowed = "must be a complete MTL file";

/// The colour or number that a keyword is followed by. One number stands for all three.
std::array<double, 3> colour_of(const std::string& path, const WavefrontLine& line) {
    std::string_view rest = line.rest;
    std::array<double, 3> colour{};
    for (std::size_t i = 0; i < colour.size(); ++i) {
        const std::string_view word = take_word(rest);
        if (i > 0 && (word.empty() || word.starts_with('#'))) {
            colour.fill(colour[0]);
            break;
        }
        const std::optional<double> number = number_of(word);
        if (!number) {
            throw Error(path,
                        line.where() + " has " + excerpt(word) + " where a number should stand",
                        kAllowed);
        }
        colour[i] = *number;
    }
    return colour;
}

void warn(FileMaterial& material, const char* text) {
    if (std::ranges::find(material.warnings, text) == material.warnings.end()) {
        material.warnings.emplace_back(text);
    }
}

void read_line(const std::string& path, const WavefrontLine& line, FileMaterial& material) {
    const auto number = [&] { return colour_of(path, line)[0]; };
    if (line.keyword == "Kd") {
        material.colour = colour_of(path, line);
    } else if (line.keyword == "Pm") {
        material.metallic = number();
    } else if (line.keyword == "Pr") {
        material.roughness = number();
    } else if (line.keyword == "map_Kd") {
        warn(material, "its texture is not modelled; the colour counts alone");
    } else if (line.keyword == "Ke" && colour_of(path, line) != std::array<double, 3>{}) {
        warn(material, "its emission is not modelled");
    } else if ((line.keyword == "d" && number() < 1.0) ||
               (line.keyword == "Tr" && number() > 0.0)) {
        warn(material, "its transparency is not modelled: it is opaque");
    }
}

}  // namespace

std::size_t NamedMaterials::find_or_add(std::string_view name) {
    const auto [place, is_new] = index.try_emplace(std::string(name), list.size());
    if (is_new) list.emplace_back().name = printable(name);
    return place->second;
}

void read_mtl(const std::string& path, NamedMaterials& materials) {
    const MappedFile file(path, kAllowed);
    file.require_stored();
    WavefrontLines lines(file.bytes());
    std::size_t current = 0;  // lines before the first name belong to none
    while (const auto line = lines.next()) {
        if (line->keyword == "newmtl") {
            current = materials.find_or_add(line->name());
        } else if (current > 0) {
            read_line(path, *line, materials.list[current]);
        }
    }
}

}  // namespace core
