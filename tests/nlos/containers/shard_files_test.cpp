// SPDX-License-Identifier: MIT
#include "nlos/containers/array_reader.h"
#include "nlos/containers/writers/hdf5_writer.h"
#include "nlos/containers/writers/npz_writer.h"
#include "nlos/containers/writers/packed_chunk.h"
#include "nlos/containers/writers/tar_writer.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <Eigen/Core>
#include <gtest/gtest.h>
#include <unistd.h>

#include <numeric>

namespace {

using nlos::StoredNumber;
using test_support::TemporaryFolder;

/// 0, 1, 2, ... as a type stores them.
template <class T>
std::string counted(std::size_t count) {
    std::vector<T> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<T>(static_cast<int>(i)));
    return {reinterpret_cast<const char*>(values.data()), count * sizeof(T)};
}

std::string counted(StoredNumber number, std::size_t count) {
    switch (number) {
        case StoredNumber::UInt8:
            return counted<std::uint8_t>(count);
        case StoredNumber::Int16:
            return counted<std::int16_t>(count);
        case StoredNumber::UInt16:
            return counted<std::uint16_t>(count);
        case StoredNumber::UInt64:
            return counted<std::uint64_t>(count);
        case StoredNumber::Float16:
            return counted<Eigen::half>(count);
        case StoredNumber::Float64:
            return counted<double>(count);
        default:
            return counted<float>(count);
    }
}

constexpr std::array kNumbers{StoredNumber::UInt8,
                              StoredNumber::Int16,
                              StoredNumber::UInt16,
                              StoredNumber::UInt64,
                              StoredNumber::Float16,
                              StoredNumber::Float32,
                              StoredNumber::Float64};

void expect_counted(const std::string& path, const std::string& name, std::size_t count) {
    const nlos::ArrayReader reader(path);
    const nlos::Shape shape = reader.shape(name);
    EXPECT_EQ(nlos::total_bytes(shape, 1), count) << name;
    const std::vector<double> values = reader.read_doubles(name, shape);
    ASSERT_EQ(values.size(), count) << name;
    for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(values[i], static_cast<double>(i)) << name << " " << i;
    }
}

TEST(ShardFiles, RowsOfEveryTypeReadBackFromHdf5AtEveryLevel) {
    const TemporaryFolder folder;
    const std::string path = folder.file("rows.h5");
    nlos::Hdf5Writer file(path);
    for (const StoredNumber number : kNumbers) {
        for (const int level : {0, 1, 9}) {
            const std::string name = nlos::type_name(number) + "_" + std::to_string(level);
            file.create_rows(name, number, 3, {5, 4}, level);
            const std::string bytes = counted(number, 60);
            const std::size_t row_bytes = bytes.size() / 3;
            for (std::size_t row = 0; row < 3; ++row) {
                file.write_packed_row(
                    name,
                    row,
                    nlos::pack_chunk(
                        bytes.substr(row * row_bytes, row_bytes), nlos::bytes_of(number), level));
            }
        }
        file.write_numbers(nlos::type_name(number), number, {6, 2}, counted(number, 12));
    }
    file.finish();
    for (const StoredNumber number : kNumbers) {
        for (const int level : {0, 1, 9}) {
            expect_counted(path, nlos::type_name(number) + "_" + std::to_string(level), 60);
        }
        expect_counted(path, nlos::type_name(number), 12);
    }
}

TEST(ShardFiles, TheSameRowsGiveTheSameBytes) {
    const TemporaryFolder folder;
    const auto write = [&](const std::string& name) {
        nlos::Hdf5Writer file(folder.file(name));
        file.create_rows("H", StoredNumber::UInt16, 2, {300}, 1);
        for (const std::size_t row : {0, 1}) {
            file.write_packed_row(
                "H", row, nlos::pack_chunk(counted(StoredNumber::UInt16, 300), 2, 1));
        }
        file.write_texts("parameters", {"{\"item\":0}", "{}"});
        file.finish();
        return test_support::file_bytes(folder.file(name));
    };
    const std::string first = write("a.h5");
    ::sleep(1);  // times in files count seconds
    EXPECT_EQ(first, write("b.h5"));
}

TEST(ShardFiles, ArraysOfEveryTypeReadBackFromAnArchiveInMemory) {
    const TemporaryFolder folder;
    nlos::NpzWriter archive;
    for (const StoredNumber number : kNumbers) {
        archive.write_numbers(nlos::type_name(number), number, {6, 2}, counted(number, 12));
    }
    const std::string path = folder.file("arrays.npz");
    test_support::write_file_bytes(path, archive.finish_in_memory());
    for (const StoredNumber number : kNumbers) expect_counted(path, nlos::type_name(number), 12);
}

TEST(ShardFiles, TarHasTheHeadersOfUstar) {
    const TemporaryFolder folder;
    nlos::TarWriter archive(folder.file("a.tar"));
    archive.add("000000001.json", "{\"item\":1}");
    archive.add("empty", "");
    archive.add("block", std::string(512, 'x'));
    archive.finish();
    const std::string bytes = test_support::file_bytes(folder.file("a.tar"));
    ASSERT_EQ(bytes.size(), 512u * (2 + 1 + 2 + 2));
    EXPECT_STREQ(bytes.c_str(), "000000001.json");
    EXPECT_EQ(bytes.substr(124, 12), std::string("00000000012\0", 12));
    EXPECT_EQ(bytes.substr(257, 8), std::string("ustar\00000", 8));
    EXPECT_EQ(bytes.substr(512, 10), "{\"item\":1}");
    EXPECT_STREQ(bytes.c_str() + 1024, "empty");
    EXPECT_STREQ(bytes.c_str() + 1536, "block");
    for (const std::size_t begin : {0, 1024, 1536}) {
        std::string header = bytes.substr(begin, 512);
        const unsigned stored =
            static_cast<unsigned>(std::stoul(header.substr(148, 6), nullptr, 8));
        header.replace(148, 8, "        ");
        EXPECT_EQ(stored, std::accumulate(header.begin(), header.end(), 0U));
    }
    EXPECT_EQ(bytes.substr(bytes.size() - 1024), std::string(1024, '\0'));
}

}  // namespace
