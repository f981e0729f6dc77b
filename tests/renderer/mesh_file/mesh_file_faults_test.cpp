// SPDX-License-Identifier: MIT
// What becomes of files that are odd or damaged: each is read as it was meant, or refused in words
// that name what is wrong.
#include "renderer/core/error.h"
#include "renderer/core/random.h"
#include "renderer/mesh_file/mesh_file.h"
#include "tests/renderer/mesh_file/mesh_texts.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <optional>

namespace {

using namespace mesh_file_test;
using test_support::TemporaryFolder;

double area_of(const renderer::SceneGeometry& geometry) {
    double area = 0.0;
    for (const renderer::Object& object : geometry.objects) {
        const auto& vertices = object.mesh.vertices;
        for (const auto& [a, b, c] : object.mesh.triangles) {
            area +=
                core::triangle_area_vector(vertices.at(a), vertices.at(b), vertices.at(c)).norm();
        }
    }
    return area;
}

/// A file, and either the area of its triangles or a part of the message that refuses it.
struct Case {
    std::string what;
    std::string name;
    std::string bytes;
    std::string refusal;
    double area = 0.0;
};

void check(const std::vector<Case>& cases) {
    for (const Case& expected : cases) {
        SCOPED_TRACE(expected.name + ": " + expected.what);
        const TemporaryFolder folder;
        const std::string path = folder.file(expected.name);
        test_support::write_file_bytes(path, expected.bytes);
        if (!expected.refusal.empty()) {
            EXPECT_ERROR_WITH(renderer::load_mesh_file(path, {}), expected.refusal);
            EXPECT_ERROR_WITH(renderer::load_mesh_file(path, {}), path);
            continue;
        }
        try {
            EXPECT_NEAR(area_of(renderer::load_mesh_file(path, {})), expected.area, 1e-9);
        } catch (const core::Error& error) {
            ADD_FAILURE() << error.what();
        }
    }
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

std::string with_line_ends(const std::string& text, const std::string& end) {
    std::string result;
    for (const char c : text) result += c == '\n' ? end : std::string(1, c);
    return result;
}

const std::string kBom = "\xef\xbb\xbf";

// A rectangle of 2 by 1.
const std::string kObjVertices = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n";
const std::string kObj = kObjVertices + "f 1 2 3\nf 1 3 4\n";

std::vector<Case> obj_cases() {
    const auto reads = [](const char* what, const std::string& text, double area = 2.0) {
        return Case{what, "a.obj", text, "", area};
    };
    const auto refuses = [](const char* what, const std::string& text, const char* refusal) {
        return Case{what, "a.obj", text, refusal};
    };
    const std::string& v = kObjVertices;
    return {
        reads("plain", kObj),
        reads("byte order mark", kBom + kObj),
        reads("line ends of Windows", with_line_ends(kObj, "\r\n")),
        reads("line ends of old Macs", with_line_ends(kObj, "\r")),
        reads("last line without an end", kObj.substr(0, kObj.size() - 1)),
        reads("white space before and behind", with_line_ends(kObj, " \t\n\n  \t")),
        reads("comments", "# a\n" + with_line_ends(kObj, " # v 1 2 3\n#\n")),
        reads("dots and signs", replaced(kObj, "v 2 1 0", "v +2. +1.e0 -.0")),
        reads("fractions without a zero", replaced(kObj, "v 0 0 0", "v .5 0 0"), 1.75),
        reads("exponents", replaced(kObj, "v 2 0 0", "v 2E0 1e-999 0")),
        reads("faces before vertices", "f 1 2 3\nf 1 3 4\n" + v),
        reads("indices that count back", v + "f -4 -3 -2\nf -4 -2 -1\nv 9 9 9\n"),
        reads("corners with texture and normal", v + "vt 0 0\nvn 0 0 1\nf 1/1 2/1/1 3//1 4/\n"),
        reads("continued lines", v + "f 1 2 \\\n3\\\r\n 4\n"),
        reads("a polygon", v + "f 1 2 3 4\n"),
        reads("a polygon with a dent", v + "v .5 .5 0\nf 1 2 3 5 4\n", 1.5),
        reads("weights", replaced(kObj, "v 2 1 0", "v 4 2 0 2")),
        reads("colours", replaced(kObj, "v 2 1 0", "v 2 1 0 0.5 0.5 0.5")),
        reads("colours with opacity", replaced(kObj, "v 2 1 0", "v 2 1 0 0.5 0.5 0.5 1")),
        reads("old faces", v + "fo 1 2 3 4\n"),
        reads("faces of one corner and of two", kObj + "f 1\nf 1 2\nf\n"),
        reads("points, lines and curves", kObj + "p 1\nl 1 2\ncurv 0 1 1 2\n"),
        refuses("not a number", replaced(kObj, "v 2 0 0", "v nan 0 0"), "not finite"),
        refuses("not a number, of nobody", kObj + "v nan 0 0\n", "not finite"),
        refuses("infinite", replaced(kObj, "v 2 0 0", "v 2 -inf 0"), "not finite"),
        refuses("beyond all numbers", replaced(kObj, "v 2 0 0", "v 1e999 0 0"), "not finite"),
        refuses("weight 0", replaced(kObj, "v 2 0 0", "v 2 0 0 0"), "not finite"),
        refuses("a decimal comma", replaced(kObj, "v 2 0 0", "v 2,5 0 0"), "line 2 has '2,5'"),
        refuses("Microsoft's nan", replaced(kObj, "2 0", "1.#QNAN 0"), "line 2 has '1.#QNAN'"),
        refuses("two coordinates", replaced(kObj, "v 2 0 0", "v 2 0"), "a vertex of 2 numbers"),
        refuses("index 0", v + "f 0 1 2\n", "line 5 has the corner '0'"),
        refuses("no such vertex", v + "f 1 2 5\n", "has a face with vertex 4, counted from 0"),
        refuses("none so far back", v + "f -5 1 2\n", "line 5 has the corner '-5'"),
        refuses("an index of 10 digits", v + "f 1 2 4294967297\n", "'4294967297'"),
        refuses("an index of 20 digits", v + "f 1 2 99999999999999999999\n", "'9999999"),
        refuses("a word in a face", v + "f 1 2 x\n", "line 5 has the corner 'x'"),
        refuses("a number alone", kObj + "1 2 3\n", "line 7 has '1'"),
        refuses("bytes", std::string("\0\1\2\n", 4), "line 1 has"),
        refuses("no faces", v, "has no triangles with an area"),
        refuses("nothing", "", "has no triangles with an area"),
    };
}

std::string ply_header(const std::string& format, const std::string& rest) {
    return "ply\nformat " + format + " 1.0\n" + rest + "end_header\n";
}

const std::string kPlyVertex =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kPlyFace = "element face 1\nproperty list uchar int vertex_indices\n";
const std::string kPly =
    ply_header("ascii", kPlyVertex + kPlyFace) + "0 0 0\n2 0 0\n2 1 0\n0 1 0\n4 0 1 2 3\n";

std::vector<Case> ply_cases() {
    const auto reads = [](const char* what, const std::string& text, double area = 2.0) {
        return Case{what, "a.ply", text, "", area};
    };
    const auto refuses = [](const char* what, const std::string& text, const char* refusal) {
        return Case{what, "a.ply", text, refusal};
    };
    const std::string strips = replaced(kPly, "element face", "element tristrips");
    const std::string huge = replaced(kPly, "vertex 4", "vertex 4000000000000000000");
    const std::string other =
        "comment a\nobj_info b\nelement edge 2\nproperty list char short k\n"
        "property double w\n";
    return {
        reads("plain", kPly),
        reads("byte order mark", kBom + kPly),
        reads("line ends of Windows", with_line_ends(kPly, "\r\n")),
        reads("dots and signs", replaced(kPly, "2 0 0", "+2. -.0 0")),
        reads("other names", replaced(replaced(kPly, "int ", "int32 "), "_indices", "_index")),
        reads("other elements",
              replaced(replaced(kPly, kPlyFace, other + kPlyFace), "4 0 1", "0 .5 2 7 8 9 4 0 1")),
        reads("a polygon with a dent",
              replaced(replaced(kPly, "vertex 4", "vertex 5"), "4 0 1 2 3", ".5 .5 0 5 0 1 2 4 3"),
              1.5),
        reads("strips", replaced(strips, "4 0 1 2 3", "9 0 1 3 2 -1 -1 0 1 -1")),
        refuses("a strip of no vertex", replaced(strips, "4 0 1 2 3", "4 0 1 2 9"), "vertex 9"),
        refuses("not a number", replaced(kPly, "2 0 0", "nan 0 0"), "not finite"),
        refuses("infinite", replaced(kPly, "2 0 0", "1e999 0 0"), "not finite"),
        refuses("a word", replaced(kPly, "2 0 0", "2,5 0 0"), "holds '2,5'"),
        refuses("no such vertex", replaced(kPly, "1 2 3", "1 2 4"), "has a face with vertex 4"),
        refuses("a vertex below 0", replaced(kPly, "1 2 3", "1 2 -2"), "has a face with vertex -2"),
        refuses("half a vertex", replaced(kPly, "1 2 3", "1 2 2.5"), "has a face with vertex 2.5"),
        refuses("a list of -1", replaced(kPly, "4 0 1", "-1 0 1"), "has a list of -1 numbers"),
        refuses("cut short", kPly.substr(0, kPly.size() - 3), "is cut short"),
        refuses("more vertices than bytes", huge, "is cut short"),
        refuses("a longer list than bytes", replaced(kPly, "4 0", "4e9 0"), "is cut short"),
        refuses("faces of nothing", replaced(kPly, "_indices", "_colours"), "without vertex_ind"),
        refuses("no header", "v 0 0 0\n", "is no PLY file"),
        refuses("no faces",
                kPly.substr(0, kPly.find("element face")) + "end_header\n0 0 0 1 0 0 1 1 0 0 1 0",
                "has no triangles"),
        refuses("nothing", "", "is no PLY file"),
    };
}

const std::string kFacet =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\n"
    "vertex 2 1 0\nendloop\nendfacet\n";
const std::string kStl = "solid roof\n" + kFacet + "endsolid roof\n";

std::string binary_stl(std::uint32_t declared, std::size_t written, float x = 2.0F) {
    std::string bytes(80, ' ');
    append_bytes(bytes, declared);
    for (std::size_t i = 0; i < written; ++i) {
        const float values[12]{0, 0, 1, 0, 0, 0, x, 0, 0, 2, 1, 0};
        bytes.append(reinterpret_cast<const char*>(values), sizeof(values));
        append_bytes(bytes, std::uint16_t{0});
    }
    return bytes;
}

std::vector<Case> stl_cases() {
    const auto reads = [](const char* what, const std::string& text, double area = 1.0) {
        return Case{what, "a.stl", text, "", area};
    };
    const auto refuses = [](const char* what, const std::string& text, const char* refusal) {
        return Case{what, "a.stl", text, refusal};
    };
    std::string capitals = kStl;
    std::ranges::transform(capitals, capitals.begin(), [](unsigned char c) {
        return static_cast<char>(std::toupper(c));
    });
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    return {
        reads("plain", kStl),
        reads("byte order mark", kBom + kStl),
        reads("line ends of Windows", with_line_ends(kStl, "\r\n")),
        reads("indented", with_line_ends("  " + kStl, "\n\t ")),
        reads("capitals", capitals),
        reads("a normal that is none", replaced(kStl, "0 0 1", "nan nan nan")),
        reads("dots and signs", replaced(kStl, "2 1 0", "+2. 1.e0 -.0")),
        reads("a long name", replaced(kStl, "roof", "roof of a house")),
        reads("two solids", kStl + kStl, 2.0),
        reads("binary", binary_stl(2, 2), 2.0),
        reads("binary that begins as text", "solid" + binary_stl(2, 2).substr(5), 2.0),
        refuses("not a number", replaced(kStl, "2 0 0", "nan 0 0"), "not finite"),
        refuses("infinite", replaced(kStl, "2 0 0", "1e999 0 0"), "not finite"),
        refuses("binary, not a number", binary_stl(1, 1, kNan), "not finite"),
        refuses("a decimal comma", replaced(kStl, "2 0 0", "2,5 0 0"), "holds '2,5'"),
        refuses("four corners", replaced(kStl, "vertex", "vertex 9 9 9 vertex"), "no triangle"),
        refuses("two corners", replaced(kStl, "vertex 2 0 0\n", ""), "no triangle"),
        refuses("a word", replaced(kStl, "outer", "inner"), "holds 'inner'"),
        refuses("cut in a number", kStl.substr(0, kStl.find(" 1 0\nendloop")), "is cut short"),
        refuses("cut before the end", kStl.substr(0, kStl.find("endsolid")), "is cut short"),
        refuses("binary, cut short", binary_stl(3, 2), "is cut short: of 3 triangles"),
        refuses("binary, too long", binary_stl(1, 2), "has a damaged length: of 1 triangles"),
        refuses("binary, many", binary_stl(4'000'000'000U, 2), "is cut short: of 4000000000"),
        refuses("binary, none", binary_stl(0, 0), "has no triangles"),
        refuses("no STL file", "v 0 0 0\n", "is no STL file"),
        refuses("nothing", "", "is no STL file"),
    };
}

TEST(MeshFileFaults, ObjFilesAreReadAsMeantOrRefused) {
    check(obj_cases());
}

TEST(MeshFileFaults, PlyFilesAreReadAsMeantOrRefused) {
    check(ply_cases());
}

TEST(MeshFileFaults, StlFilesAreReadAsMeantOrRefused) {
    check(stl_cases());
}

/// Appends a number as a type of PLY, in the byte order that is not this machine's if asked.
template <class T>
void append_swapped(std::string& bytes, double value, bool is_swapped) {
    std::string number;
    append_bytes(number, static_cast<T>(value));
    if (is_swapped) std::ranges::reverse(number);
    bytes += number;
}

using Append = void (*)(std::string&, double, bool);
const std::vector<std::pair<const char*, Append>> kIntegers{
    {"char", &append_swapped<std::int8_t>},
    {"uint8", &append_swapped<std::uint8_t>},
    {"int16", &append_swapped<std::int16_t>},
    {"ushort", &append_swapped<std::uint16_t>},
    {"int", &append_swapped<std::int32_t>},
    {"uint32", &append_swapped<std::uint32_t>}};

TEST(MeshFileFaults, PlyFilesOfEveryTypeAndByteOrderAreRead) {
    for (const bool is_big : {false, true}) {
        for (const auto& [count_type, append_count] : kIntegers) {
            for (const auto& [index_type, append_index] : kIntegers) {
                for (const bool is_double : {false, true}) {
                    std::string header = kPlyVertex;
                    for (int i = 0; i < 3 && is_double; ++i)
                        header = replaced(header, "float", "double");
                    header +=
                        "property uchar flags\nelement face 1\nproperty short before\nproperty "
                        "list " +
                        std::string(count_type) + " " + index_type +
                        " vertex_indices\nproperty list uchar float texcoord\n";
                    std::string bytes =
                        ply_header(is_big ? "binary_big_endian" : "binary_little_endian", header);
                    for (const auto& vertex : {std::array{0, 0}, {2, 0}, {2, 1}, {0, 1}}) {
                        for (const double c : {vertex[0], vertex[1], 0}) {
                            (is_double ? append_swapped<double>
                                       : append_swapped<float>)(bytes, c, is_big);
                        }
                        bytes += '\7';
                    }
                    append_swapped<std::int16_t>(bytes, 7, is_big);
                    append_count(bytes, 4, is_big);
                    for (int i = 0; i < 4; ++i) append_index(bytes, i, is_big);
                    bytes += '\1';
                    append_swapped<float>(bytes, 0.5, is_big);
                    check({{header, "a.ply", bytes, "", 2.0},
                           {header + "cut",
                            "a.ply",
                            bytes.substr(0, bytes.size() - 1),
                            "is cut short"}});
                }
            }
        }
    }
}

/// Mutants per file; NLOS_FUZZ_CASES in the environment asks for more.
std::uint64_t mutant_count() {
    const char* wanted = std::getenv("NLOS_FUZZ_CASES");
    return wanted == nullptr ? 60 : std::strtoull(wanted, nullptr, 10);
}

/// Changes or removes a few bytes, or writes a piece of the file anew at another place.
std::string mutate(std::string bytes, core::Rng& rng) {
    const auto below = [&](std::size_t limit) {
        return static_cast<std::size_t>(rng.uniform() * static_cast<double>(limit));
    };
    for (std::size_t i = 0; i <= below(4) && !bytes.empty(); ++i) {
        const std::size_t at = below(bytes.size());
        constexpr std::string_view kEdges{"\x00\x7f\x80\xff-9.#\\/ \n", 12};
        switch (below(5)) {
            case 0:
                bytes[at] = static_cast<char>(rng.next_bits());
                break;
            case 1:
                bytes[at] = kEdges[below(kEdges.size())];
                break;
            case 2:
                bytes.erase(at, 1 + below(8));
                break;
            case 3:
                bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(20)));
                break;
            case 4:
                bytes.resize(below(8) == 0 ? at : bytes.size());
                break;
        }
    }
    return bytes;
}

TEST(MeshFileFaults, MutantsAreReadAsSoundMeshesOrRefusedInOneLine) {
    const core::TriangleMesh mesh = example_mesh();
    // Its own material file, so that both are mutated.
    const std::string obj = "mtllib a.obj\no a\nusemtl b\n" + obj_text(mesh) +
                            "f -1/1/1 -2 \\\n -3//2 1 # four\nnewmtl b\nKd .5 .5 .5\nPm 1\nd 0.5\n";
    const std::vector<std::pair<std::string, std::string>> files{
        {"a.obj", obj},
        {"a.ply", ply_bytes(mesh, false)},
        {"a.ply", ply_bytes(mesh, true)},
        {"a.ply", replaced(ply_bytes(mesh, false), "element face", "element tristrips")},
        {"a.stl", stl_bytes(mesh, false)},
        {"a.stl", stl_bytes(mesh, true)}};
    const TemporaryFolder folder;
    for (const auto& [name, bytes] : files) {
        const std::string path = folder.file(name);
        std::uint64_t accepted = 0;
        for (std::uint64_t trial = 0; trial < mutant_count(); ++trial) {
            core::Rng rng(7, trial, bytes.size());
            test_support::write_file_bytes(path, mutate(bytes, rng));
            try {
                const renderer::SceneGeometry geometry = renderer::load_mesh_file(path, {});
                EXPECT_GT(area_of(geometry), 0.0) << trial;
                for (const renderer::Object& object : geometry.objects) {
                    for (const core::Vec3& vertex : object.mesh.vertices) {
                        EXPECT_TRUE(vertex.allFinite()) << trial;
                    }
                }
                ++accepted;
            } catch (const core::Error& error) {
                EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
                EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
            }
        }
        EXPECT_GT(accepted, 0U) << name;  // the mutants reach beyond the first check
    }
}

}  // namespace
