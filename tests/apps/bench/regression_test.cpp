// SPDX-License-Identifier: MIT
#include "apps/bench/regression.h"

#include "renderer/core/settings/json_file.h"

#include <gtest/gtest.h>

namespace apps {
namespace {

core::Json earlier_run() {
    return core::Json::parse(R"({
        "program": "nlos 1", "machine": "one",
        "curves": [
            {"method": "path", "slope": -0.5, "points": [
                {"effort": "samples=1", "cpu_seconds": 1.0, "rel_l2": 0.5},
                {"effort": "samples=4", "cpu_seconds": 4.0, "rel_l2": 0.25}]}],
        "scaling": [{"method": "lct", "of": "bins", "cpu_seconds": [1.0, 2.0]}],
        "rows": [{"name": "basin", "holds": true}, {"name": "tilt", "met": "no"}],
        "accuracies": [{"scene": "bars", "method": "lct", "mask_iou": 0.9}]})");
}

const BenchChange* change_of(const BenchRegression& against, const std::string& where) {
    for (const BenchChange& change : against.changes) {
        if (change.where == where) return &change;
    }
    return nullptr;
}

TEST(BenchRegression, ARunIsLikeItself) {
    const BenchRegression against = compare_benches(earlier_run(), earlier_run());
    EXPECT_TRUE(against.changes.empty());
    EXPECT_EQ(against.num_alike, 9);
    EXPECT_EQ(against.num_missing, 0);
    EXPECT_EQ(against.program, "nlos 1");
    EXPECT_EQ(against.machine, "one");
}

TEST(BenchRegression, NoiseIsNoChange) {
    core::Json now = earlier_run();
    now["curves"][0]["points"][0]["cpu_seconds"] = 1.2;
    now["curves"][0]["points"][0]["rel_l2"] = 0.46;
    now["curves"][0]["slope"] = -5.0;  // says nothing about how good a run is
    EXPECT_TRUE(compare_benches(earlier_run(), now).changes.empty());
}

TEST(BenchRegression, SaysWhatGotWorseAndWhatBetter) {
    core::Json now = earlier_run();
    now["curves"][0]["points"][0]["cpu_seconds"] = 1.5;
    now["curves"][0]["points"][1]["rel_l2"] = 0.1;
    now["scaling"][0]["cpu_seconds"][1] = 8.0;
    now["rows"][0]["holds"] = false;
    now["rows"][1]["met"] = "yes";
    now["accuracies"][0]["mask_iou"] = 0.8;
    const BenchRegression against = compare_benches(earlier_run(), now);
    ASSERT_EQ(against.changes.size(), 6U);
    const BenchChange* slower = change_of(against, "curves/path/points/samples=1");
    ASSERT_NE(slower, nullptr);
    EXPECT_TRUE(slower->is_worse);
    EXPECT_TRUE(change_of(against, "scaling/lct/bins/1")->is_worse);
    EXPECT_TRUE(change_of(against, "rows/basin")->is_worse);
    EXPECT_FALSE(change_of(against, "rows/tilt")->is_worse);
    EXPECT_TRUE(change_of(against, "accuracies/bars/lct")->is_worse);
    for (std::size_t i = 0; i < against.changes.size(); ++i) {
        EXPECT_EQ(against.changes[i].is_worse, i < 4) << "worse ones come first";
    }
}

TEST(BenchRegression, RowsAreFoundByNameWhereverTheyStand) {
    core::Json now = earlier_run();
    std::swap(now["curves"][0]["points"][0], now["curves"][0]["points"][1]);
    EXPECT_TRUE(compare_benches(earlier_run(), now).changes.empty());
    now["curves"][0]["points"][0]["effort"] = "samples=16";
    const BenchRegression against = compare_benches(earlier_run(), now);
    EXPECT_TRUE(against.changes.empty());
    EXPECT_EQ(against.num_missing, 1);
}

}  // namespace
}  // namespace apps
