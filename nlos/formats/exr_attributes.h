// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/exr_table.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/settings/settings_json.h"

#include <string>
#include <vector>

namespace nlos {

/// Header attributes whose values say what an image is of, see exr_capture.cpp and below.
inline constexpr const char* kExrFormatKey = "nlosFormat";
inline constexpr const char* kExrObservedBins = "nlosObservedBins";

/// Writes what captures of both kinds state: format, unit, its scale, axis and provenance.
void put_measurement(const char* format, const core::Capture& capture, ExrTable& table);

/// A table of named values whose absence or shape is an error of the file.
class ExrAttributes {
 public:
    ExrAttributes(const std::string& path, const ExrTable& table) : path_(path), table_(table) {}

    double number(const std::string& name) const { return find(table_.numbers, name, "a double"); }
    const std::string& text(const std::string& name) const {
        return find(table_.texts, name, "a text");
    }
    const std::vector<float>& channel(const std::string& name) const {
        return find(table_.channels, name, "a channel");
    }
    template <class E>
    E choice(const std::string& name) const {
        E value{};
        core::read_value(core::Json(text(name)), path_ + ": " + name, value);
        return value;
    }
    std::vector<core::Vec3> vectors(const std::string& name) const;
    core::Vec3 vector(const std::string& name) const;
    core::WallPoints points(const std::string& device) const;
    core::ObservedBins observed_bins(std::size_t num_pairs) const;

    /// Reads unit, its scale and the axis.
    void read_measurement(int num_bins, core::Capture& capture) const;

 private:
    template <class Map>
    const typename Map::mapped_type& find(const Map& map,
                                          const std::string& name,
                                          const char* wanted) const {
        const auto found = map.find(name);
        if (found == map.end()) throw_missing(name, wanted);
        return found->second;
    }
    [[noreturn]] void throw_missing(const std::string& name, const std::string& wanted) const;

    const std::string& path_;
    const ExrTable& table_;
};

// The image of a camera as an OpenEXR image, top-left first: one float channel per bin, `bin000`
// and so on, and one per bin of path velocity, `velocity000` and so on, unless these are resolved
// in time. Header attributes:
//
//   nlosFormat                        text: image 1
//   nlosCamera                        text: JSON of core::PinholeCamera
//   nlosUnit                          text: radiance | counts
//   nlosCountsPerRadiance             double, when known
//   nlosOplStartM, nlosBinWidthM      double: start of bin 0 and width of a bin [m of path length]
//   nlosVelocityAxis                  text: JSON of core::VelocityAxis, with velocities
//   nlosSceneInfo                     text: JSON, where the capture came from

/// The value of nlosFormat.
inline constexpr const char* kExrImageFormat = "image 1";

/// An image as the table of such a file; variance, bounce orders, frames and velocities resolved in
/// time have no place in it.
/// capture   with a camera
ExrTable to_exr_image(const core::Capture& capture, const core::PinholeCamera& camera);

/// The inverse of to_exr_image().
/// throws   core::Error naming the file and what is missing or of another size
core::Capture from_exr_image(const std::string& path, const ExrTable& table);

}  // namespace nlos
