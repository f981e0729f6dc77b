// SPDX-License-Identifier: MIT
#include "nlos/containers/writers/mat5_writer.h"
#include "nlos/containers/writers/mat73_writer.h"
#include "nlos/formats/capture_format.h"
#include "nlos/formats/matlab_order.h"
#include "nlos/formats/stanford_scan.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using core::Capture;

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
    const StanfordScan square = stanford_scan(path, capture.scan);
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
    const StanfordScan square = stanford_scan(path, capture.scan);
    const std::vector<double> axis = own_axis(capture);
    const std::vector<double> width(2, 2.0 * square.half_width_m);
    Mat73Writer file(path);
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
    file.write(kOwnAxis, {axis.size(), 1}, axis);
    file.write(kWidth, {width.size(), 1}, width);
    file.finish();
    return losses(
        capture,
        fmt::format("axis and unit stand in {}, the size of the square in {}", kOwnAxis, kWidth),
        "bins of 32 ps from 0 on and a square of 2 m");
}

}  // namespace nlos
