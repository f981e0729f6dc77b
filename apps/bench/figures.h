// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings.h"

/// Lists the fields of a benchmark's row, once, under their own names: core::write_value() makes
/// JSON of them, and tables.h makes tables of that. Stands after the struct, in its namespace.
/// What each field means stands beside the field.
#define NLOS_FIGURES(Row, ...)                                              \
    template <class Visitor>                                                \
    void for_each_field(Row& row, Visitor&& visit) {                        \
        NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(NLOS_FIGURE, __VA_ARGS__)) \
    }                                                                       \
    static_assert(true) /* takes the semicolon */
#define NLOS_FIGURE(field) visit(#field, row.field, "");
