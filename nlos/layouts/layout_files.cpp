// SPDX-License-Identifier: MIT
#include "nlos/layouts/layout_files.h"

#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace nlos {

namespace fs = std::filesystem;
using core::Error;

LayoutFiles::LayoutFiles(std::string path)
    : path_(std::move(path)), main_(std::make_unique<ArrayReader>(path_)) {}

std::optional<LayoutFiles::Source> LayoutFiles::find_source(const std::string& array) const {
    if (main_->has(array)) return Source{main_.get(), array};
    const std::size_t colon = array.find(':');
    if (colon == std::string::npos) return std::nullopt;
    const std::string name = array.substr(colon + 1);
    if (main_->has(name)) return Source{main_.get(), name};
    const fs::path file =
        fs::path(path_).parent_path() / fs::path(array.substr(0, colon)).filename();
    auto& reader = beside_[file.string()];
    if (!reader) {
        if (!fs::is_regular_file(file)) return std::nullopt;
        reader = std::make_unique<ArrayReader>(file.string());
    }
    if (!reader->has(name)) return std::nullopt;
    return Source{reader.get(), name};
}

LayoutFiles::Source LayoutFiles::find(const std::string& array) const {
    if (const auto source = find_source(array)) return *source;
    throw Error(where(array), "is missing or empty", "must be an array with values");
}

bool LayoutFiles::has(const std::string& array) const {
    return find_source(array).has_value();
}

std::string LayoutFiles::where(const std::string& array) const {
    return path_ + ": " + array;
}

Shape LayoutFiles::shape(const std::string& array) const {
    const Source source = find(array);
    Shape shape = source.reader->shape(source.name);
    if (source.reader->first_index_fastest()) std::reverse(shape.begin(), shape.end());
    return shape;
}

bool LayoutFiles::first_index_fastest(const std::string& array) const {
    return find(array).reader->first_index_fastest();
}

std::vector<double> LayoutFiles::read(const std::string& array) const {
    const Source source = find(array);
    return source.reader->read_doubles(source.name, source.reader->shape(source.name));
}

std::size_t LayoutFiles::peak_bin(const std::string& array) const {
    const Source source = find(array);
    Shape stored = source.reader->shape(source.name);
    const std::vector<double> values = source.reader->read_doubles(source.name, stored);
    while (!stored.empty() && stored.back() == 1) stored.pop_back();
    std::vector<double> sums(stored.empty() ? 1 : stored.back(), 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) sums[i % sums.size()] += values[i];
    return static_cast<std::size_t>(std::ranges::max_element(sums) - sums.begin());
}

std::optional<double> LayoutFiles::number(const LayoutNumber& number,
                                          const std::string& setting) const {
    if (number.value) return *number.value;
    if (!number.array.empty()) {
        const std::vector<double> values = read(number.array);
        const auto element = static_cast<std::size_t>(number.element);
        if (element >= values.size() || !std::isfinite(values[element])) {
            throw Error(where(number.array),
                        element < values.size() ? fmt::format("found {}", values[element])
                                                : fmt::format("holds {} values", values.size()),
                        fmt::format("must have a finite number at {}", element));
        }
        return values[element] * number.factor + number.offset;
    }
    if (!number.step_of.empty()) {
        const std::vector<double> values = read(number.step_of);
        if (values.size() < 2 || !std::isfinite(values.back() - values.front())) {
            throw Error(where(number.step_of),
                        fmt::format("holds {} values", values.size()),
                        "must hold at least two finite ones");
        }
        const auto steps = static_cast<double>(values.size() - 1);
        return (values.back() - values.front()) / steps * number.factor + number.offset;
    }
    if (!number.peak_of.empty()) {
        return static_cast<double>(peak_bin(number.peak_of)) * number.factor + number.offset;
    }
    if (number.ask.empty()) return std::nullopt;
    throw Error(path_,
                "does not hold " + setting,
                fmt::format("must be given as --set {}=... ({})", setting, number.ask));
}

}  // namespace nlos
