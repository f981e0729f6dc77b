// SPDX-License-Identifier: MIT
#include "nlos/containers/array_reader.h"
#include "tests/nlos/containers/example_bytes.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nlos {
namespace {

using Names = std::vector<std::string>;
using Values = std::vector<double>;

/// A file of this name and content, open.
class FileOf {
 public:
    FileOf(const std::string& name, const std::string& bytes) : path_(folder_.file(name)) {
        test_support::write_file_bytes(path_, bytes);
    }
    ArrayReader open() const { return ArrayReader(path_); }

 private:
    test_support::TemporaryFolder folder_;
    std::string path_;
};

TEST(JsonFile, LeavesOfListsOfObjectsAreOneArray) {
    const ArrayReader file = FileOf("log.json", kExampleJson).open();
    EXPECT_EQ(file.container(), "json");
    EXPECT_FALSE(file.first_index_fastest());
    EXPECT_EQ(file.names(),
              (Names{"Result_Set.info.frame",
                     "Result_Set.mp_histo.bin",
                     "Result_Set.found.1",
                     "configuration.name",
                     "configuration.range_m",
                     "configuration.is_on"}));
    EXPECT_EQ(file.read_doubles("Result_Set.mp_histo.bin", {2, 1, 2, 2}),
              (Values{1, 2, 3, 4, 5, 6, 7, 8}));
    EXPECT_EQ(file.read_doubles("Result_Set.info.frame", {2}), (Values{0, 1}));
    EXPECT_EQ(file.kind("Result_Set.info.frame"), ElementKind::Integer);
    EXPECT_EQ(file.read_text("configuration.name"), "größer");
    EXPECT_EQ(file.read_real("configuration.range_m"), 1.5);
    EXPECT_EQ(file.kind("configuration.range_m"), ElementKind::Real);
    EXPECT_EQ(file.type("configuration.is_on"), "bool");
    EXPECT_EQ(file.read_integer("configuration.is_on"), 1);
}

TEST(JsonFile, WhatDoesNotStackIsNamedByItsIndex) {
    const ArrayReader file =
        FileOf("a.json", R"([[1, 2], [3, null], {"a": 4}, [["x", 5], [6, 7]]])").open();
    EXPECT_EQ(file.names(), (Names{"0", "1", "2.a", "3.0.0", "3.0.1", "3.1.0", "3.1.1"}));
    EXPECT_EQ(file.read_doubles("0", {2}), (Values{1, 2}));
    EXPECT_EQ(file.read_text("3.0.0"), "x");
    EXPECT_EQ(file.read_real("3.1.1"), 7.0);
    const Values with_gap = file.read_doubles("1", {2});
    EXPECT_EQ(with_gap[0], 3.0);
    EXPECT_TRUE(std::isnan(with_gap[1]));
}

TEST(JsonFile, OneValuePerLineIsAList) {
    const ArrayReader file =
        FileOf("a.log", "{\"h\": [1, 2]}\n\n{\"h\": [3, 4]}\r\n{\"h\": [5, 6]}").open();
    EXPECT_EQ(file.read_doubles("h", {3, 2}), (Values{1, 2, 3, 4, 5, 6}));
    EXPECT_ERROR_WITH(FileOf("a.log", "{\"h\": [1]}\n{\"h\": [3,]}\n").open(),
                      "a.log: line 2: is not valid JSON");
}

TEST(JsonFile, ALoneListIsTheArray) {
    EXPECT_EQ(FileOf("a.json", " [[1, 2, 3]]").open().read_doubles("array", {1, 3}),
              (Values{1, 2, 3}));
}

TEST(JsonFile, DeepNestingAndManyLeavesAreBounded) {
    const std::string deep(200'000, '[');
    EXPECT_ERROR_WITH(FileOf("a.json", deep).open(), "a.json: its JSON is nested deeper than 100");
    std::string many = "{\"a0\": 0";
    for (int i = 1; i < 5000; ++i)
        many += ", \"a" + std::to_string(i) + "\": [" + std::to_string(i) + "]";
    const ArrayReader file = FileOf("a.json", many + "}").open();
    EXPECT_EQ(file.names().size(), ArrayNames::kMost);
    EXPECT_FALSE(file.names_are_complete());
}

TEST(CsvFile, TablesAndNamedColumnsAreRead) {
    const ArrayReader file = FileOf("a.csv", kExampleCsv).open();
    EXPECT_EQ(file.container(), "csv");
    EXPECT_EQ(file.names(), (Names{"x", "y", "z", "table"}));
    EXPECT_EQ(file.read_doubles("table", {2, 3}), (Values{1, 2, -0.3, 4, 5, 6}));
    EXPECT_EQ(file.read_doubles("z", {2}), (Values{-0.3, 6}));
}

TEST(CsvFile, SemicolonsTabsAndBlanksSeparateToo) {
    for (const char* text :
         {"1;2\n3;4\n", "1\t2\n3\t4", "  1   2 \n3 4\n\n", "1,2,\n3,4,\n", "+1, 2\n3 ,4"}) {
        EXPECT_EQ(FileOf("a.txt", text).open().read_doubles("table", {2, 2}), (Values{1, 2, 3, 4}))
            << text;
    }
}

TEST(CsvFile, LinesThatAreNoRowAreNamed) {
    EXPECT_ERROR_WITH(FileOf("a.csv", "x,y\n1,2\n\n3\n").open(),
                      "a.csv: line 4: has 1 cells; must have 2, as the first line");
    EXPECT_ERROR_WITH(FileOf("a.csv", "1;2\n3;4,5\n").open(),
                      "line 2: found '4,5'; must be a number");
    EXPECT_ERROR_WITH(FileOf("a.csv", "1,\n,2\n").open(), "line 2: has 2 cells");
    EXPECT_ERROR_WITH(FileOf("a.csv", "1,2\n3,,\n").open(), "line 2: found ''");
    EXPECT_ERROR_WITH(FileOf("a.csv", "x,y\n").open(), "a.csv: holds no numbers");
    EXPECT_ERROR_WITH(FileOf("a.dat", "1,2\n").open(), "a.dat: is no file of arrays");
}

TEST(TiFile, VersionFourHoldsItsPlaneAndProperties) {
    const ArrayReader file = FileOf("a.ti", example_ti_bytes()).open();
    EXPECT_EQ(file.container(), "bonn-ti");
    EXPECT_EQ(file.names(),
              (Names{"pixelMode",
                     "numPixels",
                     "numBins",
                     "tMin",
                     "tDelta",
                     "blockSize",
                     "data",
                     "uRes",
                     "vRes",
                     "topLeft",
                     "topRight",
                     "bottomLeft",
                     "bottomRight",
                     "laserPosition",
                     "exposure_s",
                     "laser.name"}));
    EXPECT_EQ(file.read_integer("uRes"), 3);
    EXPECT_EQ(file.read_real("tDelta"), 0.25);
    const std::vector<float> data = file.read_floats("data", {6, 4});
    for (std::size_t i = 0; i < data.size(); ++i) EXPECT_EQ(data[i], static_cast<float>(i));
    EXPECT_EQ(file.read_doubles("laserPosition", {3}), (Values{12.5, 13.5, 14.5}));
    EXPECT_EQ(file.read_text("laser.name"), "green");
}

TEST(TiFile, OlderVersionsHoldTheirResolution) {
    const ArrayReader one = FileOf("a.ti", example_old_ti_bytes("TI01", {4, 3, 2})).open();
    const ArrayReader zero = FileOf("a.ti", example_old_ti_bytes("TI00", {2, 4, 3})).open();
    for (const ArrayReader* file : {&one, &zero}) {
        EXPECT_EQ(file->read_integer("numBins"), 4);
        EXPECT_EQ(file->read_integer("uRes"), 3);
        EXPECT_EQ(file->read_integer("vRes"), 2);
        EXPECT_EQ(file->read_integer("numPixels"), 6);
        EXPECT_EQ(file->read_real("tmax"), 1.5);
        EXPECT_EQ(file->read_floats("data", {6, 4}), std::vector<float>(24, 1.5F));
    }
    EXPECT_EQ(zero.read_text("imageProperties"), "hand-held");
}

TEST(TiFile, CountsBeyondTheFileAreRefused) {
    EXPECT_ERROR_WITH(FileOf("a.ti", example_ti_bytes(7'000'000)).open(),
                      "a.ti: claims 112000000 bytes where only");
    EXPECT_ERROR_WITH(FileOf("a.ti", example_ti_bytes(0xffffffff)).open(),
                      "must be a complete .ti");
    const std::string good = example_ti_bytes();
    const std::size_t text_begin = good.find('{');
    for (std::size_t length = 4; length < text_begin; ++length) {
        EXPECT_ERROR_WITH(FileOf("a.ti", good.substr(0, length)).open(), "a.ti: claims") << length;
    }
}

}  // namespace
}  // namespace nlos
