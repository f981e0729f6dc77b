// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/scene.h"
#include "renderer/shift/shift_mapping.h"
#include "tests/support/shift_cases.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace test_support {

/// Configurations in which a shift is nearly, or exactly, not defined.
enum class HardShift {
    Generic,
    NearTangentPoint,  ///< x where the plane mirrors one focus to the other
    NearSegment,       ///< x close to the straight line between the foci
    CoincidentFoci,    ///< equal, or apart by next to nothing
    LargeMove,         ///< foci and length change by a good part of the segments: second roots
    EdgeOn,            ///< foci next to or in the facet's plane
    FocusOnSurface,    ///< x next to a focus
    FociFarAway,       ///< segments of a thousand scene sizes, or a kilometre
    ShortestLength,    ///< the new length within rounding of the shortest possible
};
inline constexpr std::array<std::string_view, 9> kHardShiftNames{"generic",
                                                                 "near tangent point",
                                                                 "near segment",
                                                                 "coincident foci",
                                                                 "large move",
                                                                 "edge-on",
                                                                 "focus on surface",
                                                                 "foci far away",
                                                                 "shortest length"};

/// Scenes of three sizes, 0.1 mm, 1 m and 100 m, around the origin and 1 km away from it, and on
/// each of them the mappings to be tried.
class HardShiftBench {
 public:
    HardShiftBench();

    /// What happened in shifts of one kind.
    struct Tally {
        std::array<std::uint64_t, kHardShiftNames.size()> tried{};
        std::array<std::uint64_t, kHardShiftNames.size()> accepted{};
        /// Accepted, while the way back is refused because rounding decides there: the source lies
        /// within 1e-8 of the segments of points that cannot be shifted, or lead elsewhere.
        std::uint64_t at_edge = 0;
        std::uint64_t wrong = 0;
        std::string first_wrong;  ///< what was wrong with the first one

        Tally& operator+=(const Tally& other);
    };

    /// Tries shifts [begin, end) of a fixed sequence and checks every accepted one: finite, on the
    /// facet it names, length as asked, Jacobian within its bound, and the way back.
    Tally run(std::uint64_t begin, std::uint64_t end) const;

 private:
    struct Stage {
        double size_m;
        core::Vec3 centre;
        std::unique_ptr<renderer::Scene> scene;
        std::vector<renderer::ShiftMapping> mappings;
    };

    std::vector<Stage> stages_;
};

}  // namespace test_support
