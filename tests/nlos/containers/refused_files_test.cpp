// SPDX-License-Identifier: MIT
// Files that are told by name though they cannot be read as they are, and files packed by gzip.
#include "nlos/containers/array_reader.h"
#include "nlos/formats/capture_file.h"
#include "tests/nlos/containers/example_bytes.h"
#include "tests/nlos/containers/example_mat5.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <hdf5.h>
#include <zlib.h>

namespace nlos {
namespace {

using test_support::TemporaryFolder;
using test_support::write_file_bytes;

std::string packed_by_gzip(const std::string& bytes) {
    constexpr int kGzip = 15 + 16;
    constexpr int kMemory = 8;
    z_stream stream{};
    deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY);
    std::string packed(deflateBound(&stream, bytes.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    return packed;
}

TEST(GzipFile, IsReadAsWhatItHolds) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.json.gz");
    write_file_bytes(path,
                     packed_by_gzip(R"({"hists": [[1, 2, 3], [4, 5)") + packed_by_gzip(", 6]]}"));
    const ArrayReader json(path);
    EXPECT_EQ(json.container(), "json");
    EXPECT_EQ(json.read_doubles("hists", {2, 3}), (std::vector<double>{1, 2, 3, 4, 5, 6}));
    write_example_mat5(folder.file("a.mat"), MAT_COMPRESSION_ZLIB);
    write_file_bytes(path, packed_by_gzip(test_support::file_bytes(folder.file("a.mat"))));
    EXPECT_EQ(ArrayReader(path).read_real("dataset.t0"), 0.25);
    const core::Capture capture = test_support::example_capture(core::ScanPattern::Confocal);
    for (const char* name : {"b.h5", "b.npz"}) {
        write_capture(folder.file(name), capture);
        write_file_bytes(path, packed_by_gzip(test_support::file_bytes(folder.file(name))));
        EXPECT_TRUE(
            std::ranges::equal(read_capture(path).transient.values(), capture.transient.values()));
    }
}

TEST(GzipFile, ErrorsNameTheFileThatPeopleKnow) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.json.gz");
    write_file_bytes(path, packed_by_gzip(R"({"hists": [)"));
    EXPECT_ERROR_WITH(ArrayReader(path), path);
    write_file_bytes(path, packed_by_gzip("some text"));
    EXPECT_ERROR_WITH(ArrayReader(path), "must be unpacked: gunzip -k " + path);
}

TEST(GzipFile, OneThatIsDamagedOrCutShortIsRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.json.gz");
    const std::string bytes = packed_by_gzip(R"({"hists": [[1, 2, 3], [4, 5, 6]]})");
    std::string damaged = bytes;
    damaged[bytes.size() - 7] ^= 4;  // of the checksum
    write_file_bytes(path, damaged);
    EXPECT_ERROR_WITH(ArrayReader(path), "a.json.gz: is damaged or cut short");
    write_file_bytes(path, bytes.substr(0, bytes.size() - 9));
    EXPECT_ERROR_WITH(ArrayReader(path), "a.json.gz: is damaged or cut short");
}

TEST(RefusedFiles, GitLfsPointersAreCalledSo) {
    const TemporaryFolder folder;
    for (const char* name : {"a.mat", "a.h5", "a.csv"}) {
        write_file_bytes(folder.file(name),
                         "version https://git-lfs.github.com/spec/v1\noid sha256:0123\nsize 9\n");
        EXPECT_ERROR_WITH(read_capture(folder.file(name)), "is a Git LFS pointer");
    }
}

/// The start of a MATLAB file of version 4: an array `name` of 2 x 3 numbers.
std::string mat4_bytes(std::uint32_t type, std::size_t number_bytes, bool swapped) {
    std::vector<std::uint32_t> header{type, 2, 3, 0, 5};
    if (swapped) {
        for (std::uint32_t& word : header) word = __builtin_bswap32(word);
    }
    return bytes_of_values(header) + std::string("name\0", 5) + std::string(6 * number_bytes, '\1');
}

TEST(RefusedFiles, MatlabOfVersionFourIsToldHowToBeSaved) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.mat");
    for (const auto& bytes :
         {mat4_bytes(0, 8, false), mat4_bytes(30, 2, false), mat4_bytes(1010, 4, true)}) {
        write_file_bytes(path, bytes);
        EXPECT_ERROR_WITH(read_capture(path), "is a MATLAB file of version 4");
        EXPECT_ERROR_WITH(read_capture(path), "save(..., '-v7')");
    }
    write_file_bytes(path, mat4_bytes(70, 8, false));  // there is no such kind of numbers
    EXPECT_ERROR_WITH(read_capture(path), "is no capture in a known format");
}

TEST(RefusedFiles, SparseAndStructuredArraysAndCellsAreNamed) {
    const TemporaryFolder folder;
    const std::string npz = folder.file("a.npz");
    write_npz(npz,
              {{"H.npy",
                npy_bytes("[('a', '<f4', (2,)), (\"b]\", [('c', '<i4')])]",
                          "(5, 3, 2)",
                          std::string(30 * 12, '\1'))}});
    EXPECT_ERROR_WITH(ArrayReader(npz).read_floats("H", {5, 3, 2}),
                      "a.npz: H: holds no plain numbers: structured");
    EXPECT_EQ(ArrayReader(npz).shape("H"), (Shape{5, 3, 2}));
    const std::string mat = folder.file("a.mat");
    write_mat5_variables(mat,
                         {mat5_cell("sig", {mat5_number(nullptr, 1.0), mat5_number(nullptr, 2.0)})},
                         MAT_COMPRESSION_ZLIB);
    EXPECT_ERROR_WITH(ArrayReader(mat).read_doubles("sig", {2}),
                      "sig: is a cell array; must be an array of numbers, such as cat(3, sig{:})");
}

/// A filter that does nothing, under the number of another.
std::size_t keep_bytes(
    unsigned, std::size_t, const unsigned*, std::size_t bytes, std::size_t*, void**) {
    return bytes;
}

TEST(RefusedFiles, FiltersThatAreNotThereAreNamed) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.h5");
    const auto write = [&](H5Z_filter_t number) {
        const H5Z_class2_t filter{H5Z_CLASS_T_VERS, number, 1, 1, "", nullptr, nullptr, keep_bytes};
        H5Zregister(&filter);
        const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
        const hsize_t extents = 4;
        const hid_t space = H5Screate_simple(1, &extents, nullptr);
        const hid_t plan = H5Pcreate(H5P_DATASET_CREATE);
        H5Pset_chunk(plan, 1, &extents);
        H5Pset_filter(plan, number, H5Z_FLAG_MANDATORY, 0, nullptr);
        const hid_t data =
            H5Dcreate2(file, "H", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, plan, H5P_DEFAULT);
        const std::array<double, 4> values{1, 2, 3, 4};
        H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
        H5Dclose(data);
        H5Pclose(plan);
        H5Sclose(space);
        H5Fclose(file);
        H5Zunregister(number);
    };
    const auto message = [&] {
        return test_support::error_message([&] { ArrayReader(path).read_doubles("H", {4}); });
    };
    for (const auto& [number, name] : {std::pair(32000, "lzf"),
                                       std::pair(32001, "blosc"),
                                       std::pair(32015, "zstd"),
                                       std::pair(40001, "filter 40001")}) {
        write(number);
        EXPECT_NE(message().find(std::string("H: is compressed by ") + name), std::string::npos)
            << message();
        EXPECT_NE(message().find("h5repack -f GZIP=4 " + path), std::string::npos) << message();
    }
}

}  // namespace
}  // namespace nlos
