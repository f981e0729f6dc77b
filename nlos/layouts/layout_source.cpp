// SPDX-License-Identifier: MIT
#include "nlos/layouts/layout_capture.h"
#include "nlos/layouts/layout_histograms.h"
#include "renderer/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace nlos {
namespace {

namespace fs = std::filesystem;
using core::Error;

std::vector<std::string> files_in(const std::string& folder) {
    constexpr std::size_t kMost = 100000;
    std::vector<std::string> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        if (files.size() < kMost && entry.is_regular_file()) files.push_back(entry.path().string());
    }
    std::sort(files.begin(), files.end());
    return files;
}

bool is_of(const std::string& file, const Layout& layout) {
    return container_of(file) && mismatches(LayoutFiles(file), layout).empty();
}

}  // namespace

std::optional<LayoutSource> find_layout_source(const std::string& path) {
    const bool is_folder = fs::is_directory(path);
    // A folder is what its first files are; more than these are not looked at.
    constexpr std::size_t kMostTried = 8;
    std::vector<std::string> candidates{path};
    if (is_folder) candidates = files_in(path);
    if (candidates.size() > kMostTried) candidates.resize(kMostTried);
    for (const std::string& candidate : candidates) {
        if (!container_of(candidate)) continue;
        const LayoutFiles files(candidate);
        for (const Layout& layout : shipped_layouts()) {
            if (!mismatches(files, layout).empty()) continue;
            return is_folder ? layout_source(path, layout) : LayoutSource{layout, {path}};
        }
    }
    return std::nullopt;
}

LayoutSource layout_source(const std::string& path, const Layout& layout) {
    if (!fs::is_directory(path)) return {layout, {path}};
    LayoutSource source{layout, {}};
    for (const std::string& file : files_in(path)) {
        if (!is_of(file, layout)) continue;
        source.files.push_back(file);
        if (!layout.files_are_frames) return source;
    }
    if (source.files.empty()) {
        throw Error(
            path, "holds no file of layout " + layout.name, "must be such a file or folder");
    }
    return source;
}

LayoutSource sequence_source(const std::vector<std::string>& files, const Layout& layout) {
    if (!layout.files_are_frames) {
        throw Error(files.front(),
                    fmt::format("is the first of {} files of layout {}", files.size(), layout.name),
                    "must stand alone: files of this layout are no frames of a sequence");
    }
    for (const std::string& file : files) {
        if (is_of(file, layout)) continue;
        throw Error(file, "is not of layout " + layout.name, "must be, as the frames before");
    }
    return {layout, files};
}

}  // namespace nlos
