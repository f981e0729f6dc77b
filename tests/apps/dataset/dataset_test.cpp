// SPDX-License-Identifier: MIT
#include "apps/batch/checksum.h"
#include "apps/dataset/dataset_index.h"
#include "apps/dataset/generate.h"
#include "nlos/containers/array_reader.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/parallel.h"
#include "tests/apps/dataset/tiny_recipe.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <limits>

namespace {

namespace fs = std::filesystem;

using apps::Dataset;
using apps::ItemRange;
using apps::Recipe;
using test_support::file_bytes;
using test_support::read;
using test_support::TemporaryFolder;
using test_support::tiny_recipe;

apps::GenerateResult run(const TemporaryFolder& folder,
                         const core::Json& recipe,
                         const std::string& name,
                         const apps::WorkShare& share = {},
                         const std::optional<ItemRange>& items = std::nullopt) {
    Dataset dataset(read(folder, recipe), folder.file(name));
    return apps::generate(dataset, share, items, "test", {});
}

/// The bytes of all shards, in order.
std::vector<std::string> shards(const TemporaryFolder& folder, const std::string& name) {
    std::vector<std::string> bytes;
    for (const char* suffix : {".h5", ".tar"}) {
        for (std::uint64_t shard = 0; shard < 10; ++shard) {
            const std::string path = folder.file(name + "/" + apps::shard_name(shard) + suffix);
            if (fs::exists(path)) bytes.push_back(file_bytes(path));
        }
    }
    return bytes;
}

std::vector<std::string> problems(const TemporaryFolder& folder, const std::string& name) {
    return apps::read_dataset(folder.file(name), apps::ShardCheck::Contents).problems;
}

TEST(Dataset, HasTheSameBytesForAnyThreadsSharesAndOrder) {
    const TemporaryFolder folder;
    for (const char* format : {"hdf5", "webdataset"}) {
        const core::Json recipe = tiny_recipe({{"format", format}});
        const std::string whole = std::string("whole_") + format;
        {
            const core::ThreadLimit one(1);
            EXPECT_EQ(run(folder, recipe, whole).items_written, 10u);
        }
        const std::string parts = std::string("parts_") + format;
        const core::ThreadLimit seven(7);
        run(folder, recipe, parts, {2, 3});
        run(folder, recipe, parts, {}, ItemRange{1, 2});
        run(folder, recipe, parts, {0, 3});
        run(folder, recipe, parts, {1, 3});
        EXPECT_EQ(shards(folder, whole).size(), 3u);
        EXPECT_EQ(shards(folder, whole), shards(folder, parts)) << format;
        EXPECT_EQ(problems(folder, parts), std::vector<std::string>{});
    }
}

TEST(Dataset, DiffersWithTheSeedAndBetweenItems) {
    const TemporaryFolder folder;
    run(folder, tiny_recipe(), "a");
    run(folder, tiny_recipe({{"seed", 6}}), "b");
    EXPECT_NE(shards(folder, "a")[0], shards(folder, "b")[0]);
    const nlos::ArrayReader reader(folder.file("a/shard-00000.h5"));
    const std::vector<float> values = reader.read_floats("clean", {4, 96, 4, 4});
    const std::size_t item = values.size() / 4;
    EXPECT_FALSE(std::equal(
        values.begin(), values.begin() + static_cast<std::ptrdiff_t>(item), &values[item]));
}

TEST(Dataset, PlacesAndDirectionsStateTheirFrame) {
    const TemporaryFolder folder;
    run(folder, tiny_recipe(), "set");
    const nlos::ArrayReader reader(folder.file("set/shard-00000.h5"));
    EXPECT_EQ(reader.text_attribute("depth", "frame"), "wall");
    EXPECT_EQ(reader.text_attribute("depth", "units"), "m");
    EXPECT_EQ(reader.text_attribute("normals", "frame"), "world");
    EXPECT_EQ(reader.text_attribute("normals", "units"), "1");
    EXPECT_EQ(reader.text_attribute("poses", "frame"), "world");
    EXPECT_EQ(reader.text_attribute("albedo", "frame"), std::nullopt);
}

TEST(Dataset, MissingAndDamagedShardsAreMadeAgainAndNothingElse) {
    const TemporaryFolder folder;
    run(folder, tiny_recipe(), "set");
    const std::vector<std::string> before = shards(folder, "set");
    fs::remove(folder.file("set/shard-00000.json"));
    std::string damaged = before[1];
    damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 1);
    test_support::write_file_bytes(folder.file("set/shard-00001.h5"), damaged);
    EXPECT_EQ(problems(folder, "set").size(), 2u);
    const apps::GenerateResult again = run(folder, tiny_recipe(), "set");
    EXPECT_EQ(again.shards_written, 2u);
    EXPECT_EQ(again.shards_there, 1u);
    EXPECT_EQ(shards(folder, "set"), before);
    fs::resize_file(folder.file("set/shard-00002.h5"), 100);
    EXPECT_EQ(run(folder, tiny_recipe(), "set").shards_written, 1u);
    EXPECT_EQ(shards(folder, "set"), before);
}

TEST(Dataset, GrowsWithTheNumberOfItemsAndKeepsWhatIsThere) {
    const TemporaryFolder folder;
    run(folder, tiny_recipe(), "small");
    const apps::GenerateResult grown = run(folder, tiny_recipe({{"items", 13}}), "small");
    EXPECT_EQ(grown.shards_there, 2u);
    EXPECT_EQ(grown.shards_written, 2u);  // the last one had two items of four
    run(folder, tiny_recipe({{"items", 13}}), "large");
    EXPECT_EQ(shards(folder, "small"), shards(folder, "large"));
}

TEST(Dataset, StopsBetweenItemsAndGoesOn) {
    const TemporaryFolder folder;
    Dataset dataset(read(folder, tiny_recipe()), folder.file("set"));
    std::atomic<bool> stop = false;
    int items = 0;
    core::Progress progress;
    progress.report = [&](double, const std::string&) { stop = ++items > 5; };
    progress.stop_requested = [&] { return stop.load(); };
    const apps::GenerateResult stopped = apps::generate(dataset, {}, std::nullopt, "t", progress);
    EXPECT_TRUE(stopped.interrupted);
    EXPECT_EQ(stopped.shards_written, 1u);
    for (const auto& entry : fs::directory_iterator(folder.file("set"))) {
        EXPECT_EQ(entry.path().string().find(".partial"), std::string::npos) << entry.path();
    }
    EXPECT_EQ(run(folder, tiny_recipe(), "set").shards_written, 2u);
    const apps::DatasetIndex index =
        apps::read_dataset(folder.file("set"), apps::ShardCheck::Contents);
    EXPECT_EQ(index.problems, std::vector<std::string>{});
    ASSERT_EQ(index.doubts.size(), 1u) << "two programs made it";
    EXPECT_NE(index.doubts[0].find("several versions"), std::string::npos);
}

// Whenever a run is stopped, a shard is whole or not there.
TEST(Dataset, AShardThatIsStoppedInItsLastItemIsNotThere) {
    const core::ThreadLimit limit(1);
    const TemporaryFolder folder;
    const core::Json recipe = tiny_recipe(
        {{"scene",
          {{"render", {{"target_error", nullptr}, {"method", "path"}, {"samples", 8000}}}}}});
    bool is_interrupted = false;
    const auto ask_times = [&](const std::string& name, int stop_at) {
        int asked = 0;
        core::Progress progress;
        progress.stop_requested = [&] { return ++asked >= stop_at; };
        Dataset dataset(read(folder, recipe), folder.file(name));
        is_interrupted = apps::generate(dataset, {}, ItemRange{0, 4}, "test", progress).interrupted;
        return asked;
    };
    const int times = ask_times("whole", std::numeric_limits<int>::max());
    for (int at = times - 3; at <= times; ++at) {
        const std::string name = "stopped_" + std::to_string(at);
        ask_times(name, at);
        EXPECT_TRUE(is_interrupted || at >= times - 1) << at << " of " << times;
        const auto expected = is_interrupted ? std::vector<std::string>{} : shards(folder, "whole");
        EXPECT_TRUE(shards(folder, name) == expected) << at << " of " << times;
        EXPECT_EQ(fs::exists(apps::manifest_path(folder.file(name), 0)), !is_interrupted);
    }
}

TEST(Dataset, OneToleranceOfElementsServesAllItemsAndIsRemembered) {
    const TemporaryFolder folder;
    core::Json recipe = tiny_recipe({{"calibration_items", 2}});
    recipe["scene"]["render"]["target_error"] = 0.05;
    run(folder, recipe, "set");
    const core::Json claim = core::read_json_file(folder.file("set/recipe.json"));
    ASSERT_TRUE(claim["element_tolerance"].is_number());
    core::Json exact = recipe;
    exact["calibration_items"] = 0;
    exact["scene"]["render"]["target_error"] = 0.005;
    run(folder, exact, "exact");
    const auto clean = [&](const char* name) {
        return nlos::ArrayReader(folder.file(name)).read_floats("clean", {4, 96, 4, 4});
    };
    const std::vector<float> values = clean("set/shard-00000.h5");
    const std::vector<float> truth = clean("exact/shard-00000.h5");
    for (std::size_t item = 0; item < 4; ++item) {
        double difference = 0.0;
        double norm = 0.0;
        for (std::size_t i = item * 96 * 16; i < (item + 1) * 96 * 16; ++i) {
            difference += std::pow(values[i] - truth[i], 2);
            norm += std::pow(truth[i], 2);
        }
        EXPECT_LT(std::sqrt(difference / norm), 0.06) << item;
    }
    const std::vector<std::string> before = shards(folder, "set");
    fs::remove(folder.file("set/shard-00001.json"));
    run(folder, recipe, "set");
    EXPECT_EQ(shards(folder, "set"), before);
}

TEST(Dataset, MeshesOfOtherContentAreAnotherDataSet) {
    const TemporaryFolder folder;
    fs::create_directories(folder.file("meshes/sub"));
    const auto write = [&](const char* bytes) {
        test_support::write_file_bytes(folder.file("meshes/sub/a.obj"), bytes);
    };
    write("v 0 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\n");
    const core::Json recipe =
        tiny_recipe({{"meshes", {{"folder", "meshes"}, {"shapes", core::Json::array()}}}});
    run(folder, recipe, "set");
    EXPECT_EQ(apps::MeshLibrary(read(folder, recipe)).name(0), "sub/a.obj");
    write("v 0 0 0\nv 3 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_ERROR_WITH(run(folder, recipe, "set"), "data set of another recipe");
}

TEST(Dataset, CanOnlyGrow) {
    const TemporaryFolder folder;
    run(folder, tiny_recipe(), "set");
    EXPECT_ERROR_WITH(run(folder, tiny_recipe({{"items", 5}}), "set"), "of 10 items");
    EXPECT_ERROR_WITH(run(folder, tiny_recipe(), "set", {}, ItemRange{8, 11}), "0 to 10");
    EXPECT_EQ(problems(folder, "set"), std::vector<std::string>{});
}

TEST(Dataset, IndexOfASetWithALostShardIsRefused) {
    const TemporaryFolder folder;
    run(folder, tiny_recipe(), "set");
    fs::remove(folder.file("set/shard-00001.h5"));
    EXPECT_EQ(apps::read_dataset(folder.file("set"), apps::ShardCheck::ManifestOnly).problems,
              std::vector<std::string>{"shard-00001.h5 is missing"});
    core::Json claim = core::read_json_file(folder.file("set/recipe.json"));
    for (const char* items : {"0", "-3", "1e18", "3.7", "\"x\""}) {
        claim["recipe"]["items"] = core::Json::parse(items);
        test_support::write_file_bytes(folder.file("set/recipe.json"), claim.dump());
        EXPECT_THROW(apps::read_dataset(folder.file("set"), apps::ShardCheck::ManifestOnly),
                     core::Error)
            << items;
    }
}

TEST(Dataset, RefusesTheFolderOfAnotherRecipe) {
    const TemporaryFolder folder;
    run(folder, tiny_recipe(), "set");
    EXPECT_ERROR_WITH(run(folder, tiny_recipe({{"seed", 9}}), "set"), "data set of another recipe");
}

TEST(Dataset, IndexNamesEveryShardAndIsRefusedWhileSomeAreMissing) {
    const TemporaryFolder folder;
    run(folder, tiny_recipe(), "set", {0, 2});
    const apps::DatasetIndex part =
        apps::read_dataset(folder.file("set"), apps::ShardCheck::ManifestOnly);
    EXPECT_EQ(part.problems, std::vector<std::string>{"shard-00001 is missing"});
    EXPECT_THROW(apps::write_index(part, folder.file("set")), core::Failure);
    run(folder, tiny_recipe(), "set", {1, 2});
    const std::string path = apps::write_index(
        apps::read_dataset(folder.file("set"), apps::ShardCheck::Contents), folder.file("set"));
    const core::Json index = core::read_json_file(path);
    std::uint64_t next = 0;
    for (const core::Json& shard : index["shards"]) {
        EXPECT_EQ(shard["items"][0], next);
        next = shard["items"][1];
        EXPECT_EQ(*apps::file_checksum(folder.file("set/" + shard["file"].get<std::string>())),
                  shard["xxh128"].get<std::string>());
    }
    EXPECT_EQ(next, 10u);
    std::size_t drawn = 0;
    for (const auto& count : index["drawn"]["scene.relay_wall.albedo"]["counts"]) {
        drawn += count.get<std::size_t>();
    }
    EXPECT_EQ(drawn, 10u);
}

TEST(Dataset, SkipsBrokenMeshesAndNamesThem) {
    const TemporaryFolder folder;
    fs::create_directory(folder.file("meshes"));
    const auto write = [&](const char* name, const std::string& bytes) {
        test_support::write_file_bytes(folder.file(std::string("meshes/") + name), bytes);
    };
    write("good.obj", "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n");
    write("no_faces.obj", "v 0 0 0\n");
    write("garbage.glb", std::string(1000, '\x7f'));
    write("empty.stl", "");
    write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    const core::Json recipe =
        tiny_recipe({{"meshes", {{"folder", "meshes"}, {"shapes", core::Json::array()}}}});
    const apps::GenerateResult result = run(folder, recipe, "set");
    EXPECT_EQ(result.items_written, 10u);
    EXPECT_GE(result.broken_meshes.size(), 3u);
    EXPECT_FALSE(result.broken_meshes.contains("good.obj"));
    for (const auto& [name, reason] : result.broken_meshes) EXPECT_FALSE(reason.empty()) << name;
    fs::remove(folder.file("meshes/good.obj"));
    EXPECT_ERROR_WITH(run(folder, recipe, "none"), "none can be used");
    EXPECT_FALSE(fs::exists(folder.file("none/recipe.json")));
}

TEST(Dataset, ARefusedRunLeavesTheFolderToAMendedRecipe) {
    const TemporaryFolder folder;
    EXPECT_ERROR_WITH(run(folder, tiny_recipe(), "set", {}, ItemRange{8, 11}), "0 to 10");
    EXPECT_FALSE(fs::exists(folder.file("set/recipe.json")));
    run(folder, tiny_recipe({{"seed", 9}}), "set");
    EXPECT_EQ(problems(folder, "set"), std::vector<std::string>{});
}

TEST(Dataset, PartsAreVerifiedByWhatWasAskedFor) {
    const TemporaryFolder folder;
    const auto read_part = [&](const apps::WantedItems& wanted) {
        return apps::read_dataset(folder.file("set"), apps::ShardCheck::Contents, wanted);
    };
    run(folder, tiny_recipe(), "set", {}, ItemRange{0, 2});
    const apps::DatasetIndex part = read_part(apps::AskedItems());
    EXPECT_EQ(part.problems, std::vector<std::string>{});
    EXPECT_EQ(part.wanted, 2u);
    EXPECT_EQ(part.items, 10u);
    EXPECT_FALSE(read_part(apps::AllItems()).problems.empty());
    EXPECT_EQ(read_part(ItemRange{1, 2}).problems, std::vector<std::string>{});
    EXPECT_FALSE(read_part(ItemRange{1, 9}).problems.empty());
    EXPECT_ERROR_WITH(read_part(ItemRange{1, 11}), "items: found 1 to 11; must lie within 0 to 10");
    test_support::write_file_bytes(folder.file("set/shard-00000.h5"), "damaged");
    EXPECT_FALSE(read_part(apps::AskedItems()).problems.empty());
    run(folder, tiny_recipe(), "set");
    EXPECT_EQ(read_part(apps::AskedItems()).wanted, 10u);
    fs::remove(folder.file("set/shard-00001.json"));
    EXPECT_FALSE(read_part(apps::AskedItems()).problems.empty());
}

TEST(Dataset, NamesWhatIsWrongOrMissing) {
    const TemporaryFolder folder;
    EXPECT_ERROR_WITH(run(folder, tiny_recipe({{"objects", {{"y_m", "far"}}}}), "x"),
                      "objects.y_m: found \"far\"; must be a number");
    EXPECT_ERROR_WITH(run(folder, tiny_recipe({{"meshes", {{"folder", "nowhere"}}}}), "x"),
                      "is no folder");
    EXPECT_ERROR_WITH(run(folder, tiny_recipe({{"meshes", {{"files", {"a.obj"}}}}}), "x"),
                      "is no file");
}

}  // namespace
