// SPDX-License-Identifier: MIT
#include "nlos/containers/json_leaves.h"
#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/settings/json_file.h"

#include <fmt/core.h>

#include <array>
#include <bit>
#include <map>
#include <utility>

namespace nlos {
namespace {

/// A transient image of the University of Bonn (.ti), little endian.
///
/// TI04: u32 pixelMode, numPixels, numBins; f32 tMin, tDelta; u32 blockSize; f32 data[pixel][bin];
/// a block of blockSize bytes, which in mode 10 holds u32 uRes, vRes and five points of three f32;
/// a text, usually JSON. TI01: u32 numBins, uRes, vRes (TI00: vRes, numBins, uRes); f32 tmin, tmax;
/// data; text. Pixels run along u first. Source: their library, libtransientimage.
class TiFile : public JsonLeaves {
 public:
    explicit TiFile(const std::string& path) : path_(path), file_(path), rest_(file_.bytes()) {
        const std::string_view version = take(kMagicBytes);
        if (version == "TI04") {
            take_version_4();
        } else {
            take_version_1(version == "TI00");
        }
        take_text();
    }

    std::string container() const override { return "bonn-ti"; }

 private:
    static constexpr std::size_t kMagicBytes = 4;
    static constexpr std::size_t kWordBytes = 4;

    /// Takes the next bytes off the file.
    std::string_view take(std::uint64_t count) {
        if (count > rest_.size()) {
            throw core::Error(
                path_,
                fmt::format("claims {} bytes where only {} are left", count, rest_.size()),
                "must be a complete .ti file");
        }
        const std::string_view bytes = rest_.substr(0, count);
        rest_.remove_prefix(count);
        return bytes;
    }

    void take_array(const std::string& name, StoredNumber number, const Shape& shape) {
        StoredArray array;
        array.shape = shape;
        array.number = number;
        array.order = std::endian::little;
        array.bytes = take(total_bytes(shape, kWordBytes));
        add_array(name, array);
    }

    /// Takes a number, which is an array too.
    double take_number(const std::string& name, StoredNumber number) {
        const char* begin = rest_.data();
        take_array(name, number, {});
        return number_at(begin, number, std::endian::little);
    }

    /// Takes a number of pixels, bins or bytes.
    std::uint64_t take_count(const std::string& name) {
        return static_cast<std::uint64_t>(take_number(name, StoredNumber::UInt32));
    }

    void take_version_4() {
        constexpr std::uint64_t kPlaneMode = 10;
        const std::uint64_t mode = take_count("pixelMode");
        const std::uint64_t pixels = take_count("numPixels");
        const std::uint64_t bins = take_count("numBins");
        take_array("tMin", StoredNumber::Float32, {});
        take_array("tDelta", StoredNumber::Float32, {});
        const std::uint64_t block_bytes = take_count("blockSize");
        take_array("data", StoredNumber::Float32, {pixels, bins});
        const std::string_view block = take(block_bytes);
        if (mode != kPlaneMode) return;
        const std::string_view text = std::exchange(rest_, block);
        take_count("uRes");
        take_count("vRes");
        for (const char* point :
             {"topLeft", "topRight", "bottomLeft", "bottomRight", "laserPosition"}) {
            take_array(point, StoredNumber::Float32, {3});
        }
        rest_ = text;
    }

    void take_version_1(bool is_old) {
        std::map<std::string, std::uint64_t> counts;
        const std::array<const char*, 3> names =
            is_old ? std::array{"vRes", "numBins", "uRes"} : std::array{"numBins", "uRes", "vRes"};
        for (const char* name : names) counts[name] = take_count(name);
        const double begin = take_number("tmin", StoredNumber::Float32);
        const double end = take_number("tmax", StoredNumber::Float32);
        // As the newer version gives it.
        add_values("tDelta",
                   {},
                   {(end - begin) / static_cast<double>(counts["numBins"])},
                   ElementKind::Real,
                   "float64");
        const std::uint64_t pixels = counts["uRes"] * counts["vRes"];
        add_values("numPixels", {}, {static_cast<double>(pixels)}, ElementKind::Integer, "uint32");
        take_array("data", StoredNumber::Float32, {pixels, counts["numBins"]});
    }

    void take_text() {
        if (core::Json::accept(rest_)) {
            add_leaves("", core::parse_json(rest_, path_));
        } else if (!rest_.empty()) {
            add_text("imageProperties", {}, std::string(rest_));
        }
    }

    std::string path_;
    core::MappedFile file_;
    std::string_view rest_;
};

bool is_ti_file(const std::string& path) {
    const std::string magic = core::first_bytes(path, 4);
    return magic == "TI00" || magic == "TI01" || magic == "TI04";
}

}  // namespace

Container ti_container() {
    return {"Bonn .ti", is_ti_file, open_as<TiFile>};
}

}  // namespace nlos
