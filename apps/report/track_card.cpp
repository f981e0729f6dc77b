// SPDX-License-Identifier: MIT
#include "apps/report/result_cards.h"
#include "calib/track/track_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace apps {
namespace {

namespace fs = std::filesystem;

std::string range_text(double low, double high) {
    return fmt::format("{:.2f} to {:.2f} m", low, high);
}

}  // namespace

ResultCard track_card(const std::string& path, const core::Json& json) {
    const std::vector<calib::TrackedFrame> frames = calib::read_track(path);
    ResultCard card;
    card.file = fs::path(path).filename().string();
    std::size_t named = 0;
    std::size_t most = 0;
    std::vector<double> sigmas_m;
    core::Vec3 low = core::Vec3::Constant(1e300);
    core::Vec3 high = -low;
    for (const calib::TrackedFrame& frame : frames) {
        named += frame.targets.empty() ? 0 : 1;
        most = std::max(most, frame.targets.size());
        for (const calib::TrackedPosition& target : frame.targets) {
            low = low.cwiseMin(target.position_m);
            high = high.cwiseMax(target.position_m);
            if (target.covariance_m2) sigmas_m.push_back(std::sqrt(target.covariance_m2->trace()));
        }
    }
    card.facts.emplace_back("frames", std::to_string(frames.size()));
    card.facts.emplace_back(
        "time", fmt::format("{:.2f} to {:.2f} s", frames.front().time_s, frames.back().time_s));
    card.facts.emplace_back("frames with a target", std::to_string(named));
    card.facts.emplace_back("targets at a time", fmt::format("at most {}", most));
    if (named > 0) {
        card.facts.emplace_back("x", range_text(low.x(), high.x()));
        card.facts.emplace_back("y", range_text(low.y(), high.y()));
        card.facts.emplace_back("z", range_text(low.z(), high.z()));
    }
    if (!sigmas_m.empty()) {
        std::nth_element(sigmas_m.begin(),
                         sigmas_m.begin() + static_cast<std::ptrdiff_t>(sigmas_m.size() / 2),
                         sigmas_m.end());
        card.facts.emplace_back("stated error, median",
                                short_number(sigmas_m[sigmas_m.size() / 2]) + " m");
    }
    const fs::path picture = fs::path(path).replace_extension(".png");
    if (fs::exists(picture)) card.picture_png = read_bytes(picture.string());
    for (const core::Json& text : json.value("warnings", core::Json::array())) {
        if (text.is_string()) card.notes.push_back("Warning: " + text.get<std::string>());
    }
    for (const char* key : {"settings", "version", "command"}) {
        if (json.contains(key)) card.settings[key] = json[key];
    }
    return card;
}

}  // namespace apps
