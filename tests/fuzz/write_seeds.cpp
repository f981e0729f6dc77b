// SPDX-License-Identifier: MIT
// Writes the files that fuzzing starts from: one folder per fuzzer.
#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "tests/nlos/containers/example_bytes.h"
#include "tests/nlos/containers/example_mat5.h"
#include "tests/nlos/containers/example_mat73.h"
#include "tests/nlos/formats/mat_writing.h"
#include "tests/nlos/formats/old_hdf5_file.h"
#include "tests/renderer/mesh_file/mesh_texts.h"
#include "tests/renderer/scene_import/foreign_scenes.h"
#include "tests/support/example_capture.h"
#include "tests/support/example_reconstruction.h"
#include "tests/support/file_bytes.h"

#include <filesystem>

namespace {

namespace fs = std::filesystem;

void write_captures(const std::string& folder) {
    int number = 0;
    for (const auto pattern :
         {core::ScanPattern::Confocal, core::ScanPattern::Single, core::ScanPattern::Exhaustive}) {
        core::Capture capture = test_support::example_capture(pattern);
        if (number == 0) capture.variance = capture.transient;
        if (number == 1) {
            capture.unit = core::TransientUnit::Counts;
            core::restrict_observed(capture, {1, 4});
        }
        if (number == 2) {
            capture.orders = {3};
            capture.by_order = {capture.transient};
        }
        for (const std::string suffix : {".h5", ".npz", ".exr"}) {
            nlos::write_capture(folder + "/" + std::to_string(number) + suffix, capture);
        }
        nlos::write_old_hdf5(folder + "/old" + std::to_string(number) + ".h5", capture);
        ++number;
    }
}

void write_mats(const std::string& folder, matio_compression compression) {
    const std::vector<std::uint16_t> data(3 * 3 * 20, 7);
    const std::vector<double> width{0.4};
    const std::string name = compression == MAT_COMPRESSION_NONE ? "/plain.mat" : "/zlib.mat";
    nlos::write_mat(folder + "/capture" + name,
                    {nlos::mat_variable("rect_data", {3, 3, 20}, data),
                     nlos::mat_variable("width", {1, 1}, width)},
                    compression);
    const std::vector<std::uint16_t> signal(3 * 5, 7);
    const std::vector<std::uint8_t> lit{0, 0, 0, 1, 2, 3, 5, 5, 5};
    const std::vector<std::uint8_t> seen{0, 0, 0, 4, 4, 4, 4, 4, 4};
    nlos::write_mat(folder + "/point_list" + name,
                    {nlos::mat_variable("sub_Sig", {3, 5}, signal),
                     nlos::mat_variable("C_i", {3, 3}, lit),
                     nlos::mat_variable("C_d", {3, 3}, seen)},
                    compression);
}

void write_arrays(const std::string& folder) {
    nlos::write_example_mat5(folder + "/mat5/plain.mat", MAT_COMPRESSION_NONE);
    nlos::write_example_mat5(folder + "/mat5/zlib.mat", MAT_COMPRESSION_ZLIB);
    nlos::write_example_mat73(folder + "/mat73/example.mat");
    const std::string values(24, '\1');
    const auto write = [&](const char* name, const std::string& bytes) {
        test_support::write_file_bytes(folder + name, bytes);
    };
    write("/npy/floats.npy", nlos::npy_bytes("'<f4'", "(2, 3)", values));
    write("/npy/fortran.npy", nlos::npy_bytes("'>i2'", "(2, 3, 2)", values, "True"));
    write("/npy/halves.npy", nlos::npy_bytes("'<f2'", "(12,)", values));
    write("/npy/text.npy", nlos::npy_bytes("'<U6'", "()", values));
    nlos::write_example_npz(folder + "/npz/stored.npz", ZIP_CM_STORE);
    nlos::write_example_npz(folder + "/npz/deflated.npz", ZIP_CM_DEFLATE);
    write("/ti/version_4.ti", nlos::example_ti_bytes());
    write("/ti/version_1.ti", nlos::example_old_ti_bytes("TI01", {4, 3, 2}));
    write("/ti/version_0.ti", nlos::example_old_ti_bytes("TI00", {2, 4, 3}));
    write("/json/log.json", nlos::kExampleJson);
    write("/json/lines.log", "{\"h\": [1, 2]}\n{\"h\": [3, 4]}\n");
    write("/csv/table.csv", nlos::kExampleCsv);
    write("/csv/blanks.csv", "1 2.5\n3 -4e5\n");
}

void write_mesh_files(const std::string& folder) {
    const core::TriangleMesh mesh = mesh_file_test::example_mesh();
    for (const bool is_binary : {false, true}) {
        const std::string name = is_binary ? "/binary" : "/text";
        test_support::write_file_bytes(folder + "/ply" + name + ".ply",
                                       mesh_file_test::ply_bytes(mesh, is_binary));
        test_support::write_file_bytes(folder + "/stl" + name + ".stl",
                                       mesh_file_test::stl_bytes(mesh, is_binary));
    }
    // The fuzzer's file is its own material file, so that both readers see it.
    test_support::write_file_bytes(
        folder + "/obj/a.obj",
        "mtllib mesh.obj\no a\ng b\nusemtl c\n" + mesh_file_test::obj_text(mesh) +
            "f -1/1/1 -2 \\\n -3//2 1 # four\nnewmtl c\nKd .5 .5 .5\nPm 1\nPr .2\nd 0.5\n");
}

void write_foreign_scenes(const std::string& folder) {
    test_support::write_file_bytes(folder + "/mitsuba/a.xml", scene_import_test::example_xml());
    test_support::write_file_bytes(folder + "/mitsuba_json/a.json",
                                   scene_import_test::example_json());
    test_support::write_file_bytes(folder + "/ytal/a.yaml", scene_import_test::example_yaml());
}

void write_scenes(const std::string& folder) {
    for (const auto& scene : fs::directory_iterator(NLOS_SOURCE_DIR "/scenes")) {
        const std::string name = "/" + scene.path().filename().string();
        if (!fs::exists(scene.path() / "scene.json")) continue;
        fs::copy_file(scene.path() / "scene.json", folder + "/scene" + name + ".json");
        constexpr std::uintmax_t kLargestSeed = 100'000;
        if (fs::exists(scene.path() / "scene.glb") &&
            fs::file_size(scene.path() / "scene.glb") < kLargestSeed) {
            fs::copy_file(scene.path() / "scene.glb", folder + "/glb" + name + ".glb");
        }
    }
    test_support::write_file_bytes(
        folder + "/gltf/triangle.gltf",
        R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"scene":0,"nodes":[{"mesh":0}],)"
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
        R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",)"
        R"("min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
        R"("buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)"
        R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const std::string folder = argv[1];
    for (const char* name :
         {"capture",  "volume", "point_list", "mat5",    "mat73",        "npy",  "npz",
          "ti",       "json",   "csv",        "ply",     "glb",          "gltf", "scene",
          "response", "obj",    "stl",        "mitsuba", "mitsuba_json", "ytal"}) {
        fs::create_directories(folder + "/" + name);
    }
    write_captures(folder + "/capture");
    write_mats(folder, MAT_COMPRESSION_NONE);
    write_mats(folder, MAT_COMPRESSION_ZLIB);
    write_arrays(folder);
    nlos::write_volume(folder + "/volume/volume.h5", test_support::example_reconstruction());
    write_mesh_files(folder);
    write_foreign_scenes(folder);
    write_scenes(folder);
    test_support::write_file_bytes(folder + "/response/curve.txt",
                                   "# ps weight\n-10 1\n0 6.5\n2e1 3\n");
    return 0;
}
