// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace calib {

/// One standard deviation of something that was not free, or that the data do not determine.
inline constexpr double kFixed = 0.0;
inline constexpr double kUnknown = std::numeric_limits<double>::infinity();

/// A number and its standard deviation.
struct Estimate {
    double value = 0.0;
    double sigma = kFixed;
};

/// Estimates by their key in FIT.json, in its order; "wall.bow_m" is bow_m of the object wall.
class Estimates {
 public:
    void add(const std::string& key, Estimate estimate) { list_.emplace_back(key, estimate); }
    /// The one of this key; 0 when there is none.
    Estimate operator[](std::string_view key) const {
        for (const auto& [name, estimate] : list_) {
            if (name == key) return estimate;
        }
        return {};
    }
    auto begin() const { return list_.begin(); }
    auto end() const { return list_.end(); }

 private:
    std::vector<std::pair<std::string, Estimate>> list_;
};

/// Where an object ended up; all values with one standard deviation beside them.
struct FittedObject {
    std::string name;
    core::Vec3 position_m = core::Vec3::Zero();                    ///< node origin, world
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< world from node
    core::Vec3 position_sigma_m = core::Vec3::Zero();
    core::Vec3 rotation_sigma_deg = core::Vec3::Zero();  ///< about the world's axes
    Estimates numbers;                                   ///< size, relative to the model's; albedo
    std::vector<double> heights_m;                       ///< of free vertices
    std::vector<double> heights_sigma_m;
};

/// A small isotropic scatterer.
struct FittedPoint {
    core::Vec3 position_m = core::Vec3::Zero();
    core::Vec3 position_sigma_m = core::Vec3::Zero();
    Estimate albedo;  ///< albedo times area [m^2]
};

}  // namespace calib
