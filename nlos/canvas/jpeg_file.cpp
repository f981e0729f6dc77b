// SPDX-License-Identifier: MIT
#include "nlos/canvas/jpeg_file.h"

#include "renderer/core/error.h"

#include <turbojpeg.h>

#include <memory>

namespace nlos {
namespace {

constexpr int kJpegQuality = 80;  // of 100

static_assert(sizeof(Colour) == 3, "colours are pixels of three bytes");

struct ReleaseJpeg {
    void operator()(void* packer) const { ::tjDestroy(packer); }
    void operator()(unsigned char* bytes) const { ::tjFree(bytes); }
};

}  // namespace

std::string encode_jpeg(const Raster& raster) {
    const std::unique_ptr<void, ReleaseJpeg> packer(::tjInitCompress());
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    const int status = ::tjCompress2(packer.get(),
                                     reinterpret_cast<const unsigned char*>(raster.colours.data()),
                                     raster.columns,
                                     0,
                                     raster.rows,
                                     TJPF_RGB,
                                     &bytes,
                                     &size,
                                     TJSAMP_420,
                                     kJpegQuality,
                                     0);
    const std::unique_ptr<unsigned char, ReleaseJpeg> packed(bytes);
    if (status != 0) throw core::Failure("picture", "cannot be stored as .jpg");
    return {reinterpret_cast<const char*>(bytes), size};
}

}  // namespace nlos
