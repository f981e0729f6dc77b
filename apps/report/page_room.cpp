// SPDX-License-Identifier: MIT
#include "apps/report/page_room.h"

#include "apps/page/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace apps {
namespace {

constexpr double kReserve = 4096.0;       // bytes, for what the page says of what is not on it
constexpr double kNamesOfSection = 0.02;  // of the limit, at most

/// Takes text away. returns   whether there was any
///
/// ratio   of what the text takes to what it may take
bool reduce(PageRoom& room, std::size_t longest_section, double ratio) {
    if (room.longest_json > 0) {
        const bool is_first = room.longest_json == PageRoom::kAll;
        room.longest_json = is_first ? static_cast<std::size_t>(room.limit_bytes / 200.0) : 0;
        return true;
    }
    const std::size_t most = std::min(room.most_in_section, longest_section);
    if (most == 0) return false;
    room.most_in_section =
        std::min(most - 1, static_cast<std::size_t>(static_cast<double>(most) / ratio));
    return true;
}

}  // namespace

PageRoom fit_page(const PageViews& views,
                  double limit_bytes,
                  std::size_t longest_section,
                  const std::function<std::string(PageRoom&)>& text_of) {
    PageRoom room{limit_bytes};
    const auto measure = [&] {
        room.pictures = {};
        return static_cast<double>(text_of(room).size());
    };
    double text = measure();
    const double pictures = room.pictures.whole_bytes();
    const double limit = limit_bytes - kReserve;
    const double rest = limit - std::min(text, 0.5 * limit);
    room.views = fit_views(views, std::max(0.5 * rest, rest - pictures));
    room.whole_bytes = text + pictures + room.views.whole_bytes;
    const auto data = static_cast<double>(room.views.data.size());
    const double most_text = std::max(0.5 * limit, limit - data - pictures);
    text = measure();  // which depends on the views that are shown
    while (text > most_text && reduce(room, longest_section, text / most_text)) text = measure();
    room.pictures.fit(limit - text - data);
    return room;
}

std::string reductions_text(const PageViews& views, const PageRoom& room) {
    std::vector<std::string> parts;
    const auto add = [&]<class... Values>(
                         bool holds, fmt::format_string<Values...> text, Values&&... values) {
        if (holds) parts.push_back(fmt::format(text, std::forward<Values>(values)...));
    };
    const ViewDetail& detail = room.views.detail;
    const std::size_t results = views.results.size();
    const std::size_t animations = views.animations.size();
    add(!detail.has_views, "there are no interactive views");
    add(detail.has_views && detail.halvings > 0, "volumes and animations are coarser");
    add(detail.has_views && detail.most < results,
        "{} of {} reconstructions are in the 3-D view, side by side and in slices",
        detail.most,
        results);
    add(detail.has_views && detail.most < animations,
        "{} of {} captures are animated",
        detail.most,
        animations);
    const PagePictures& pictures = room.pictures;
    add(pictures.num_reduced() > 0,
        "{} of {} pictures are thumbnails",
        pictures.num_reduced(),
        pictures.count());
    add(pictures.num_left_out() > 0,
        "{} of {} pictures are left out",
        pictures.num_left_out(),
        pictures.count());
    add(room.longest_json == 0, "settings and other JSON are left out");
    add(room.longest_json != PageRoom::kAll && room.longest_json > 0,
        "settings and other JSON of more than {} characters are left out",
        room.longest_json);
    add(room.most_in_section != PageRoom::kAll,
        "each section shows at most {} results and names the others",
        room.most_in_section);
    if (parts.empty()) return "";
    return fmt::format(
        "To keep this page within {:.4g} MB beside its scripts: {}. With --data-mb {:.0f} it shows "
        "everything.",
        1e-6 * room.limit_bytes,
        fmt::join(parts, "; "),
        std::ceil(1e-6 * (room.whole_bytes + 2.0 * kReserve)));
}

std::string names_html(const std::vector<std::string>& names, const PageRoom& room) {
    if (names.empty()) return "";
    std::string html = fmt::format(
        "<details><summary>{} more, by name only</summary><ul class=\"names\">", names.size());
    const double most = kNamesOfSection * room.limit_bytes + static_cast<double>(html.size());
    std::size_t named = 0;
    for (const std::string& name : names) {
        if (static_cast<double>(html.size()) > most) break;
        html += "<li>" + escape_html(name) + "</li>";
        ++named;
    }
    if (named < names.size()) html += fmt::format("<li>and {} more</li>", names.size() - named);
    return html + "</ul></details>\n";
}

}  // namespace apps
