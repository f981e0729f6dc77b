// SPDX-License-Identifier: MIT
#include "renderer/core/nearest_name.h"

#include <algorithm>
#include <cctype>

namespace core {
namespace {

constexpr std::size_t kLongest = 80;           // of a name that anyone could have meant
constexpr std::size_t kShortestBeginning = 3;  // that says which name was meant
constexpr std::size_t kCharactersPerChange = 3;

std::string plain(std::string_view name) {
    std::string text = lower_case(std::string(name));
    std::ranges::replace(text, '_', '-');
    return text;
}

// Changes of one character, swaps of two neighbours among them, that make one text the other.
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> changes(a.size() + 1,
                                                  std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) {
        for (std::size_t j = 0; j <= b.size(); ++j) {
            std::size_t& least = changes[i][j];
            if (i == 0 || j == 0) {
                least = i + j;
                continue;
            }
            least = std::min({changes[i - 1][j] + 1,
                              changes[i][j - 1] + 1,
                              changes[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
            const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (swapped) least = std::min(least, changes[i - 2][j - 2] + 1);
        }
    }
    return changes[a.size()][b.size()];
}

}  // namespace

std::string lower_case(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

std::string nearest_name(std::string_view found, const std::vector<std::string>& known) {
    if (found.empty() || found.size() > kLongest) return "";
    const std::string wanted = plain(found);
    std::string nearest;
    std::size_t least = wanted.size() / kCharactersPerChange + 1;  // changes are fewer than this
    std::vector<std::string> begun;
    for (const std::string& name : known) {
        if (name.size() > kLongest) continue;
        const std::string candidate = plain(name);
        if (candidate.starts_with(wanted)) begun.push_back(name);
        const std::size_t changes = edit_distance(wanted, candidate);
        if (changes >= least) continue;
        least = changes;
        nearest = name;
    }
    if (nearest.empty() && begun.size() == 1 && wanted.size() >= kShortestBeginning) {
        return begun.front();
    }
    return nearest;
}

std::string did_you_mean(std::string_view found, const std::vector<std::string>& known) {
    const std::string name = nearest_name(found, known);
    return name.empty() ? "" : "did you mean '" + name + "'? ";
}

}  // namespace core
