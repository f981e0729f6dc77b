// SPDX-License-Identifier: MIT
#pragma once

#include "apps/page/page_pictures.h"
#include "apps/page/page_views.h"

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace apps {

/// How much a page has room for: all that it shows, apart from its style sheet and scripts, takes
/// at most `limit_bytes`.
struct PageRoom {
    static constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

    double limit_bytes = 0.0;
    double whole_bytes = 0.0;         ///< of the same page with everything on it
    std::size_t longest_json = kAll;  ///< settings and documents with more characters are left out
    std::size_t most_in_section = kAll;  ///< results shown in full; the others are named
    FittedViews views{};
    PagePictures pictures{};
};

/// Finds what a page has room for. Text that takes more than half of it loses long settings, then
/// all of them, then results that are shown in full. Pictures and views share the rest: what one of
/// them leaves of its half, the other may take.
///
/// limit_bytes       of all but style sheet and scripts
/// longest_section   so many results has the section with the most
/// text_of           the page's text without its views, its pictures by PageRoom::pictures
PageRoom fit_page(const PageViews& views,
                  double limit_bytes,
                  std::size_t longest_section,
                  const std::function<std::string(PageRoom&)>& text_of);

/// What is not on the page as it is, and what --data-mb would show it all; empty: everything is.
std::string reductions_text(const PageViews& views, const PageRoom& room);

/// The names of files that a page has no room to show, as far as there is room for these.
std::string names_html(const std::vector<std::string>& names, const PageRoom& room);

/// The first results of a section in full, the others by their files' names.
template <class Results, class HtmlOf>
std::string listed_html(Results&& results, const PageRoom& room, const HtmlOf& html_of) {
    std::string html;
    std::vector<std::string> others;
    std::size_t number = 0;
    for (const auto& result : results) {
        if (number++ < room.most_in_section) {
            html += html_of(result);
        } else {
            others.push_back(result.file);
        }
    }
    return html + names_html(others, room);
}

}  // namespace apps
