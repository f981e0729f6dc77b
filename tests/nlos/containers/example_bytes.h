// SPDX-License-Identifier: MIT
#pragma once

#include <zip.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace nlos {

/// The bytes of numbers as this machine stores them.
template <class T>
std::string bytes_of_values(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A .npy file of version 1.
inline std::string npy_bytes(const std::string& descr,
                             const std::string& shape,
                             const std::string& values,
                             const std::string& fortran_order = "False") {
    const std::string header = "{'descr': " + descr + ", 'fortran_order': " + fortran_order +
                               ", 'shape': " + shape + ", }\n";
    std::string bytes = "\x93NUMPY";
    bytes += '\x01';
    bytes += '\x00';
    bytes += static_cast<char>(header.size() & 0xff);
    bytes += static_cast<char>(header.size() >> 8);
    return bytes + header + values;
}

/// Writes a .npz archive of members with the given bytes.
inline void write_npz(const std::string& path,
                      const std::vector<std::pair<std::string, std::string>>& members,
                      int method = ZIP_CM_DEFLATE) {
    zip_t* archive = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
    for (const auto& [name, bytes] : members) {
        zip_source_t* source = zip_source_buffer(archive, bytes.data(), bytes.size(), 0);
        const zip_int64_t index = zip_file_add(archive, name.c_str(), source, 0);
        zip_set_file_compression(archive, static_cast<zip_uint64_t>(index), method, 0);
    }
    zip_close(archive);
}

inline void write_example_npz(const std::string& path, int method = ZIP_CM_DEFLATE) {
    write_npz(path,
              {{"hists.npy",
                npy_bytes("'<u2'", "(2, 3)", bytes_of_values<std::uint16_t>({1, 2, 3, 4, 5, 6}))},
               {"sensor.npy",
                npy_bytes("'<U3'", "()", bytes_of_values<std::uint32_t>({'s', 0xe9, 't'}))}},
              method);
}

/// A .ti file of version 4: 3 x 2 pixels of 4 bins that hold 0, 1, 2, ...
inline std::string example_ti_bytes(std::uint32_t num_pixels = 6) {
    std::vector<float> data(24);
    for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<float>(i);
    std::vector<float> points(15);
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = static_cast<float>(i) + 0.5F;
    return "TI04" + bytes_of_values<std::uint32_t>({10, num_pixels, 4}) +
           bytes_of_values<float>({0.5F, 0.25F}) + bytes_of_values<std::uint32_t>({68}) +
           bytes_of_values(data) + bytes_of_values<std::uint32_t>({3, 2}) +
           bytes_of_values(points) + R"({"exposure_s": 2.5, "laser": {"name": "green"}})";
}

/// A .ti file of an older version with 24 values: its counts in the order of the version.
inline std::string example_old_ti_bytes(const std::string& version,
                                        const std::vector<std::uint32_t>& counts) {
    return version + bytes_of_values(counts) + bytes_of_values<float>({0.5F, 1.5F}) +
           bytes_of_values(std::vector<float>(24, 1.5F)) + "hand-held";
}

/// A log as sensors write it: frames of one kind, and what was set.
inline constexpr const char* kExampleJson = R"({"Result_Set": [
    {"info": {"frame": 0}, "mp_histo": [[{"bin": [1, 2]}, {"bin": [3, 4]}]], "found": []},
    {"info": {"frame": 1}, "mp_histo": [[{"bin": [5, 6]}, {"bin": [7, 8]}]], "found": [9]}],
    "configuration": {"name": "größer", "range_m": 1.5, "is_on": true, "none": null}})";

inline constexpr const char* kExampleCsv = "x,\"y\",z\r\n1,2,-3e-1\n# note\n4,5,6\n";

}  // namespace nlos
