// SPDX-License-Identifier: MIT
#include "nlos/preparation/checks/capture_correction.h"
#include "renderer/core/capture/capture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

/// What may have happened when lengths must be multiplied by a factor.
struct FactorStory {
    double factor;
    const char* text;
};
constexpr FactorStory kFactorStories[] = {
    {2.0, "as if half of each round trip had been given"},
    {0.5, "as if round trips had been doubled once more"},
    {core::kSpeedOfLight * 1e-9, "as if ns had been taken for metres"},
    {1e9 / core::kSpeedOfLight, "as if metres had been taken for ns"},
    {1e-3, "as if ps had been taken for ns"},
    {1e3, "as if ns had been taken for ps"},
    {1e-6, "as if ps had been taken for us"},
    {1e6, "as if us had been taken for ps"},
    {1e-9, "as if ns had been taken for s"},
    {1e9, "as if s had been taken for ns"},
    {1e-12, "as if ps had been taken for s"},
    {1e12, "as if s had been taken for ps"},
    {core::kSpeedOfLight, "as if s had been taken for metres"},
    {1.0 / core::kSpeedOfLight, "as if metres had been taken for s"},
    {core::kSpeedOfLight * 1e-12, "as if ps had been taken for metres"},
    {1e12 / core::kSpeedOfLight, "as if metres had been taken for ps"}};

/// The same of the wall's extents.
constexpr FactorStory kWallStories[] = {{2.0, "as if half its width had been taken for the width"},
                                        {0.5, "as if the width had been taken for half of it"},
                                        {1e-3, "as if mm had been taken for metres"},
                                        {1e-2, "as if cm had been taken for metres"},
                                        {0.0254, "as if inches had been taken for metres"},
                                        {1e3, "as if km had been taken for metres"}};

/// What happened, after a comma; nothing where no story has the factor.
template <std::size_t kCount>
std::string story_of(const FactorStory (&stories)[kCount], double factor) {
    for (const FactorStory& story : stories) {
        if (story.factor == factor) return fmt::format(", {}", story.text);
    }
    return "";
}

std::string setting_of_wall(const core::Capture& capture, double factor) {
    const core::ScanExtent extent = core::scan_extent(capture.scan.wall());
    return fmt::format("capture.wall_size_m=[{:.6g},{:.6g}]",
                       factor * extent.size_m[0],
                       factor * extent.size_m[1]);
}

std::string text_of_lengths(const core::Capture& capture, const CaptureCorrection& correction) {
    const double factor = correction.length_factor;
    const core::TimeAxis& axis = capture.time_axis;
    std::string text = fmt::format("lengths look {:.4g} times too {}",
                                   std::max(factor, 1.0 / factor),
                                   factor < 1.0 ? "long" : "short");
    text += story_of(kFactorStories, factor);
    text += fmt::format(": --set capture.bin_width_m={:.6g}", factor * axis.bin_width_m);
    const double start_moves_m = (factor - 1.0) * axis.opl_start_m;
    if (!correction.keeps_start && std::abs(start_moves_m) > factor * axis.bin_width_m) {
        text += fmt::format(" capture.opl_shift_m={:.6g}", start_moves_m);
    }
    if (!is_scale_free(capture.scan.wall())) return text;
    return text + fmt::format("; or the wall looks {:.4g} times too {}{}: --set {}",
                              std::max(factor, 1.0 / factor),
                              factor < 1.0 ? "small" : "large",
                              story_of(kWallStories, 1.0 / factor),
                              setting_of_wall(capture, 1.0 / factor));
}

std::string text_of_wall(const core::Capture& capture, double factor) {
    return fmt::format("the wall looks {:.4g} times too {}{}: --set {}",
                       std::max(factor, 1.0 / factor),
                       factor > 1.0 ? "small" : "large",
                       story_of(kWallStories, factor),
                       setting_of_wall(capture, factor));
}

}  // namespace

std::string describe_mistake(const core::Capture& capture, const CaptureCorrection& correction) {
    if (correction.length_factor != 1.0) return text_of_lengths(capture, correction);
    if (correction.wall_factor != 1.0) return text_of_wall(capture, correction.wall_factor);
    if (correction.origin == core::OplOrigin::Device) {
        return "path lengths look as if they included the segments to laser and detector: --set "
               "capture.opl_origin=device";
    }
    if (correction.origin) {
        return "path lengths look as if they excluded the segments to laser and detector: --set "
               "capture.opl_origin=relay_wall";
    }
    if (correction.flip_t) return "time looks reversed: --set capture.flip_t=true";
    if (correction.swap_xy) return "x and y look exchanged: --set capture.swap_xy=true";
    if (correction.flip_x) return "x looks reversed: --set capture.flip_x=true";
    if (correction.flip_y) return "y looks reversed: --set capture.flip_y=true";
    return fmt::format("time zero looks about {:.3g} m too {}: --set capture.opl_shift_m={:.3g}",
                       std::abs(correction.shift_m),
                       correction.shift_m < 0.0 ? "early" : "late",
                       correction.shift_m);
}

}  // namespace nlos
