// SPDX-License-Identifier: MIT
#include "nlos/containers/stored_array.h"
#include "renderer/core/error.h"
#include "renderer/core/file_suffix.h"
#include "renderer/core/mapped_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <filesystem>

namespace nlos {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::string_view trim(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

/// The character between cells: the first of these that stands in the line; a blank for any number
/// of blanks.
char separator_of(std::string_view line) {
    for (const char candidate : {';', ',', '\t'}) {
        if (line.find(candidate) != std::string_view::npos) return candidate;
    }
    return ' ';
}

std::vector<std::string_view> split(std::string_view line, char separator) {
    std::vector<std::string_view> cells;
    line = trim(line);
    if (line.ends_with(separator)) line.remove_suffix(1);
    while (true) {
        const std::size_t end =
            separator == ' ' ? line.find_first_of(kBlanks) : line.find(separator);
        cells.push_back(trim(line.substr(0, end)));
        if (end == std::string_view::npos) return cells;
        line.remove_prefix(end + 1);
        if (separator == ' ') line = trim(line);
    }
}

std::optional<double> number_in(std::string_view cell) {
    if (cell.starts_with('+')) cell.remove_prefix(1);
    double value = 0.0;
    const char* end = cell.data() + cell.size();
    const auto [after, error] = std::from_chars(cell.data(), end, value);
    if (error != std::errc() || after != end) return std::nullopt;
    return value;
}

std::string_view unquote(std::string_view cell) {
    const bool is_quoted = cell.size() >= 2 && cell.front() == '"' && cell.back() == '"';
    return is_quoted ? cell.substr(1, cell.size() - 2) : cell;
}

/// A table of numbers as text: one row per line, cells separated by commas, semicolons, tabs or
/// blanks. The first line may name the columns; lines that start with # or % are comments. Arrays:
/// "table" (rows, columns), and each named column (rows,).
class CsvFile : public StoredArrayFile {
 public:
    explicit CsvFile(const std::string& path) : path_(path) {
        const core::MappedFile file(path);
        std::string_view text = file.bytes();
        constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
        if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
        for (std::size_t number = 1; !text.empty(); ++number) {
            const std::size_t end = std::min(text.find('\n'), text.size());
            read_line(text.substr(0, end), number);
            text.remove_prefix(std::min(end + 1, text.size()));
        }
        if (values_.empty())
            throw core::Error(path, "holds no numbers", "must be a table of numbers");
        add_columns();
    }

    std::string container() const override { return "csv"; }

 private:
    void read_line(std::string_view line, std::size_t number) {
        const std::string_view content = trim(line);
        if (content.empty() || content.front() == '#' || content.front() == '%') return;
        if (num_columns_ == 0) separator_ = separator_of(content);
        const std::vector<std::string_view> cells = split(content, separator_);
        if (num_columns_ == 0) {
            num_columns_ = cells.size();
            if (!number_in(cells.front())) {
                for (const std::string_view cell : cells) names_.emplace_back(unquote(cell));
                return;
            }
        }
        const auto refuse = [&](const std::string& found, const std::string& allowed) {
            throw core::Error(fmt::format("{}: line {}", path_, number), found, allowed);
        };
        if (cells.size() != num_columns_) {
            refuse(fmt::format("has {} cells", cells.size()),
                   fmt::format("must have {}, as the first line", num_columns_));
        }
        for (const std::string_view cell : cells) {
            const std::optional<double> value = number_in(cell);
            if (!value) refuse(fmt::format("found '{}'", cell.substr(0, 40)), "must be a number");
            values_.push_back(*value);
        }
    }

    void add_columns() {
        const std::size_t rows = values_.size() / num_columns_;
        for (std::size_t column = 0; column < names_.size() && !is_full(); ++column) {
            std::vector<double> values(rows);
            for (std::size_t row = 0; row < rows; ++row) {
                values[row] = values_[row * num_columns_ + column];
            }
            add_values(names_[column], {rows}, std::move(values), ElementKind::Real, "number");
        }
        add_values("table", {rows, num_columns_}, std::move(values_), ElementKind::Real, "number");
    }

    std::string path_;
    char separator_ = ' ';
    std::size_t num_columns_ = 0;
    std::vector<std::string> names_;
    std::vector<double> values_;
};

/// Text of which nothing but its suffix says that it is a table.
bool is_csv_file(const std::string& path) {
    const std::string suffix = core::file_suffix(path);
    if (suffix != ".csv" && suffix != ".tsv" && suffix != ".txt") return false;
    return core::first_bytes(path, 1024).find('\0') == std::string::npos;
}

}  // namespace

Container csv_container() {
    return {"CSV", is_csv_file, open_as<CsvFile>};
}

}  // namespace nlos
