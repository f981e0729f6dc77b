// SPDX-License-Identifier: MIT
#include "apps/tables/tables.h"

#include "renderer/core/settings/json_file.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace apps {
namespace {

using core::Json;
using Cells = std::vector<std::pair<std::string, std::string>>;  // column and text

constexpr std::size_t kMaxListed = 8;  // numbers in a cell

bool has_rows(const Json& value) {
    return value.is_array() && !value.empty() && value.front().is_object();
}

std::string text_of(const Json& value) {
    if (value.is_null()) return "";
    if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
    if (value.is_number_float()) return fmt::format("{:.4g}", value.get<double>());
    if (value.is_string()) return core::printable(value.get<std::string>());
    if (!value.is_array()) return value.dump();
    if (value.size() > kMaxListed) return "";
    std::vector<std::string> texts;
    for (const Json& item : value) texts.push_back(text_of(item));
    return fmt::format("{}", fmt::join(texts, ", "));
}

// The rows that one object stands for, each with the cells of what is around it.
void expand(const Json& object, const std::string& prefix, Cells cells, std::vector<Cells>& rows) {
    for (const auto& [key, value] : object.items()) {
        if (!has_rows(value)) cells.emplace_back(prefix + key, text_of(value));
    }
    bool is_leaf = true;
    for (const auto& [key, value] : object.items()) {
        if (!has_rows(value)) continue;
        is_leaf = false;
        for (const Json& inner : value) {
            // Only names that would meet need to say whose they are.
            const auto meets = [&](const auto& cell) { return inner.contains(cell.first); };
            const bool is_ambiguous = std::any_of(cells.begin(), cells.end(), meets);
            expand(inner, is_ambiguous ? key + "." : "", cells, rows);
        }
    }
    if (is_leaf) rows.push_back(std::move(cells));
}

Table table_of(const std::string& name, const std::vector<Cells>& rows) {
    Table table{name, {}, {}};
    for (const Cells& row : rows) {
        for (const auto& [column, text] : row) {
            if (text.empty() || std::ranges::count(table.columns, column) > 0) continue;
            table.columns.push_back(column);
        }
    }
    for (const Cells& row : rows) {
        std::vector<std::string>& cells = table.rows.emplace_back(table.columns.size());
        for (const auto& [column, text] : row) {
            const auto found = std::ranges::find(table.columns, column);
            if (found == table.columns.end()) continue;
            cells[static_cast<std::size_t>(found - table.columns.begin())] = text;
        }
    }
    return table;
}

}  // namespace

std::vector<Table> tables_of(const Json& figures) {
    std::vector<Table> tables;
    Table alone{"", {"what", "value"}, {}};
    for (const auto& [key, value] : figures.items()) {
        if (has_rows(value)) {
            std::vector<Cells> rows;
            for (const Json& object : value) expand(object, "", {}, rows);
            tables.push_back(table_of(key, rows));
        } else if (const std::string text = value.is_object() ? "" : text_of(value);
                   !text.empty()) {
            alone.rows.push_back({key, text});
        }
    }
    if (!alone.rows.empty()) tables.insert(tables.begin(), std::move(alone));
    return tables;
}

std::string plain_text(const std::vector<Table>& tables) {
    std::string text;
    for (const Table& table : tables) {
        std::vector<std::size_t> widths;
        for (std::size_t c = 0; c < table.columns.size(); ++c) {
            widths.push_back(table.columns[c].size());
            for (const auto& row : table.rows) widths[c] = std::max(widths[c], row[c].size());
        }
        const auto add_row = [&](const std::vector<std::string>& cells) {
            std::string line;
            for (std::size_t c = 0; c < cells.size(); ++c) {
                line += fmt::format("{:<{}}", cells[c], widths[c] + 2);
            }
            text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
        };
        if (!table.name.empty()) text += table.name + "\n";
        add_row(table.columns);
        for (const auto& row : table.rows) add_row(row);
        text += "\n";
    }
    return text;
}

std::string markdown(const std::vector<Table>& tables, std::size_t max_rows) {
    std::string text;
    for (const Table& table : tables) {
        if (!table.name.empty()) text += fmt::format("### {}\n\n", table.name);
        if (table.rows.size() > max_rows) {
            text += fmt::format("{} rows, in the JSON file.\n\n", table.rows.size());
            continue;
        }
        const auto add_row = [&](std::vector<std::string> cells) {
            for (std::string& cell : cells) {
                for (std::size_t i = 0; (i = cell.find('|', i)) != std::string::npos; i += 2) {
                    cell.insert(i, "\\");
                }
            }
            text += fmt::format("| {} |\n", fmt::join(cells, " | "));
        };
        add_row(table.columns);
        text += "|";
        for (std::size_t c = 0; c < table.columns.size(); ++c) text += "---|";
        text += "\n";
        for (const auto& row : table.rows) add_row(row);
        text += "\n";
    }
    return text;
}

}  // namespace apps
