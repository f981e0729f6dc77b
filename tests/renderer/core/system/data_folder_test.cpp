// SPDX-License-Identifier: MIT
#include "renderer/core/system/data_folder.h"

#include "renderer/core/error.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace {

namespace fs = std::filesystem;

class DataFolder : public ::testing::Test {
 protected:
    ~DataFolder() override { ::unsetenv("NLOS_DATA"); }
};

TEST_F(DataFolder, IsThatOfTheSourcesWhereNothingIsInstalled) {
    ::unsetenv("NLOS_DATA");
    EXPECT_TRUE(fs::exists(core::data_folder() + "/scenes/letter/scene.json"));
    EXPECT_TRUE(fs::exists(core::data_folder() + "/data/letter.h5"));
}

TEST_F(DataFolder, IsThatOfTheEnvironment) {
    ::setenv("NLOS_DATA", "/tmp", 1);
    EXPECT_EQ(core::data_folder(), "/tmp");
    ::setenv("NLOS_DATA", "/no/such/folder", 1);
    EXPECT_THROW(core::data_folder(), core::Error);
}

TEST_F(DataFolder, IsAskedForFilesThatAreNotInTheWorkingFolder) {
    ::unsetenv("NLOS_DATA");
    const fs::path before = fs::current_path();
    fs::current_path("/");
    const std::string letter = "data/letter.h5";
    EXPECT_EQ(core::shipped_file(letter), core::data_folder() + "/" + letter);
    EXPECT_EQ(core::shipped_file("/tmp"), "/tmp");
    EXPECT_EQ(core::shipped_file("no/such/file"), "no/such/file");
    EXPECT_EQ(core::shipped_file(""), "");
    fs::current_path(core::data_folder());
    EXPECT_EQ(core::shipped_file(letter), letter);
    fs::current_path(before);
}

}  // namespace
