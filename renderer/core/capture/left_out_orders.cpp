// SPDX-License-Identifier: MIT
#include "renderer/core/capture/left_out_orders.h"

#include "renderer/core/settings/json_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>

namespace core {

std::optional<LeftOutOrders> widest(const std::optional<LeftOutOrders>& a,
                                    const std::optional<LeftOutOrders>& b) {
    if (!a || !b) return a ? a : b;
    return LeftOutOrders{std::min(a->first, b->first),
                         std::max(a->last, b->last),
                         std::max(a->error, b->error),
                         std::max(a->share, b->share)};
}

std::string describe(const LeftOutOrders& orders) {
    const std::string which = orders.first == orders.last
                                  ? fmt::format("order {}", orders.first)
                                  : fmt::format("orders {} to {}", orders.first, orders.last);
    return fmt::format("{}, some {:.2g} % of the light", which, 100.0 * orders.share);
}

std::optional<LeftOutOrders> recorded_left_out_orders(const Capture& capture) {
    // Provenance comes from anywhere: what is no object of ours counts as nothing.
    if (!capture.scene_info->is_object()) return std::nullopt;
    const auto found = capture.scene_info->find(kLeftOutOrdersKey);
    if (found == capture.scene_info->end() || !found->is_object()) return std::nullopt;
    constexpr double kMost = 1e6;
    LeftOutOrders orders;
    bool is_whole = true;
    for_each_field(orders, [&](const char* name, auto& field, const char*) {
        const auto value = found->find(name);
        const double number =
            value != found->end() && value->is_number() ? value->get<double>() : -1.0;
        is_whole = is_whole && number >= 0.0 && number <= kMost;
        if (is_whole) field = static_cast<std::remove_reference_t<decltype(field)>>(number);
    });
    return is_whole ? std::optional(orders) : std::nullopt;
}

}  // namespace core
