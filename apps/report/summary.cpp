// SPDX-License-Identifier: MIT
#include "apps/report/summary.h"

#include <fmt/core.h>
#include <fmt/format.h>

namespace apps {
namespace {

/// `a`, `a and b`, `a, b and c`; of many, the first and how many more.
std::string listed(const std::vector<std::string>& names) {
    constexpr std::size_t kMost = 4;
    if (names.size() > kMost) {
        return fmt::format("{} and {} more",
                           fmt::join(names.begin(), names.begin() + kMost - 1, ", "),
                           names.size() - (kMost - 1));
    }
    if (names.size() < 2) return names.empty() ? "" : names.front();
    return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

std::string with_article(const std::string& thing) {
    const bool is_vowel =
        !thing.empty() && std::string("aeiou").find(thing[0]) != std::string::npos;
    return (is_vowel ? "An " : "A ") + thing;
}

std::string methods_text(const PageViews& views) {
    std::vector<std::string> names;
    for (const ResultView& result : views.results) {
        if (std::find(names.begin(), names.end(), result.name) == names.end()) {
            names.push_back(result.name);
        }
    }
    return listed(names);
}

/// What the page holds, such as `1 capture, 2 reconstructions`.
std::string contents_text(const ResultsFolder& results) {
    std::string text;
    const auto add = [&](std::size_t count, const char* thing) {
        if (count == 0) return;
        text +=
            fmt::format("{}{} {}{}", text.empty() ? "" : ", ", count, thing, count == 1 ? "" : "s");
    };
    add(results.dataset ? 1 : 0, "data set");
    add(results.captures.size(), "capture");
    add(results.volumes.size(), "reconstruction");
    add(results.fits.size(), "fit");
    add(results.tracks.size(), "track");
    add(results.scores.size(), "comparison");
    add(results.benches.size(), "benchmark");
    add(results.sweeps.size(), "sweep");
    add(results.unreadable.size(), "unreadable file");
    return text;
}

}  // namespace

std::string summary_text(const ResultsFolder& results) {
    const PageViews& views = results.views;
    std::string text;
    if (!views.animations.empty()) text = with_article(views.animations.front().detail);
    if (!views.results.empty()) {
        text += (text.empty() ? "A hidden scene" : "") +
                fmt::format(", reconstructed by {}", methods_text(views));
    }
    if (views.truth) {
        text += (text.empty() ? "The true scene " : ", beside the true scene ") + views.truth->name;
    }
    if (text.empty()) return contents_text(results);
    return text + ". On this page: " + contents_text(results) + ".";
}

std::string space_caption(const ResultsFolder& results) {
    const PageViews& views = results.views;
    std::vector<std::string> things{"the relay wall"};
    if (views.scan) things.front() += " with its scan points";
    if (!views.results.empty()) {
        things.push_back("what was reconstructed by " + methods_text(views));
    }
    if (views.truth) things.push_back("the true scene " + views.truth->name);
    std::string text = listed(things) + ".";
    text.front() = 'T';
    return text;
}

}  // namespace apps
