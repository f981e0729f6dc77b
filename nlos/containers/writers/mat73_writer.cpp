// SPDX-License-Identifier: MIT
#include "nlos/containers/writers/mat73_writer.h"

namespace nlos {
namespace {

/// What MATLAB looks for in front of the HDF5 file: a text of 116 bytes, an offset of 8 bytes that
/// v7.3 does not use, the version 0x0200 and a mark of the byte order.
std::string user_block() {
    constexpr std::size_t kTextBytes = 116;
    constexpr std::size_t kOffsetBytes = 8;
    constexpr std::size_t kBlockBytes = 512;
    std::string block = "MATLAB 7.3 MAT-file, Platform: nlos, HDF5 schema 1.00 .";
    block.resize(kTextBytes, ' ');
    block.append(kOffsetBytes, '\0');
    block.append("\x00\x02IM", 4);
    block.resize(kBlockBytes, '\0');
    return block;
}

}  // namespace

Mat73Writer::Mat73Writer(std::string target) : file_(std::move(target), user_block()) {}

void Mat73Writer::write(const std::string& name,
                        const Shape& shape,
                        std::span<const double> values) {
    file_.write(name, shape, values);
    write_class(name, "double");
}

void Mat73Writer::write_class(const std::string& name, const char* matlab_class) {
    file_.write_ascii_attribute(name, "MATLAB_class", matlab_class);
}

}  // namespace nlos
