// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/error.h"
#include "renderer/core/random.h"
#include "tests/nlos/containers/example_bytes.h"
#include "tests/nlos/containers/example_mat5.h"
#include "tests/nlos/containers/example_mat73.h"
#include "tests/nlos/containers/read_everything.h"
#include "tests/nlos/formats/mat_writing.h"
#include "tests/nlos/formats/old_hdf5_file.h"
#include "tests/support/example_capture.h"
#include "tests/support/example_reconstruction.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>

namespace nlos {
namespace {

using test_support::TemporaryFolder;

/// Cases per format; NLOS_FUZZ_CASES in the environment asks for more.
int case_count() {
    const char* wanted = std::getenv("NLOS_FUZZ_CASES");
    return wanted == nullptr ? 50 : std::atoi(wanted);
}

/// Changes up to eight bytes, and cuts the file short in one case of eight.
std::string mutate(std::string bytes, core::Rng& rng) {
    const auto below = [&](std::size_t limit) {
        return static_cast<std::size_t>(rng.uniform() * static_cast<double>(limit));
    };
    const std::size_t changes = 1 + below(8);
    for (std::size_t i = 0; i < changes; ++i) {
        constexpr std::array<int, 4> kEdges{0x00, 0x7f, 0x80, 0xff};
        char& byte = bytes[below(bytes.size())];
        if (below(2) == 0) {
            byte = static_cast<char>(kEdges[below(kEdges.size())]);
        } else {
            byte = static_cast<char>(byte ^ (1 << below(8)));
        }
    }
    if (below(8) == 0) bytes.resize(below(bytes.size()));
    return bytes;
}

/// Reads mutants of a file; every one must be read or refused by Error or Failure.
void fuzz(const std::string& path, const std::function<void()>& read) {
    const std::string original = test_support::file_bytes(path);
    ASSERT_FALSE(original.empty());
    ASSERT_NO_THROW(read());
    for (int i = 0; i < case_count(); ++i) {
        core::Rng rng(0x10f, static_cast<std::uint64_t>(i), original.size());
        test_support::write_file_bytes(path, mutate(original, rng));
        try {
            read();
        } catch (const core::Error& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        } catch (const core::Failure&) {
        } catch (const std::exception& error) {
            ADD_FAILURE() << "case " << i << ": " << error.what();
        }
    }
}

TEST(FileFuzz, MutatedCapturesAreReadOrRefused) {
    const TemporaryFolder folder;
    for (const auto pattern : {core::ScanPattern::Confocal, core::ScanPattern::Exhaustive}) {
        const std::string path = folder.file("capture.h5");
        core::Capture capture = test_support::example_capture(pattern);
        capture.variance = capture.transient;
        write_capture(path, capture);
        fuzz(path, [&] { read_capture(path); });
    }
}

TEST(FileFuzz, MutatedStreakImagesAreReadOrRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("capture.exr");
    core::Capture capture = test_support::example_capture(core::ScanPattern::Single);
    capture.variance = capture.transient;
    write_capture(path, capture);
    fuzz(path, [&] { read_capture(path); });
}

TEST(FileFuzz, MutatedImagesAreReadOrRefused) {
    const TemporaryFolder folder;
    core::Capture image = test_support::example_image();
    write_capture(folder.file("image.exr"), image);
    image.sequence = core::FrameSequence{{image.transient, image.transient}, 0.02, 0.04};
    write_capture(folder.file("image.h5"), image);
    for (const char* name : {"image.exr", "image.h5"}) {
        fuzz(folder.file(name), [&] { read_capture(folder.file(name)); });
    }
}

TEST(FileFuzz, MutatedOldHdf5FilesAreReadOrRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("capture.h5");
    write_old_hdf5(path, test_support::example_capture(core::ScanPattern::Exhaustive));
    fuzz(path, [&] { read_capture(path); });
}

TEST(FileFuzz, MutatedResponseCurvesAreReadOrRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("curve.txt");
    test_support::write_file_bytes(path, "# ps weight\n-10 1\n0 6.5\n2e1 3\n");
    fuzz(path, [&] { core::make_response({0.0, 0.0, path}, "response"); });
}

TEST(FileFuzz, MutatedVolumesAreReadOrRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("volume.h5");
    write_volume(path, test_support::example_reconstruction());
    fuzz(path, [&] { read_volume(path); });
}

TEST(FileFuzz, MutatedMatlabFilesAreReadOrRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("data.mat");
    const std::vector<std::uint16_t> data(3 * 3 * 20, 7);
    const std::vector<double> width{0.4};
    for (const auto compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
        write_mat(
            path,
            {mat_variable("rect_data", {3, 3, 20}, data), mat_variable("width", {1, 1}, width)},
            compression);
        fuzz(path, [&] { read_capture(path); });
    }
}

TEST(FileFuzz, MutatedPointListsAreReadOrRefused) {
    const TemporaryFolder folder;
    const std::vector<std::uint16_t> signal(3 * 5, 7);
    const std::vector<std::uint8_t> lit{0, 0, 0, 1, 2, 3, 5, 5, 5};
    const std::vector<std::uint8_t> seen{0, 0, 0, 4, 4, 4, 4, 4, 4};
    write_mat(folder.file("sub_Sig.mat"), {mat_variable("sub_Sig", {3, 5}, signal)});
    write_mat(folder.file("C_i.mat"), {mat_variable("C_i", {3, 3}, lit)});
    write_mat(folder.file("C_d.mat"), {mat_variable("C_d", {3, 3}, seen)}, MAT_COMPRESSION_NONE);
    CaptureReadSettings settings;
    settings.pitch_m = 0.01;
    settings.bin_width_m = 0.0048;
    fuzz(folder.file("C_d.mat"), [&] { read_capture(folder.path().string(), settings); });
}

TEST(FileFuzz, MutatedFilesOfArraysAreReadOrRefused) {
    const TemporaryFolder folder;
    write_example_mat5(folder.file("plain.mat"), MAT_COMPRESSION_NONE);
    write_example_mat5(folder.file("zlib.mat"), MAT_COMPRESSION_ZLIB);
    write_example_mat73(folder.file("v73.mat"));
    write_example_npz(folder.file("stored.npz"), ZIP_CM_STORE);
    write_example_npz(folder.file("deflated.npz"), ZIP_CM_DEFLATE);
    const auto write = [&](const char* name, const std::string& bytes) {
        test_support::write_file_bytes(folder.file(name), bytes);
    };
    write("a.npy", npy_bytes("'<f4'", "(2, 3)", std::string(24, '\1')));
    write("b.npy", npy_bytes("'>i2'", "(2, 3, 2)", std::string(24, '\1'), "True"));
    write("a.ti", example_ti_bytes());
    write("a.json", kExampleJson);
    write("a.csv", kExampleCsv);
    for (const char* name : {"plain.mat",
                             "zlib.mat",
                             "v73.mat",
                             "stored.npz",
                             "deflated.npz",
                             "a.npy",
                             "b.npy",
                             "a.ti",
                             "a.json",
                             "a.csv"}) {
        fuzz(folder.file(name), [&] { read_everything(folder.file(name)); });
    }
}

}  // namespace
}  // namespace nlos
