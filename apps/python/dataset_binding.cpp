// SPDX-License-Identifier: MIT
#include "apps/dataset/generate.h"
#include "apps/python/bindings.h"
#include "apps/version.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

namespace python {
namespace {

namespace nb = nanobind;

using Pair = std::pair<std::uint64_t, std::uint64_t>;

std::vector<std::string> overrides_of(const nb::dict& keywords) {
    std::vector<std::string> overrides;
    const core::Json json = json_from_python(keywords, "");
    for (const auto& [key, value] : json.items()) overrides.push_back(key + "=" + value.dump());
    return overrides;
}

nb::object generate(const std::string& recipe,
                    const std::string& folder,
                    const std::optional<Pair>& shard,
                    const std::optional<Pair>& items,
                    const nb::dict& keywords,
                    const nb::object& progress,
                    int threads) {
    apps::WorkShare share;
    if (shard) {
        share = apps::read_work_share(std::to_string(shard->first) + "/" +
                                      std::to_string(shard->second));
    }
    std::optional<apps::ItemRange> range;
    if (items) range = apps::ItemRange{items->first, items->second};
    const std::vector<std::string> overrides = overrides_of(keywords);
    const core::Json result = run_long(progress, threads, [&](const core::Progress& report) {
        apps::Dataset dataset(apps::read_recipe(recipe, overrides), folder);
        const apps::GenerateResult made =
            apps::generate(dataset, share, range, apps::version_text(), report);
        for (const auto& [name, reason] : made.broken_meshes) {
            report.warn(name + " was skipped: " + reason);
        }
        return core::Json{{"shards_written", made.shards_written},
                          {"shards_there", made.shards_there},
                          {"items_written", made.items_written},
                          {"dark_items", made.dark_items},
                          {"clipped_counts", made.clipped_counts},
                          {"seconds", made.seconds},
                          {"interrupted", made.interrupted}};
    });
    return python_from_json(result);
}

}  // namespace

void bind_dataset(nb::module_& module) {
    module.def("generate",
               &generate,
               nb::arg("recipe"),
               nb::arg("folder"),
               nb::arg("shard").none(),
               nb::arg("item_range").none(),
               nb::arg("settings"),
               nb::arg("progress").none(),
               nb::arg("threads"));
}

}  // namespace python
