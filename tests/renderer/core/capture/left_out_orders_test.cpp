// SPDX-License-Identifier: MIT
#include "renderer/core/capture/left_out_orders.h"

#include "renderer/core/settings/settings_json.h"

#include <gtest/gtest.h>

namespace {

const core::Json kRecorded = {{"first", 4}, {"last", 5}, {"error", 0.01}, {"share", 0.02}};

std::optional<core::LeftOutOrders> read_back(const core::Json& recorded) {
    core::Capture capture;
    capture.scene_info[core::kLeftOutOrdersKey] = recorded;
    return core::recorded_left_out_orders(capture);
}

TEST(LeftOutOrders, AreReadBackFromProvenance) {
    const auto orders = read_back(kRecorded);
    ASSERT_TRUE(orders);
    EXPECT_EQ(core::write_value(*orders), kRecorded);
    EXPECT_EQ(core::describe(*orders), "orders 4 to 5, some 2 % of the light");
    EXPECT_EQ(core::describe(core::LeftOutOrders{6, 6, 0.1, 0.0123}),
              "order 6, some 1.2 % of the light");
}

TEST(LeftOutOrders, ForeignProvenanceCountsAsNothing) {
    EXPECT_FALSE(core::recorded_left_out_orders({}));
    for (const core::Json& foreign :
         {core::Json(nullptr), core::Json("all"), core::Json{4, 5}, core::Json{{"first", 4}}}) {
        EXPECT_FALSE(read_back(foreign)) << foreign;
    }
    for (const core::Json& number : {core::Json(-1), core::Json(1e300), core::Json("4")}) {
        core::Json changed = kRecorded;
        changed["last"] = number;
        EXPECT_FALSE(read_back(changed)) << changed;
    }
}

TEST(LeftOutOrders, OfPartsTheWidestCounts) {
    const core::LeftOutOrders few{6, 8, 0.01, 0.03};
    const core::LeftOutOrders many{4, 8, 0.02, 0.01};
    EXPECT_FALSE(core::widest({}, {}));
    EXPECT_EQ(core::write_value(core::widest(few, {})), core::write_value(few));
    EXPECT_EQ(core::write_value(core::widest({}, few)), core::write_value(few));
    EXPECT_EQ(core::write_value(core::widest(few, many)),
              core::write_value(core::LeftOutOrders{4, 8, 0.02, 0.03}));
}

}  // namespace
