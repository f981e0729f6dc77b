// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/core/settings/settings.h"

#include <optional>
#include <string>

namespace core {

/// Bounce orders that a render did not compute, since the error it was to reach allowed that.
struct LeftOutOrders {
    int first = 0;
    int last = 0;
    double error =
        0.0;  ///< relative L2 over all of H that this costs: two sigma above the estimate
    double share = 0.0;  ///< of the light in H that they hold, estimated
};

template <class Visitor>
void for_each_field(LeftOutOrders& s, Visitor&& visit) {
    visit("first", s.first, "order that is left out");
    visit("last", s.last, "order that was asked for");
    visit("error", s.error, "that this costs, relative L2 over all of H");
    visit("share", s.share, "of the light that these orders hold");
}

/// What a capture's provenance has it under.
inline constexpr const char* kLeftOutOrdersKey = "orders_left_out";

/// Of two parts of a render, all that either leaves out, at the larger cost.
std::optional<LeftOutOrders> widest(const std::optional<LeftOutOrders>& a,
                                    const std::optional<LeftOutOrders>& b);

/// In words: "orders 4 to 5, some 1.9 % of the light".
std::string describe(const LeftOutOrders& orders);

/// The orders that a capture's provenance says it lacks; nothing when it says nothing of the kind.
std::optional<LeftOutOrders> recorded_left_out_orders(const Capture& capture);

}  // namespace core
