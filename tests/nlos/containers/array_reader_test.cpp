// SPDX-License-Identifier: MIT
#include "nlos/containers/array_reader.h"

#include "nlos/containers/writers/hdf5_writer.h"
#include "tests/nlos/containers/example_bytes.h"
#include "tests/nlos/containers/example_mat5.h"
#include "tests/nlos/containers/example_mat73.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/stat.h>

namespace nlos {
namespace {

using test_support::TemporaryFolder;
using Names = std::vector<std::string>;

TEST(ArrayReader, ContainersAreToldByContentAndTablesBySuffix) {
    const TemporaryFolder folder;
    const auto check = [&](const std::string& name, const std::string& container) {
        EXPECT_EQ(container_of(folder.file(name)), container);
        EXPECT_EQ(ArrayReader(folder.file(name)).container(), container);
    };
    write_example_mat5(folder.file("a"), MAT_COMPRESSION_ZLIB);
    check("a", "matlab-v5");
    write_example_mat73(folder.file("b"));
    check("b", "matlab-v7.3");
    write_example_npz(folder.file("c"));
    check("c", "npz");
    const auto check_bytes =
        [&](const char* name, const std::string& bytes, const char* container) {
            test_support::write_file_bytes(folder.file(name), bytes);
            check(name, container);
        };
    check_bytes("d", npy_bytes("'<f4'", "()", "1234"), "npy");
    check_bytes("e", example_ti_bytes(), "bonn-ti");
    check_bytes("f", kExampleJson, "json");
    check_bytes("g.csv", kExampleCsv, "csv");
    test_support::write_file_bytes(folder.file("h"), kExampleCsv);
    EXPECT_EQ(container_of(folder.file("h")), std::nullopt);
    EXPECT_ERROR_WITH(ArrayReader(folder.file("h")),
                      "h: is no file of arrays; must be HDF5 (MATLAB v7.3 too), MATLAB v5");
}

TEST(ArrayReader, OnlyRegularFilesAreOpened) {
    const TemporaryFolder folder;
    ASSERT_EQ(::mkfifo(folder.file("pipe.h5").c_str(), 0600), 0);
    EXPECT_ERROR_WITH(ArrayReader(folder.file("pipe.h5")), "pipe.h5: is no file of arrays");
    EXPECT_ERROR_WITH(ArrayReader("/dev/zero"), "/dev/zero: is no file of arrays");
    EXPECT_ERROR_WITH(ArrayReader(folder.path().string()), "is no file of arrays");
    EXPECT_ERROR_WITH(ArrayReader(folder.file("none.h5")), "none.h5: cannot be opened");
    EXPECT_EQ(container_of(folder.file("pipe.h5")), std::nullopt);
}

TEST(Hdf5File, GroupsAreListedAndCyclesAndForeignLinksAreNot) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.h5");
    {
        Hdf5Writer other(folder.file("other.h5"));
        other.write_real("x", 1.0);
        other.finish();
        Hdf5Writer writer(path);
        writer.write_real("x", 2.0);
        writer.create_group("nlos");
        writer.write_text("nlos/note", "text");
        writer.finish();
    }
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    H5Lcreate_hard(file, "/", file, "nlos/up", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_soft("/x", file, "soft", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_soft("/nowhere", file, "dangling", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_external("other.h5", "/x", file, "foreign", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_soft("/foreign", file, "roundabout", H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(file);
    const ArrayReader reader(path);
    Names names = reader.names();
    std::sort(names.begin(), names.end());
    EXPECT_EQ(names, (Names{"nlos/note", "soft", "x"}));
    EXPECT_TRUE(reader.names_are_complete());
    EXPECT_EQ(reader.read_real("soft"), 2.0);
    EXPECT_EQ(reader.read_text("nlos/up/nlos/note"), "text");
    EXPECT_ERROR_WITH(reader.has("foreign"), "a.h5: foreign: is kept in another file");
    EXPECT_FALSE(reader.has_object("roundabout"));
    EXPECT_FALSE(reader.has_object("dangling"));
}

/// Adds a float dataset of `count` values with the given creation properties.
void add_dataset(hid_t file, const char* name, hsize_t count, hid_t plan) {
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    H5Dclose(H5Dcreate2(file, name, H5T_NATIVE_FLOAT, space, H5P_DEFAULT, plan, H5P_DEFAULT));
    H5Sclose(space);
}

TEST(Hdf5File, ValuesThatAreKeptElsewhereOrNowhereAreRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.h5");
    const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t external = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(external, "/dev/zero", 0, 16);
    add_dataset(file, "external", 4, external);
    H5Pclose(external);
    const hid_t source = H5Pcreate(H5P_DATASET_CREATE);
    hsize_t count = 4;
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    H5Pset_virtual(source, space, "other.h5", "x", space);
    add_dataset(file, "virtual", 4, source);
    H5Sclose(space);
    H5Pclose(source);
    const hid_t chunks = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk = 1 << 20;
    H5Pset_chunk(chunks, 1, &chunk);
    H5Pset_deflate(chunks, 9);
    add_dataset(file, "claims", hsize_t{1} << 40, chunks);
    H5Pclose(chunks);
    H5Fclose(file);
    const ArrayReader reader(path);
    EXPECT_EQ(reader.names(), (Names{"claims", "external", "virtual"}));
    EXPECT_ERROR_WITH(reader.has("external"), "external: is kept in other files");
    EXPECT_ERROR_WITH(reader.has("virtual"), "virtual: is kept in other files");
    EXPECT_ERROR_WITH(reader.read_floats("claims", {std::size_t{1} << 40}),
                      "claims: claims shape (1099511627776,) but only 0 bytes are stored");
}

TEST(Hdf5File, ArraysAndGroupsWithoutEndAreListedUpToABound) {
    constexpr int kCount = 5000;
    const TemporaryFolder folder;
    for (const bool is_group : {false, true}) {
        const std::string path = folder.file("a.h5");
        const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
        for (int i = 0; i < kCount; ++i) {
            const std::string name = "x" + std::to_string(i);
            if (is_group) {
                H5Gclose(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
            } else {
                add_dataset(file, name.c_str(), 1, H5P_DEFAULT);
            }
        }
        H5Fclose(file);
        const ArrayReader reader(path);
        EXPECT_EQ(reader.names().size(), is_group ? 0 : ArrayNames::kMost);
        EXPECT_FALSE(reader.names_are_complete());
        EXPECT_TRUE(reader.has_object("x4999"));
    }
}

}  // namespace
}  // namespace nlos
