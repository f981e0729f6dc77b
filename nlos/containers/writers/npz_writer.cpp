// SPDX-License-Identifier: MIT
#include "nlos/containers/writers/npz_writer.h"

#include "nlos/containers/writers/zip_target.h"
#include "renderer/core/error.h"

#include <fmt/core.h>
#include <zip.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdlib>
#include <cstring>

namespace nlos {
namespace {

static_assert(std::endian::native == std::endian::little, "members are written as they lie here");

/// The beginning of a .npy file: magic, version 1.0, length of what follows, and a Python
/// dictionary padded so that values begin at a multiple of 64 bytes.
///
/// type   of the values, for example <f4
std::string npy_header(const std::string& type, const Shape& shape) {
    constexpr std::size_t kAlignment = 64;
    constexpr std::size_t kPreambleBytes = 10;
    std::string extents;
    for (const std::size_t extent : shape) extents += fmt::format("{}, ", extent);
    std::string dictionary =
        fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, extents);
    const std::size_t used = kPreambleBytes + dictionary.size() + 1;
    dictionary.append((kAlignment - used % kAlignment) % kAlignment, ' ');
    dictionary += '\n';
    std::string header("\x93NUMPY\x01\x00", 8);
    header += static_cast<char>(dictionary.size() & 0xff);
    header += static_cast<char>(dictionary.size() >> 8);
    return header + dictionary;
}

/// How NumPy names a type: byte order, kind and bytes.
std::string npy_type(StoredNumber number) {
    const std::size_t bytes = bytes_of(number);
    const std::string name = type_name(number);
    const char kind = name[0];  // of int, uint and float
    return fmt::format("{}{}{}", bytes == 1 ? '|' : '<', kind, bytes);
}

template <class T>
std::string to_bytes(std::span<const T> values) {
    return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

/// The characters of a UTF-8 text as NumPy stores them, four bytes each.
std::u32string to_characters(const std::string& text) {
    std::u32string characters;
    for (std::size_t i = 0; i < text.size();) {
        const auto lead = static_cast<unsigned char>(text[i]);
        const std::size_t length = lead < 0x80 ? 1 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
        char32_t character = length == 1 ? lead : lead & (0x7fU >> length);
        for (std::size_t k = 1; k < length && i + k < text.size(); ++k) {
            character = character << 6U | (static_cast<unsigned char>(text[i + k]) & 0x3fU);
        }
        characters += character;
        i += length;
    }
    return characters;
}

/// A .npy member that is made while the archive is written: its header, then row after row.
class RowMember {
 public:
    RowMember(const Shape& shape, NpzWriter::Fill fill)
        : fill_(std::move(fill)),
          header_(npy_header("<f4", shape)),
          rows_(shape.at(0)),
          row_values_(values_per_row(shape)) {
        zip_error_init(&error_);
    }
    ~RowMember() { zip_error_fini(&error_); }
    RowMember(const RowMember&) = delete;
    RowMember& operator=(const RowMember&) = delete;

    /// What libzip asks of a source, see zip_source_function(3).
    static zip_int64_t answer(void* state,
                              void* data,
                              zip_uint64_t size,
                              zip_source_cmd_t command) {
        auto* member = static_cast<RowMember*>(state);
        switch (command) {
            case ZIP_SOURCE_OPEN:
                return member->rewind();
            case ZIP_SOURCE_READ:
                return member->read(static_cast<char*>(data), size);
            case ZIP_SOURCE_CLOSE:
                return 0;
            case ZIP_SOURCE_STAT:
                return member->describe(*static_cast<zip_stat_t*>(data));
            case ZIP_SOURCE_ERROR:
                return zip_error_to_data(&member->error_, data, size);
            case ZIP_SOURCE_FREE:
                delete member;
                return 0;
            default:
                return zip_source_make_command_bitmap(ZIP_SOURCE_OPEN,
                                                      ZIP_SOURCE_READ,
                                                      ZIP_SOURCE_CLOSE,
                                                      ZIP_SOURCE_STAT,
                                                      ZIP_SOURCE_ERROR,
                                                      ZIP_SOURCE_FREE,
                                                      -1);
        }
    }

 private:
    zip_int64_t rewind() {
        bytes_ = header_;
        used_ = 0;
        next_row_ = 0;
        return 0;
    }

    zip_int64_t describe(zip_stat_t& stat) const {
        zip_stat_init(&stat);
        stat.size = header_.size() + rows_ * row_values_ * sizeof(float);
        stat.valid = ZIP_STAT_SIZE;
        return sizeof(stat);
    }

    zip_int64_t read(char* data, zip_uint64_t size) {
        std::size_t written = 0;
        while (written < size && (used_ < bytes_.size() || next_row_ < rows_)) {
            if (used_ == bytes_.size()) make_rows();
            const std::size_t count = std::min<std::size_t>(size - written, bytes_.size() - used_);
            std::memcpy(data + written, bytes_.data() + used_, count);
            used_ += count;
            written += count;
        }
        return static_cast<zip_int64_t>(written);
    }

    void make_rows() {
        constexpr std::size_t kValuesAtOnce = std::size_t{1} << 20;
        const std::size_t step = std::max<std::size_t>(1, kValuesAtOnce / row_values_);
        const std::size_t count = std::min(step, rows_ - next_row_);
        std::vector<float> values(count * row_values_);
        fill_(next_row_, count, values);
        bytes_ = to_bytes<float>(values);
        used_ = 0;
        next_row_ += count;
    }

    NpzWriter::Fill fill_;
    std::string header_;
    std::size_t rows_;
    std::size_t row_values_;
    std::string bytes_;     ///< made and not all read
    std::size_t used_ = 0;  ///< how many of them were read
    std::size_t next_row_ = 0;
    zip_error_t error_{};
};

}  // namespace

NpzWriter::NpzWriter(std::string target)
    : target_(std::move(target)), output_(std::in_place, target_), archive_(nullptr, zip_discard) {
    zip_source_t* file = zip_target(output_->temporary());
    check(file != nullptr);
    archive_.reset(zip_open_from_source(file, ZIP_TRUNCATE, nullptr));
    if (archive_ == nullptr) zip_source_free(file);
    check(archive_ != nullptr);
}

NpzWriter::NpzWriter()
    : target_("archive in memory"),
      memory_(zip_source_buffer_create(nullptr, 0, 0, nullptr)),
      archive_(nullptr, zip_discard) {
    check(memory_ != nullptr);
    zip_source_keep(memory_);
    archive_.reset(zip_open_from_source(memory_, ZIP_TRUNCATE, nullptr));
    check(archive_ != nullptr);
}

NpzWriter::~NpzWriter() {
    archive_.reset();
    if (memory_ != nullptr) zip_source_free(memory_);
}

void NpzWriter::check(bool ok) const {
    if (!ok) throw core::Failure(target_, "cannot be written (disk full?)");
}

void NpzWriter::write(const std::string& name, const Shape& shape, std::span<const double> values) {
    assert(values.size() == total_bytes(shape, 1));
    add_member(name, npy_header("<f8", shape), to_bytes(values));
}

void NpzWriter::write(const std::string& name, const Shape& shape, std::span<const int> values) {
    assert(values.size() == total_bytes(shape, 1));
    add_member(name, npy_header("<i4", shape), to_bytes(values));
}

void NpzWriter::write_numbers(const std::string& name,
                              StoredNumber number,
                              const Shape& shape,
                              const std::string& bytes) {
    assert(bytes.size() == total_bytes(shape, 1) * bytes_of(number));
    add_member(name, npy_header(npy_type(number), shape), bytes);
}

void NpzWriter::write_real(const std::string& name, double value) {
    write(name, {}, std::span<const double>{&value, 1});
}

void NpzWriter::write_text(const std::string& name, const std::string& text) {
    std::u32string characters = to_characters(text);
    if (characters.empty()) characters.resize(1);  // NumPy has no text of no length
    add_member(name,
               npy_header(fmt::format("<U{}", characters.size()), {}),
               to_bytes<char32_t>(characters));
}

void NpzWriter::write_rows(const std::string& name, const Shape& shape, Fill fill) {
    auto member = std::make_unique<RowMember>(shape, std::move(fill));
    zip_source_t* source = zip_source_function(archive_.get(), RowMember::answer, member.get());
    check(source != nullptr);
    static_cast<void>(member.release());  // libzip frees it
    add_source(name, source);
}

void NpzWriter::add_member(const std::string& name, const std::string& header, std::string bytes) {
    bytes.insert(0, header);
    void* copy = std::malloc(bytes.size());  // libzip frees it
    check(copy != nullptr);
    std::memcpy(copy, bytes.data(), bytes.size());
    zip_source_t* source = zip_source_buffer(archive_.get(), copy, bytes.size(), 1);
    if (source == nullptr) std::free(copy);
    check(source != nullptr);
    add_source(name, source);
}

void NpzWriter::add_source(const std::string& name, zip_source_t* source) {
    const zip_int64_t index =
        zip_file_add(archive_.get(), (name + ".npy").c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) zip_source_free(source);
    check(index >= 0);
    const auto member = static_cast<zip_uint64_t>(index);
    // The weakest level: the noise of rendered and measured histograms gains little from more.
    check(zip_set_file_compression(archive_.get(), member, ZIP_CM_DEFLATE, 1) == 0);
    constexpr zip_uint16_t kFirstOfJanuary1980 = 0x21;
    check(zip_file_set_dostime(archive_.get(), member, 0, kFirstOfJanuary1980, 0) == 0);
}

void NpzWriter::close() {
    check(zip_close(archive_.get()) == 0);
    static_cast<void>(archive_.release());  // closed
}

void NpzWriter::finish() {
    close();
    output_->commit();
}

std::string NpzWriter::finish_in_memory() {
    close();
    zip_stat_t stat;
    zip_stat_init(&stat);
    check(zip_source_stat(memory_, &stat) == 0 && zip_source_open(memory_) == 0);
    std::string bytes(stat.size, '\0');
    const zip_int64_t read = zip_source_read(memory_, bytes.data(), bytes.size());
    zip_source_close(memory_);
    check(read == static_cast<zip_int64_t>(bytes.size()));
    return bytes;
}

}  // namespace nlos
