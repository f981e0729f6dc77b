// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_fwd.h"

#include <string>
#include <vector>

namespace apps {

/// A table of a benchmark's figures.
struct Table {
    std::string name;  ///< of the list of rows in the JSON file
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;  ///< as many cells as there are columns
};

/// The tables in what a benchmark found: one for the values that stand alone, one for every list
/// of rows. Where rows hold rows of their own, these become the table's rows, each with the values
/// of the row around it. Columns without any value, and long lists of numbers, are left out.
std::vector<Table> tables_of(const core::Json& figures);

/// Tables for a terminal, columns aligned.
std::string plain_text(const std::vector<Table>& tables);

/// Tables as Markdown; those of more than `max_rows` rows are named and left to the JSON file.
std::string markdown(const std::vector<Table>& tables, std::size_t max_rows);

}  // namespace apps
