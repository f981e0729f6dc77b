// SPDX-License-Identifier: MIT
#include "nlos/containers/writers/hdf5_writer.h"
#include "nlos/containers/writers/mat5_writer.h"
#include "nlos/formats/capture_format.h"
#include "nlos/formats/matlab_order.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using core::Capture;

// Stanford's confocal files ([OToole2018], [Lindell2019]) hold a square of wall points: z = 0
// around the origin, ends included, x ascending along one axis and y descending along the other.

/// What we add to files that we write: start of the axis, bin width, 0 for radiance or 1 for
/// counts, and counts per radiance or 0.
constexpr const char* kOwnAxis = "nlos_axis";

/// How a scan's pairs stand in such a square.
struct StanfordScan {
    double half_width_m = 0.0;
    std::size_t side = 0;
    bool y_ascends = true;

    /// The pair at index i along x and j along -y.
    std::size_t pair(std::size_t i, std::size_t j) const {
        return i * side + (y_ascends ? side - 1 - j : j);
    }
};

/// Throws core::Error that names `path` unless the scan is such a square, whose path lengths
/// exclude the segments to the devices.
StanfordScan stanford_scan(const std::string& path, const core::WallScan& scan) {
    constexpr double kTolerance_m = 1e-6;  // other files hold single precision
    const auto refuse = [&](const std::string& found) {
        throw core::Error(path,
                          "cannot hold " + found,
                          "must be a confocal square of points on z = 0 around the origin, ends "
                          "included, with path lengths from and to the wall");
    };
    if (scan.pattern != core::ScanPattern::Confocal) {
        refuse(fmt::format("a scan that is {}", enum_name(scan.pattern)));
    }
    if (scan.opl_origin != core::OplOrigin::RelayWall) refuse("path lengths with device segments");
    if (!scan.sensing.grid || (*scan.sensing.grid)[0] != (*scan.sensing.grid)[1] ||
        (*scan.sensing.grid)[0] < 2) {
        refuse("points that are no square grid");
    }
    StanfordScan square;
    square.side = (*scan.sensing.grid)[0];
    square.half_width_m = -scan.sensing.positions.front().x();
    square.y_ascends = scan.sensing.positions.front().y() < scan.sensing.positions.back().y();
    if (!(square.half_width_m > 0.0)) refuse("points whose x does not ascend around 0");
    const double pitch_m = 2.0 * square.half_width_m / static_cast<double>(square.side - 1);
    for (std::size_t i = 0; i < square.side; ++i) {
        for (std::size_t j = 0; j < square.side; ++j) {
            const std::size_t pair = square.pair(i, j);
            const core::Vec3 wanted(pitch_m * static_cast<double>(i) - square.half_width_m,
                                    square.half_width_m - pitch_m * static_cast<double>(j),
                                    0.0);
            if ((scan.sensing.positions[pair] - wanted).norm() > kTolerance_m ||
                (scan.sensing.normals[pair] - core::Vec3::UnitZ()).norm() > kTolerance_m) {
                refuse(fmt::format("point {} where it is", pair));
            }
        }
    }
    return square;
}

/// What MATLAB looks for in front of the HDF5 file that a v7.3 file is: a text of 116 bytes, an
/// offset of 8 bytes that v7.3 does not use, the version 0x0200 and a mark of the byte order.
std::string mat73_block() {
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

bool fits_uint16(const core::Transient& transient) {
    return std::ranges::all_of(transient.values(), [](float value) {
        return value >= 0.0F && value <= 65535.0F && value == std::trunc(value);
    });
}

std::vector<double> own_axis(const Capture& capture) {
    return {capture.time_axis.opl_start_m,
            capture.time_axis.bin_width_m,
            capture.unit == core::TransientUnit::Counts ? 1.0 : 0.0,
            capture.counts_per_radiance.value_or(0.0)};
}

/// What others do not learn from the file, and what it does not hold.
///
/// assumed   what others take for the axis
std::vector<std::string> losses(const Capture& capture,
                                const std::string& own,
                                const std::string& assumed) {
    std::vector<std::string> sentences{
        fmt::format("{}, which only this program reads; others assume {}", own, assumed)};
    if (const auto extras = extras_left_out(capture)) sentences.push_back(*extras);
    return sentences;
}

}  // namespace

std::vector<std::string> write_stanford_2018(const std::string& path,
                                             const Capture& capture,
                                             const CaptureWriteSettings&) {
    const StanfordScan square = stanford_scan(path, capture.scan.wall(path));
    const bool is_integer = fits_uint16(capture.transient);
    MatVariable data{"rect_data", {square.side, square.side, capture.transient.num_bins()}, {}};
    const auto pair = [&](std::size_t i, std::size_t j) { return square.pair(i, j); };
    if (is_integer) {
        data.values =
            to_matlab_order<std::uint16_t>(capture.transient, square.side, square.side, pair);
    } else {
        data.values = to_matlab_order<float>(capture.transient, square.side, square.side, pair);
    }
    const std::vector<double> axis = own_axis(capture);
    write_mat_file(path,
                   {data,
                    {"width", {1, 1}, std::vector<double>{square.half_width_m}},
                    {kOwnAxis, {1, axis.size()}, axis}});
    std::vector<std::string> sentences = losses(capture,
                                                fmt::format("axis and unit stand in {}", kOwnAxis),
                                                "bins of 4 ps from the direct return on");
    if (!is_integer) {
        sentences.emplace_back("rect_data is single precision: values are no counts");
    }
    return sentences;
}

/// The file holds meas (y, x, t) as MATLAB counts axes, y descending and x ascending, which HDF5
/// stores as (t, x, y).
std::vector<std::string> write_stanford_fk_2019(const std::string& path,
                                                const Capture& capture,
                                                const CaptureWriteSettings&) {
    constexpr const char* kWidth = "nlos_width";  // along x and y, first to last point [m]
    const StanfordScan square = stanford_scan(path, capture.scan.wall(path));
    const std::vector<double> axis = own_axis(capture);
    const std::vector<double> width(2, 2.0 * square.half_width_m);
    Hdf5Writer file(path, mat73_block());
    const auto set_class = [&](const char* name, const char* matlab_class) {
        file.write_ascii_attribute(name, "MATLAB_class", matlab_class);
    };
    file.write_rows("meas",
                    {capture.transient.num_bins(), square.side, square.side},
                    [&](std::size_t first, std::size_t count, std::vector<float>& rows) {
                        float* value = rows.data();
                        for (std::size_t bin = first; bin < first + count; ++bin) {
                            for (std::size_t i = 0; i < square.side; ++i) {
                                for (std::size_t j = 0; j < square.side; ++j) {
                                    *value++ = capture.transient.histogram(square.pair(i, j))[bin];
                                }
                            }
                        }
                    });
    set_class("meas", "single");
    file.write(kOwnAxis, {axis.size(), 1}, axis);
    set_class(kOwnAxis, "double");
    file.write(kWidth, {width.size(), 1}, width);
    set_class(kWidth, "double");
    file.finish();
    return losses(
        capture,
        fmt::format("axis and unit stand in {}, the size of the square in {}", kOwnAxis, kWidth),
        "bins of 32 ps from 0 on and a square of 2 m");
}

}  // namespace nlos
