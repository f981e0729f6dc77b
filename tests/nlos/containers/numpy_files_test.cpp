// SPDX-License-Identifier: MIT
#include "nlos/containers/array_reader.h"
#include "tests/nlos/containers/example_bytes.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using test_support::TemporaryFolder;

class NpyOf {
 public:
    explicit NpyOf(const std::string& bytes) {
        test_support::write_file_bytes(folder_.file("a.npy"), bytes);
    }
    ArrayReader open() const { return ArrayReader(folder_.file("a.npy")); }
    std::vector<double> read(const Shape& shape) const {
        return open().read_doubles("array", shape);
    }

 private:
    TemporaryFolder folder_;
};

/// The bytes of values in the other byte order than this machine's.
template <class T>
std::string swapped(const std::vector<T>& values) {
    std::string bytes = bytes_of_values(values);
    for (std::size_t i = 0; i < bytes.size(); i += sizeof(T)) {
        std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                     bytes.begin() + static_cast<std::ptrdiff_t>(i + sizeof(T)));
    }
    return bytes;
}

template <class T>
void expect_both_orders(const std::string& code) {
    const std::vector<T> values{T{1}, T{2}, static_cast<T>(-3)};
    const std::vector<double> wanted(values.begin(), values.end());
    EXPECT_EQ(NpyOf(npy_bytes("'<" + code + "'", "(3,)", bytes_of_values(values))).read({3}),
              wanted);
    EXPECT_EQ(NpyOf(npy_bytes("'>" + code + "'", "(3,)", swapped(values))).read({3}), wanted);
}

TEST(NpyFile, NumbersOfEveryTypeAndByteOrderAreRead) {
    expect_both_orders<std::int8_t>("i1");
    expect_both_orders<std::int16_t>("i2");
    expect_both_orders<std::int32_t>("i4");
    expect_both_orders<std::int64_t>("i8");
    expect_both_orders<std::uint8_t>("u1");
    expect_both_orders<std::uint16_t>("u2");
    expect_both_orders<std::uint32_t>("u4");
    expect_both_orders<std::uint64_t>("u8");
    expect_both_orders<float>("f4");
    expect_both_orders<double>("f8");
    EXPECT_EQ(NpyOf(npy_bytes("'|b1'", "(2,)", std::string("\x01\x00", 2))).open().type("array"),
              "bool");
}

TEST(NpyFile, HalvesAreExact) {
    // 1, -2, the largest, the smallest above 0, the smallest normal one, infinity.
    const std::vector<std::uint16_t> bits{0x3c00, 0xc000, 0x7bff, 0x0001, 0x0400, 0x7c00};
    const std::vector<double> wanted{
        1.0, -2.0, 65504.0, std::ldexp(1.0, -24), std::ldexp(1.0, -14), HUGE_VAL};
    EXPECT_EQ(NpyOf(npy_bytes("'<f2'", "(6,)", bytes_of_values(bits))).read({6}), wanted);
    EXPECT_TRUE(std::isnan(
        NpyOf(npy_bytes("'<f2'", "()", bytes_of_values<std::uint16_t>({0x7e00}))).read({})[0]));
}

TEST(NpyFile, ArraysInTheOrderOfFortranHaveTheSameShapeAndValues) {
    // array[i][j][k] = 100 i + 10 j + k of shape (2, 3, 2).
    std::vector<std::int16_t> stored;
    std::vector<double> wanted;
    for (int k = 0; k < 2; ++k) {
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < 2; ++i)
                stored.push_back(static_cast<std::int16_t>(100 * i + 10 * j + k));
        }
    }
    for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 3; ++j) {
            for (int k = 0; k < 2; ++k) wanted.push_back(100 * i + 10 * j + k);
        }
    }
    const NpyOf file(npy_bytes("'<i2'", "(2, 3, 2)", bytes_of_values(stored), "True"));
    EXPECT_FALSE(file.open().first_index_fastest());
    EXPECT_EQ(file.read({2, 3, 2}), wanted);
    std::vector<float> rows;
    file.open().read_rows("array", [&](std::size_t, std::size_t, const std::vector<float>& values) {
        rows.insert(rows.end(), values.begin(), values.end());
    });
    EXPECT_EQ(std::vector<double>(rows.begin(), rows.end()), wanted);
}

TEST(NpyFile, ArraysWithoutValuesHaveNoRowsHoweverManyTheyClaim) {
    for (const char* fortran_order : {"False", "True"}) {
        const NpyOf rows(npy_bytes("'<i2'", "(4611686018427387904, 0)", "", fortran_order));
        rows.open().read_rows("array",
                              [](std::size_t, std::size_t, const std::vector<float>&) { FAIL(); });
        EXPECT_TRUE(rows.read({std::size_t{1} << 62, 0}).empty());
        const NpyOf columns(npy_bytes("'<i2'", "(0, 4611686018427387904)", "", fortran_order));
        EXPECT_TRUE(columns.read({0, std::size_t{1} << 62}).empty());
    }
}

TEST(NpyFile, TextsAreReadAndOtherContentIsRefused) {
    EXPECT_EQ(NpyOf(npy_bytes("'>U2'", "()", swapped<std::uint32_t>({0x1f600, 'x'})))
                  .open()
                  .read_text("array"),
              "\U0001f600x");
    EXPECT_EQ(NpyOf(npy_bytes("'|S4'", "()", std::string("ab\0\0", 4))).open().read_text("array"),
              "ab");
    EXPECT_ERROR_WITH(NpyOf(npy_bytes("'<c8'", "(1,)", "12345678")).read({1}),
                      "array: holds no plain numbers: complex float32");
    EXPECT_ERROR_WITH(NpyOf(npy_bytes("[('a', '<f4')]", "(1,)", "1234")).read({1}),
                      "holds no plain numbers: structured");
}

TEST(NpyFile, PicklesAreRefusedWithThePythonThatConvertsThem) {
    const NpyOf file(npy_bytes("'|O'", "()", "\x80\x03}q."));
    EXPECT_ERROR_WITH(file.open(), "a.npy: holds pickled Python objects");
    EXPECT_ERROR_WITH(file.open(), "a.npz', **np.load('");
    EXPECT_ERROR_WITH(file.open(), "a.npy', allow_pickle=True).item())\"");
}

TEST(NpyFile, DamagedHeadersAndShapesBeyondTheFileAreReported) {
    const std::string good = npy_bytes("'<f4'", "(2, 2)", std::string(16, '\0'));
    for (std::size_t length = 6; length < good.size(); ++length) {
        EXPECT_ERROR_WITH(NpyOf(good.substr(0, length)).read({2, 2}), "a.npy") << length;
    }
    EXPECT_ERROR_WITH(NpyOf(npy_bytes("'<f4'", "(2, 3)", std::string(16, '\0'))).read({2, 3}),
                      "claims shape (2, 3) but only 16 bytes are stored; must be complete");
    EXPECT_ERROR_WITH(NpyOf(npy_bytes("'<f4'", "(4294967296, 4294967296)", "1234")).open(),
                      "claims shape (4294967296, 4294967296)");
    EXPECT_ERROR_WITH(NpyOf(npy_bytes("'<f4'", "(99999999999999999999,)", "1234")).open(),
                      "has a damaged header");
}

TEST(NpzFile, StoredAndDeflatedMembersAreRead) {
    const TemporaryFolder folder;
    for (const int method : {ZIP_CM_STORE, ZIP_CM_DEFLATE}) {
        const std::string path = folder.file("a.npz");
        write_example_npz(path, method);
        const ArrayReader file(path);
        EXPECT_EQ(file.container(), "npz");
        EXPECT_EQ(file.names(), (std::vector<std::string>{"hists", "sensor"}));
        EXPECT_EQ(file.read_doubles("hists", {2, 3}), (std::vector<double>{1, 2, 3, 4, 5, 6}));
        EXPECT_EQ(file.read_text("sensor"), "s\u00e9t");
        EXPECT_FALSE(file.has_object("other"));
    }
}

TEST(NpzFile, ArchivesOfOtherThingsAndPickledMembersAreTold) {
    const TemporaryFolder folder;
    write_npz(folder.file("a.npz"), {{"readme.txt", "hello"}});
    EXPECT_ERROR_WITH(ArrayReader(folder.file("a.npz")), "is a zip archive without .npy members");
    write_npz(folder.file("b.npz"), {{"x.npy", npy_bytes("'|O'", "()", "\x80\x03}q.")}});
    EXPECT_ERROR_WITH(ArrayReader(folder.file("b.npz")).read_real("x"),
                      "x: holds no plain numbers: pickled objects");
}

/// Puts a number of so many bytes, lowest first, into an archive wherever the mark stands.
void replace_sizes(std::string& bytes,
                   std::string_view mark,
                   std::size_t offset,
                   std::uint64_t size) {
    for (std::size_t at = bytes.find(mark); at != std::string::npos;
         at = bytes.find(mark, at + 1)) {
        for (std::size_t i = 0; i < 4; ++i) {
            bytes[at + offset + i] = static_cast<char>(size >> (8 * i) & 0xff);
        }
    }
}

TEST(NpzFile, MembersThatClaimMoreThanIsStoredAreRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.npz");
    write_npz(path, {{"x.npy", npy_bytes("'<f4'", "(1000000, 1000000)", std::string(64, '\0'))}});
    EXPECT_ERROR_WITH(ArrayReader(path).read_real("x"), "claims shape (1000000, 1000000)");
    write_npz(path, {{"x.npy", npy_bytes("'<f4'", "(16,)", std::string(64, '\0'))}});
    std::string bytes = test_support::file_bytes(path);
    replace_sizes(bytes, "PK\x01\x02", 24, 0xfffffff0);  // sizes in the archive's directory
    replace_sizes(bytes, "PK\x03\x04", 22, 0xfffffff0);  // and before the member
    test_support::write_file_bytes(path, bytes);
    EXPECT_ERROR_WITH(ArrayReader(path).read_real("x"), "claims 4294967280 bytes but only");
}

TEST(NpzFile, EveryTruncationIsReported) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.npz");
    write_example_npz(path);
    const std::string bytes = test_support::file_bytes(path);
    for (std::size_t length = 0; length < bytes.size(); length += 7) {
        test_support::write_file_bytes(path, bytes.substr(0, length));
        EXPECT_ERROR_WITH(ArrayReader(path).read_doubles("hists", {2, 3}), path) << length;
    }
}

}  // namespace
}  // namespace nlos
