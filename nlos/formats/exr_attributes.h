// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/exr_table.h"
#include "renderer/core/capture/capture.h"

#include <string>
#include <vector>

namespace nlos {

/// Header attributes whose values say what an image is of, see exr_capture.cpp and exr_image.h.
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

}  // namespace nlos
