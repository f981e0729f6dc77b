// SPDX-License-Identifier: MIT
#include "renderer/core/mesh_formats/mtl_file.h"

#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/mesh_formats/file_words.h"
#include "renderer/core/mesh_formats/wavefront_lines.h"

#include <algorithm>
#include <array>

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

constexpr const char* kEmission = "its emission is not modelled";
constexpr const char* kRelief = "its bumps are not modelled";
constexpr const char* kTransparency = "its transparency is not modelled: it is opaque";
constexpr const char* kHighlight = "its highlight (Ks) is not modelled: it is diffuse";
constexpr const char* kTexture = "its texture is not modelled; the colour counts alone";
constexpr const char* kCoat = "its coat or sheen is not modelled";
constexpr const char* kPart = "its textures of roughness and metal are not modelled";

/// What changes how much light returns and is not modelled: the line's keyword, its words, and
/// whether a number of the line has to be above 0.
struct LeftOut {
    std::string_view keyword;
    const char* says;
    bool is_number;
};
constexpr std::array kLeftOut{LeftOut{"Ke", kEmission, true},
                              LeftOut{"Ks", kHighlight, true},
                              LeftOut{"Tr", kTransparency, true},
                              LeftOut{"Pc", kCoat, true},
                              LeftOut{"Ps", kCoat, true},
                              LeftOut{"map_Kd", kTexture, false},
                              LeftOut{"map_Ke", kEmission, false},
                              LeftOut{"map_Ks", kHighlight, false},
                              LeftOut{"map_d", kTransparency, false},
                              LeftOut{"map_Pm", kPart, false},
                              LeftOut{"map_Pr", kPart, false},
                              LeftOut{"map_Bump", kRelief, false},
                              LeftOut{"map_bump", kRelief, false},
                              LeftOut{"bump", kRelief, false},
                              LeftOut{"disp", kRelief, false},
                              LeftOut{"norm", kRelief, false}};

void read_line(const std::string& path, const WavefrontLine& line, FileMaterial& material) {
    const auto number = [&] { return colour_of(path, line)[0]; };
    if (line.keyword == "Kd") {
        material.colour = colour_of(path, line);
    } else if (line.keyword == "Pm") {
        material.metallic = number();
    } else if (line.keyword == "Pr") {
        material.roughness = number();
    } else if (line.keyword == "d" && number() < 1.0) {
        warn(material, kTransparency);
    }
    const auto* const row = std::ranges::find(kLeftOut, line.keyword, &LeftOut::keyword);
    if (row == kLeftOut.end()) return;
    if (!row->is_number || std::ranges::max(colour_of(path, line)) > 0.0) {
        warn(material, row->says);
    }
}

}  // namespace

std::size_t NamedMaterials::find_or_add(std::string_view name) {
    const auto [entry, is_new] = index.try_emplace(std::string(name), list.size());
    if (is_new) list.emplace_back().name = printable(name);
    return entry->second;
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
