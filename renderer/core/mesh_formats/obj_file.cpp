// SPDX-License-Identifier: MIT
#include "renderer/core/error.h"
#include "renderer/core/mesh_formats/file_words.h"
#include "renderer/core/mesh_formats/mesh_formats.h"
#include "renderer/core/mesh_formats/mtl_file.h"
#include "renderer/core/mesh_formats/polygons.h"
#include "renderer/core/mesh_formats/wavefront_lines.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <set>
#include <utility>

namespace core {
namespace {

namespace fs = std::filesystem;

/// Lines that say nothing of where surfaces are, or how bright.
constexpr std::array kSilentKeywords{"vt",
                                     "vn",
                                     "vp",
                                     "s",
                                     "l",
                                     "p",
                                     "mg",
                                     "lod",
                                     "bevel",
                                     "end",
                                     "c_interp",
                                     "d_interp",
                                     "shadow_obj",
                                     "trace_obj"};

/// Reads a Wavefront OBJ file line by line. Faces may stand before their vertices: which those are
/// is told by the whole file, but for numbers below 0, which count back from the face.
class ObjReader {
 public:
    explicit ObjReader(const std::string& path) : path_(path) {}

    FileMesh read(std::string_view text) {
        WavefrontLines lines(text);
        while (const auto line = lines.next()) read_line(*line);
        return finish();
    }

 private:
    void read_line(const WavefrontLine& line) {
        if (line.keyword == "v") {
            read_vertex(line);
        } else if (line.keyword == "f" || line.keyword == "fo") {
            read_face(line);
        } else if (line.keyword == "o") {
            std::string_view rest = line.rest;
            name_ = take_word(rest);
        } else if (line.keyword == "g") {
            if (line.name() != group_) name_ = group_ = line.name();
        } else if (line.keyword == "usemtl") {
            if (!line.name().empty()) material_ = materials_.find_or_add(line.name());
        } else if (line.keyword == "mtllib") {
            read_materials(line);
        } else if (std::ranges::find(kSilentKeywords, line.keyword) == kSilentKeywords.end()) {
            note_unread(line);
        }
    }

    /// x y z, and behind them a weight, a colour, or a colour with its opacity.
    void read_vertex(const WavefrontLine& line) {
        std::array<double, 7> numbers{};
        std::size_t count = 0;
        std::string_view rest = line.rest;
        for (auto word = take_word(rest); !is_end(word); word = take_word(rest)) {
            const std::optional<double> number = number_of(word);
            if (!number) refuse(line, excerpt(word) + ", which is no number");
            if (count == numbers.size()) refuse(line, "a vertex of more than 7 numbers");
            numbers[count++] = *number;
        }
        if (count < 3 || count == 5) {
            refuse(line, fmt::format("a vertex of {} numbers", count));
        }
        has_colours_ = has_colours_ || count > 4;
        const double weight = count == 4 ? numbers[3] : 1.0;
        vertices().push_back(Vec3(numbers[0], numbers[1], numbers[2]) / weight);
    }

    /// Of each corner the vertex, before the first / .
    void read_face(const WavefrontLine& line) {
        std::string_view rest = line.rest;
        for (auto word = take_word(rest); !is_end(word); word = take_word(rest)) {
            std::int64_t number = 0;
            const auto [end, error] =
                std::from_chars(word.data(), word.data() + word.size(), number);
            if (error != std::errc() || (end != word.data() + word.size() && *end != '/')) {
                refuse(line, "the corner " + excerpt(word));
            }
            if (number < 0) number += static_cast<std::int64_t>(vertices().size()) + 1;
            if (number < 1 || number > 0xffffffff) {
                refuse(line, "the corner " + excerpt(word) + ", which is no vertex");
            }
            polygons_.corners.push_back(static_cast<std::uint32_t>(number - 1));
        }
        polygons_.ends.push_back(polygons_.corners.size());
        std::vector<FilePart>& parts = file_.parts;
        if (parts.empty() || parts.back().name != name_ || parts.back().material != material_) {
            parts.push_back({name_, material_, 0});
        }
        parts.back().end = polygons_.ends.size();
    }

    /// The name may hold spaces, or be several.
    void read_materials(const WavefrontLine& line) {
        if (!read_library(line.name())) {
            std::string_view names = line.name();
            for (auto name = take_word(names); !name.empty(); name = take_word(names)) {
                if (!read_library(name) && missing_library_.empty()) {
                    missing_library_ = printable(fs::path(name).filename().string()).substr(0, 120);
                }
            }
        }
    }

    /// Only regular files in the same folder exist for a mesh file: no pipes, devices or files
    /// elsewhere, which it could name too.
    bool read_library(std::string_view name) {
        const auto folder = [](const fs::path& file) {
            return fs::absolute(file).lexically_normal().parent_path();
        };
        const fs::path library = fs::path(path_).parent_path() / fs::path(name);
        std::error_code ignored;
        if (folder(library) != folder(path_) || !fs::is_regular_file(library, ignored))
            return false;
        if (libraries_.insert(library.string()).second) read_mtl(library.string(), materials_);
        return true;
    }

    void note_unread(const WavefrontLine& line) {
        const auto is_part_of_words = [](unsigned char c) { return std::isalnum(c) || c == '_'; };
        if (!std::isalpha(static_cast<unsigned char>(line.keyword.front())) ||
            !std::ranges::all_of(line.keyword, is_part_of_words)) {
            refuse(line, excerpt(line.keyword) + " where a keyword should stand");
        }
        if (unread_keyword_.empty()) unread_keyword_ = line.keyword;
    }

    FileMesh finish() {
        std::size_t begin = 0;
        for (FilePart& part : file_.parts) {
            add_triangles(path_, polygons_, begin, part.end, file_.mesh);
            begin = std::exchange(part.end, file_.mesh.triangles.size());
        }
        file_.materials = std::move(materials_.list);
        if (!missing_library_.empty()) {
            file_.warnings.push_back(missing_library_ +
                                     " is not beside it: materials that it would define are white");
        }
        if (!unread_keyword_.empty()) {
            file_.warnings.push_back("its lines of " + excerpt(unread_keyword_) +
                                     " are not modelled");
        }
        if (has_colours_) file_.warnings.emplace_back(kColoursNotModelled);
        return std::move(file_);
    }

    static bool is_end(std::string_view word) { return word.empty() || word.starts_with('#'); }

    [[noreturn]] void refuse(const WavefrontLine& line, const std::string& found) const {
        throw_damaged(path_, line.where() + " has " + found);
    }

    std::vector<Vec3>& vertices() { return file_.mesh.vertices; }

    std::string path_;
    FileMesh file_;
    Polygons polygons_;
    NamedMaterials materials_;
    std::size_t material_ = 0;
    std::string name_;   ///< of the object or group that faces belong to
    std::string group_;  ///< the last one
    std::set<std::string> libraries_;
    std::string missing_library_;
    std::string unread_keyword_;
    bool has_colours_ = false;
};

FileMesh parse_obj(const std::string& path, std::string_view text) {
    return ObjReader(path).read(text);
}

}  // namespace

const MeshFormat kObj{"OBJ", ".obj", &parse_obj};

}  // namespace core
