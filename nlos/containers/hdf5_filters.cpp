// SPDX-License-Identifier: MIT
#include "nlos/containers/hdf5_filters.h"

#include "renderer/core/error.h"

#include <fmt/core.h>
#include <hdf5.h>

#include <array>
#include <map>

namespace nlos {
namespace {

/// A filter as people call it and the Debian package that has it, if any.
struct FilterFacts {
    const char* name;
    const char* package = nullptr;
};

/// By the numbers that the HDF Group gave them.
const FilterFacts* facts_of(H5Z_filter_t filter) {
    static const std::map<H5Z_filter_t, FilterFacts> known{
        {H5Z_FILTER_SZIP, {"szip"}},
        {305, {"lzo"}},
        {307, {"bzip2", "hdf5-filter-plugin"}},
        {32000, {"lzf", "hdf5-plugin-lzf"}},
        {32001, {"blosc", "hdf5-filter-plugin-blosc-serial"}},
        {32004, {"lz4", "hdf5-filter-plugin"}},
        {32008, {"bitshuffle", "hdf5-filter-plugin"}},
        {32013, {"zfp", "hdf5-filter-plugin-zfp-serial"}},
        {32015, {"zstd"}},
        {32017, {"sz"}},
        {32024, {"sz3"}},
        {32026, {"blosc2"}}};
    const auto found = known.find(filter);
    return found == known.end() ? nullptr : &found->second;
}

/// Calls `visit` with each filter that is not there and how it is called.
template <class Visit>
void for_each_missing(const Hdf5Handle& dataset, Visit&& visit) {
    const Hdf5Handle plan(H5Dget_create_plist(dataset.id()), H5Pclose);
    const int count = H5Pget_nfilters(plan.id());
    for (int i = 0; i < count; ++i) {
        std::array<char, 64> stored{};
        unsigned flags = 0;
        unsigned config = 0;
        std::size_t values = 0;
        const H5Z_filter_t filter = H5Pget_filter2(plan.id(),
                                                   static_cast<unsigned>(i),
                                                   &flags,
                                                   &values,
                                                   nullptr,
                                                   stored.size() - 1,
                                                   stored.data(),
                                                   &config);
        if (filter < 0 || H5Zfilter_avail(filter) > 0) continue;
        const FilterFacts* facts = facts_of(filter);
        visit(facts != nullptr    ? std::string(facts->name)
              : stored[0] != '\0' ? std::string(stored.data())
                                  : fmt::format("filter {}", filter),
              facts);
    }
}

}  // namespace

std::string missing_filters(const Hdf5Handle& dataset) {
    std::string names;
    for_each_missing(dataset, [&](const std::string& name, const FilterFacts*) {
        names += (names.empty() ? "" : ", ") + name;
    });
    return names;
}

void require_filters(const Hdf5Handle& dataset, const std::string& path, const std::string& name) {
    std::string packages;
    for_each_missing(dataset, [&](const std::string&, const FilterFacts* facts) {
        if (facts == nullptr || facts->package == nullptr) return;
        packages += fmt::format(", or after `apt install {}`", facts->package);
    });
    const std::string names = missing_filters(dataset);
    if (names.empty()) return;
    throw core::Error(
        path + ": " + name,
        "is compressed by " + names + ", which HDF5 does not know here",
        fmt::format(
            "must be repacked where it does: h5repack -f GZIP=4 {} REPACKED.h5{}", path, packages));
}

}  // namespace nlos
