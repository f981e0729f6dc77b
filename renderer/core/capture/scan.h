// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/image_scan.h"
#include "renderer/core/capture/sensor_scan.h"
#include "renderer/core/capture/wall_scan.h"

#include <concepts>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace core {

/// Several functions as one, of which the argument picks.
template <class... Functions>
struct Overloads : Functions... {
    using Functions::operator()...;
};

/// What a capture is of: one of several kinds. To add one: a file as those included above, its
/// place in `Kind`, and, where the compiler asks for it, what a room makes of it.
class Scan {
 public:
    using Kind = std::variant<WallScan, ImageScan, SensorScan>;

    Scan() = default;  ///< no points
    template <class AnyKind>
    requires(!std::same_as<std::remove_cvref_t<AnyKind>, Scan> &&
             std::constructible_from<Kind, AnyKind>) Scan(AnyKind&& kind)
        : kind_(std::forward<AnyKind>(kind)) {}

    /// Calls the one of several functions that takes this kind; a sensor's zones are wall points to
    /// those that do not tell them apart.
    template <class... Functions>
    decltype(auto) visit(const Functions&... functions) const {
        return std::visit(Overloads<std::remove_cvref_t<Functions>...>{functions...}, kind_);
    }

    /// Of the kind, in messages: single, confocal, exhaustive, camera, sensor.
    std::string_view name() const {
        return visit([](const auto& kind) { return kind.name(); });
    }
    std::size_t num_pairs() const {
        return visit([](const auto& kind) { return kind.num_pairs(); });
    }
    ScanPattern pattern() const {
        return visit([](const auto& kind) { return kind.pattern; });
    }
    OplOrigin opl_origin() const {
        return visit([](const auto& kind) { return kind.opl_origin; });
    }
    bool has_observed_bins() const {
        return visit([](const auto& kind) { return kind.has_observed_bins; });
    }
    /// Where the light comes from and where it is recorded.
    Devices devices() const {
        return visit([](const auto& kind) { return kind.devices(); });
    }
    /// How the pairs stand in arrays.
    std::vector<std::size_t> pair_extents() const {
        return visit([](const auto& kind) { return kind.pair_extents(); });
    }
    /// Where light paths may start and end [m, world].
    std::vector<Vec3> path_ends() const {
        return visit([](const auto& kind) { return kind.path_ends(); });
    }

    /// Whether it is of points on a relay wall, or of zones that look at them.
    bool has_wall() const { return as<WallScan>() != nullptr; }

    /// These points.
    ///
    /// where    prefix of the message
    /// throws   Error for other kinds
    const WallScan& wall(const std::string& where = "capture") const;
    WallScan& wall() { return const_cast<WallScan&>(std::as_const(*this).wall()); }

    /// What it is if it is, or derives from, a kind; else null.
    template <class AnyKind>
    const AnyKind* as() const {
        return visit([]<class OfScan>(const OfScan& kind) -> const AnyKind* {
            if constexpr (std::derived_from<OfScan, AnyKind>) return &kind;
            return nullptr;
        });
    }

 private:
    Kind kind_;
};

/// The same elsewhere: all places of it moved by `way` [m].
Scan moved(const Scan& scan, const Vec3& way);

/// Throws Error unless what it is of is complete and finite.
///
/// where   prefix of messages
void validate(const Scan& scan, const std::string& where);

}  // namespace core
