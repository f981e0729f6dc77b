// SPDX-License-Identifier: MIT
#include "nlos/containers/array_reader.h"
#include "tests/nlos/containers/example_mat5.h"
#include "tests/nlos/containers/example_mat73.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace nlos {
namespace {

using test_support::TemporaryFolder;
using Names = std::vector<std::string>;

class Mat5Files : public testing::TestWithParam<matio_compression> {
 protected:
    Mat5Files() { write_example_mat5(path_, GetParam()); }

    TemporaryFolder folder_;
    std::string path_ = folder_.file("data.mat");
};
INSTANTIATE_TEST_SUITE_P(Both,
                         Mat5Files,
                         testing::Values(MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB));

TEST_P(Mat5Files, PartsOfStructsAndCellsHaveTheNamesThatPeopleWrite) {
    const ArrayReader file(path_);
    EXPECT_EQ(file.container(), "matlab-v5");
    EXPECT_TRUE(file.first_index_fastest());
    EXPECT_EQ(file.names(),
              (Names{"meas",
                     "note",
                     "dataset.t0",
                     "dataset.deep.x",
                     "accum{0}",
                     "accum{1}",
                     "list(0).gain",
                     "list(0).name",
                     "list(1).gain",
                     "list(1).name",
                     "ticks",
                     "flag"}));
    EXPECT_TRUE(file.names_are_complete());
}

TEST_P(Mat5Files, ValuesComeInTheOrderOfTheFileWithTheSlowestAxisFirst) {
    const ArrayReader file(path_);
    EXPECT_EQ(file.shape("meas"), (Shape{2, 3, 4}));
    EXPECT_EQ(file.type("meas"), "uint16");
    const std::vector<float> values = file.read_floats("meas", {2, 3, 4});
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i], static_cast<float>(i));
    EXPECT_EQ(file.read_real("dataset.t0"), 0.25);
    EXPECT_EQ(file.read_real("dataset.deep.x"), 7.0);
    EXPECT_EQ(file.read_doubles("accum{0}", {3, 1}), (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(file.read_real("list(1).gain"), 2.5);
    EXPECT_EQ(file.read_doubles("ticks", {2, 1}), (std::vector<double>{1099511627776.0, -3.0}));
    EXPECT_EQ(file.read_real("list(1).gain"), 2.5);  // once more: what was read is kept
}

TEST_P(Mat5Files, CharactersAreTextAndTruthValuesAreIntegers) {
    const ArrayReader file(path_);
    EXPECT_EQ(file.read_text("note"), "h\u00e9\u20ac");
    EXPECT_EQ(file.read_text("accum{1}"), "two");
    EXPECT_EQ(file.read_text("list(0).name"), "a");
    EXPECT_EQ(file.type("flag"), "logical");
    EXPECT_EQ(file.kind("flag"), ElementKind::Integer);
    EXPECT_EQ(file.read_doubles("flag", {2, 1}), (std::vector<double>{1, 0}));
}

TEST_P(Mat5Files, WhatIsNoArrayOrNotThereIsTold) {
    const ArrayReader file(path_);
    EXPECT_TRUE(file.has_object("dataset"));
    EXPECT_FALSE(file.has("dataset"));
    EXPECT_EQ(file.type("dataset"), "struct");
    EXPECT_EQ(file.type("accum"), "cell");
    for (const char* name : {"dataset.t1",
                             "accum{2}",
                             "list(2).gain",
                             "list.gain",
                             "meas{0}",
                             "x",
                             "list(0)",
                             "meas.",
                             "",
                             "accum{",
                             "accum{-1}"}) {
        EXPECT_FALSE(file.has_object(name)) << name;
    }
    EXPECT_ERROR_WITH(file.read_real("accum{2}"), "data.mat: accum{2}: is missing or empty");
    EXPECT_ERROR_WITH(file.read_real("note"), "note: has shape (3, 1); must have shape (1, 1)");
    EXPECT_ERROR_WITH(file.read_text("meas"), "meas: holds no text");
}

TEST(Mat5File, ComplexNumbersAreRefused) {
    const TemporaryFolder folder;
    std::array<double, 2> real{1, 2};
    std::array<double, 2> imaginary{3, 4};
    mat_complex_split_t parts{real.data(), imaginary.data()};
    std::array<std::size_t, 2> shape{1, 2};
    write_mat5_variables(
        folder.file("a.mat"),
        {Mat_VarCreate("z", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, shape.data(), &parts, MAT_F_COMPLEX)},
        MAT_COMPRESSION_NONE);
    EXPECT_ERROR_WITH(ArrayReader(folder.file("a.mat")).read_doubles("z", {2, 1}),
                      "z: holds no plain numbers: complex float64; must hold real numbers");
}

TEST(Mat5File, BigEndianFilesReadTheSame) {
    const TemporaryFolder folder;
    std::string bytes(116, ' ');
    using namespace std::string_literals;
    bytes += std::string(8, '\0') + "\x01\x00MI"s;
    bytes += "\x00\x00\x00\x0e\x00\x00\x00\x34"s;  // a matrix of 52 bytes
    bytes += "\x00\x00\x00\x06\x00\x00\x00\x08\x00\x00\x00\x0b\x00\x00\x00\x00"s;  // of uint16
    bytes += "\x00\x00\x00\x05\x00\x00\x00\x08\x00\x00\x00\x01\x00\x00\x00\x02"s;  // 1 x 2
    bytes += "\x00\x01\x00\x01w\0\0\0"s;                                           // named w
    bytes += "\x00\x00\x00\x04\x00\x00\x00\x04\x01\x02\x03\x04"s;
    test_support::write_file_bytes(folder.file("a.mat"), bytes);
    EXPECT_EQ(ArrayReader(folder.file("a.mat")).read_doubles("w", {2, 1}),
              (std::vector<double>{0x102, 0x304}));
}

TEST(Mat73File, PartsHaveTheNamesOfThoseOfVersionFive) {
    const TemporaryFolder folder;
    write_example_mat73(folder.file("a.mat"));
    const ArrayReader file(folder.file("a.mat"));
    EXPECT_EQ(file.container(), "matlab-v7.3");
    EXPECT_TRUE(file.first_index_fastest());
    Names names = file.names();
    std::sort(names.begin(), names.end());
    EXPECT_EQ(names,
              (Names{"accum{0}",
                     "accum{1}",
                     "dataset.count",
                     "dataset.t0",
                     "flag",
                     "list(0).gain",
                     "list(1).gain",
                     "meas",
                     "none",
                     "note"}));
}

TEST(Mat73File, ValuesAndTextsAreReadThroughReferences) {
    const TemporaryFolder folder;
    write_example_mat73(folder.file("a.mat"));
    const ArrayReader file(folder.file("a.mat"));
    EXPECT_EQ(file.read_floats("meas", {2, 3, 4}), std::vector<float>(24, 1.5F));
    EXPECT_EQ(file.type("meas"), "float32");
    EXPECT_EQ(file.read_text("note"), "h\u00e9\U0001f600");
    EXPECT_EQ(file.read_real("dataset.t0"), 0.25);
    EXPECT_EQ(file.read_integer("dataset.count"), -7);
    EXPECT_EQ(file.read_doubles("accum{0}", {3, 1}), (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(file.read_real("accum{1}"), 4.0);
    EXPECT_EQ(file.read_doubles("list(1).gain", {3, 1}), (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(file.type("flag"), "logical");
    EXPECT_EQ(file.type("dataset"), "struct");
    EXPECT_EQ(file.type("accum"), "cell");
    EXPECT_FALSE(file.has("accum"));
}

TEST(Mat73File, EmptyArraysHaveTheirExtentsAndNoValues) {
    const TemporaryFolder folder;
    write_example_mat73(folder.file("a.mat"));
    const ArrayReader file(folder.file("a.mat"));
    EXPECT_EQ(file.shape("none"), (Shape{3, 0}));
    EXPECT_EQ(file.type("none"), "float64");
    EXPECT_TRUE(file.read_doubles("none", {3, 0}).empty());
}

TEST(Mat73File, PlainHdf5OfTheSameSuffixIsPlainHdf5) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.mat");
    const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(file);
    EXPECT_EQ(container_of(path), "hdf5");
}

TEST(Mat73File, AMillionReferencesAreListedUpToABound) {
    const TemporaryFolder folder;
    {
        Mat73Writer file(folder.file("a.mat"));
        file.add_group("#refs#");
        file.add_numbers<double>("#refs#/a", "double", {1, 1}, {4.0});
        file.add_references("accum", "cell", std::vector<std::string>(1'000'000, "#refs#/a"));
    }
    const ArrayReader file(folder.file("a.mat"));
    EXPECT_EQ(file.names().size(), ArrayNames::kMost);
    EXPECT_FALSE(file.names_are_complete());
    EXPECT_EQ(file.read_real("accum{999999}"), 4.0);
}

TEST(Mat73File, CellsThatHoldThemselvesAreListedUpToABound) {
    const TemporaryFolder folder;
    {
        Mat73Writer file(folder.file("a.mat"));
        file.add_references("accum", "cell", {"accum", "accum"});
        hobj_ref_t references[2];
        for (hobj_ref_t& reference : references) {
            H5Rcreate(&reference, file.file(), "accum", H5R_OBJECT, -1);
        }
        const hid_t set = H5Dopen2(file.file(), "accum", H5P_DEFAULT);
        H5Dwrite(set, H5T_STD_REF_OBJ, H5S_ALL, H5S_ALL, H5P_DEFAULT, references);
        H5Dclose(set);
    }
    const ArrayReader file(folder.file("a.mat"));
    EXPECT_TRUE(file.names().empty());
    EXPECT_FALSE(file.names_are_complete());
    EXPECT_EQ(file.type("accum{1}{0}{1}"), "cell");
}

}  // namespace
}  // namespace nlos
