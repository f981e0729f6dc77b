// SPDX-License-Identifier: MIT
#include "nlos/containers/npy_array.h"

#include "nlos/containers/unicode_text.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <charconv>

namespace nlos {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";

/// The dictionary of a header, a literal of Python: {'descr': '<f4', 'shape': (3, 4), ...}.
class HeaderText {
 public:
    HeaderText(std::string_view text, const std::string& where) : text_(text), where_(where) {}

    char next() {
        const std::size_t begin = text_.find_first_not_of(" \t\n\r");
        if (begin == std::string_view::npos) damaged();
        text_.remove_prefix(begin);
        return text_.front();
    }
    bool skip(char wanted) {
        if (next() != wanted) return false;
        text_.remove_prefix(1);
        return true;
    }
    void expect(char wanted) {
        if (!skip(wanted)) damaged();
    }
    std::string_view take_quoted() {
        const char quote = next();
        const std::size_t end = text_.find(quote, 1);
        if ((quote != '\'' && quote != '"') || end == std::string_view::npos) damaged();
        const std::string_view quoted = text_.substr(1, end - 1);
        text_.remove_prefix(end + 1);
        return quoted;
    }
    bool take_bool() {
        for (const std::string_view word : {"True", "False"}) {
            next();
            if (!text_.starts_with(word)) continue;
            text_.remove_prefix(word.size());
            return word == "True";
        }
        damaged();
    }
    Shape take_shape() {
        constexpr std::size_t kHighestRank = 64;
        Shape shape;
        expect('(');
        while (!skip(')')) {
            const std::size_t end = text_.find_first_not_of("0123456789");
            std::size_t extent = 0;
            if (end == 0 || end == std::string_view::npos || shape.size() == kHighestRank ||
                std::from_chars(text_.data(), text_.data() + end, extent).ec != std::errc()) {
                damaged();
            }
            text_.remove_prefix(end);
            shape.push_back(extent);
            skip('L');  // as Python 2 writes long numbers
            skip(',');
        }
        return shape;
    }
    /// Skips a list, whatever is in it: the fields of a structured type.
    void skip_list() {
        std::size_t depth = 0;
        do {
            const char found = next();
            if (found == '\'' || found == '"') {
                take_quoted();
                continue;
            }
            depth += found == '[' ? 1U : 0U;
            depth -= found == ']' ? 1U : 0U;
            text_.remove_prefix(1);
        } while (depth > 0);
    }
    [[noreturn]] void damaged() const {
        throw core::Error(where_, "has a damaged header", "must be a .npy array");
    }

 private:
    std::string_view text_;
    const std::string& where_;
};

/// The numbers of a kind of NumPy's ('i', 'u', 'f', 'b') with so many bytes.
std::optional<StoredNumber> number_of(char kind, std::uint64_t bytes) {
    if (kind == 'b' && bytes == 1) return StoredNumber::UInt8;
    for (int i = 0; i <= static_cast<int>(StoredNumber::Float64); ++i) {
        const auto number = static_cast<StoredNumber>(i);
        if (type_name(number)[0] == kind && bytes_of(number) == bytes) return number;
    }
    return std::nullopt;
}

/// Takes over a type such as "<f4": byte order, kind, bytes (of U: characters of 4 bytes).
void take_type(std::string_view descr, HeaderText& text, NpyHeader& header) {
    if (descr.size() < 2) text.damaged();
    const char kind = descr[1];
    StoredArray& array = header.array;
    array.order = descr[0] == '>' ? std::endian::big : std::endian::little;
    array.type = descr;
    header.is_pickle = kind == 'O';
    if (header.is_pickle) {
        array.type = "pickled objects";
        return;
    }
    const std::string_view digits = descr.substr(2);
    std::from_chars(digits.data(), digits.data() + digits.size(), header.value_bytes);
    if (const auto number = number_of(kind, header.value_bytes)) {
        array.kind.reset();
        array.number = *number;
        array.type = kind == 'b' ? "bool" : "";
    } else if (kind == 'S' || kind == 'U') {
        array.kind = ElementKind::Text;
        array.type = "text";
        header.unit_bytes = kind == 'U' ? 4 : 1;
        header.value_bytes *= header.unit_bytes;
    } else if (kind == 'c') {
        array.type = fmt::format("complex float{}", 4 * header.value_bytes);
    }
}

void take_dictionary(HeaderText& text, NpyHeader& header) {
    text.expect('{');
    while (!text.skip('}')) {
        const std::string_view key = text.take_quoted();
        text.expect(':');
        if (key == "descr" && text.next() == '[') {
            header.array.type = "structured";
            text.skip_list();
        } else if (key == "descr") {
            take_type(text.take_quoted(), text, header);
        } else if (key == "fortran_order") {
            header.array.first_axis_fastest = text.take_bool();
        } else if (key == "shape") {
            header.array.shape = text.take_shape();
        } else {
            text.damaged();
        }
        text.skip(',');
    }
}

}  // namespace

bool is_npy(std::string_view bytes) {
    return bytes.starts_with(kMagic);
}

NpyHeader parse_npy_header(std::string_view start,
                           std::uint64_t num_bytes,
                           const std::string& where) {
    constexpr std::size_t kVersionAt = 6;
    constexpr std::size_t kLengthAt = 8;
    const std::size_t length_bytes = start.size() > kVersionAt && start[kVersionAt] == 1 ? 2 : 4;
    const std::size_t begin = kLengthAt + length_bytes;
    if (!is_npy(start) || start.size() < begin) HeaderText("", where).damaged();
    const auto length = static_cast<std::size_t>(
        number_at(start.data() + kLengthAt,
                  length_bytes == 2 ? StoredNumber::UInt16 : StoredNumber::UInt32,
                  std::endian::little));
    if (length > start.size() - begin) HeaderText("", where).damaged();
    NpyHeader header;
    header.array.kind = ElementKind::Other;  // until its type says more
    header.data_begin = begin + length;
    HeaderText text(start.substr(begin, length), where);
    take_dictionary(text, header);
    const std::uint64_t stored = num_bytes - header.data_begin;
    const bool has_size = header.array.kind != ElementKind::Other;
    if (has_size && total_bytes(header.array.shape, header.value_bytes) > stored) {
        throw core::Error(where,
                          fmt::format("claims shape {} but only {} bytes are stored",
                                      shape_text(header.array.shape),
                                      stored),
                          "must be complete");
    }
    return header;
}

ArrayDescription describe_npy(const NpyHeader& header, std::string_view data) {
    ArrayDescription description = describe_stored(header.array);
    const bool is_text = header.array.kind == ElementKind::Text;
    if (!is_text || total_bytes(header.array.shape, 1) != 1) return description;
    std::string text = utf8_text(
        data.data(), header.value_bytes / header.unit_bytes, header.unit_bytes, header.array.order);
    text.resize(std::min(text.find('\0'), text.size()));
    description.text = std::move(text);
    return description;
}

}  // namespace nlos
