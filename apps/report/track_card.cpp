// SPDX-License-Identifier: MIT
#include "apps/report/result_cards.h"
#include "calib/statistics/median.h"
#include "calib/track/track_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace apps {
namespace {

namespace fs = std::filesystem;

}  // namespace

ResultCard track_card(const std::string& path, const core::Json& json) {
    const std::vector<calib::TrackedFrame> frames = calib::read_track(path);
    ResultCard card;
    card.file = fs::path(path).filename().string();
    std::size_t named = 0;
    std::size_t most = 0;
    std::vector<double> sigmas_m;
    Eigen::AlignedBox3d box;
    for (const calib::TrackedFrame& frame : frames) {
        named += frame.targets.empty() ? 0 : 1;
        most = std::max(most, frame.targets.size());
        for (const calib::TrackedPosition& target : frame.targets) {
            box.extend(target.position_m);
            if (target.covariance_m2) sigmas_m.push_back(std::sqrt(target.covariance_m2->trace()));
        }
    }
    card.facts.emplace_back("frames", std::to_string(frames.size()));
    card.facts.emplace_back(
        "time", fmt::format("{:.2f} to {:.2f} s", frames.front().time_s, frames.back().time_s));
    card.facts.emplace_back("frames with a target", std::to_string(named));
    card.facts.emplace_back("targets at a time", fmt::format("at most {}", most));
    if (named > 0) {
        for (const int axis : {0, 1, 2}) {
            card.facts.emplace_back(
                std::string(1, "xyz"[axis]),
                fmt::format("{:.2f} to {:.2f} m", box.min()[axis], box.max()[axis]));
        }
    }
    if (!sigmas_m.empty()) {
        card.facts.emplace_back("stated error, median",
                                short_number(calib::median(sigmas_m)) + " m");
    }
    card.picture_png = picture_beside(path);
    for (const core::Json& text : json.value("warnings", core::Json::array())) {
        if (text.is_string()) card.notes.push_back("Warning: " + text.get<std::string>());
    }
    for (const char* key : {"settings", "version", "command"}) {
        if (json.contains(key)) card.settings[key] = json[key];
    }
    return card;
}

}  // namespace apps
