// SPDX-License-Identifier: MIT
// How the bookkeeping of a data set grows with its shards: manifests and small files in place of
// real shards, then what a resumed run, --verify and --merge do with them.
//   dataset_bookkeeping [SHARDS ...]      default: 100 1000 10000
#include "apps/batch/checksum.h"
#include "apps/dataset/dataset_index.h"
#include "apps/dataset/generate.h"
#include "renderer/core/stopwatch.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <fmt/core.h>

#include <cstdlib>
#include <filesystem>

namespace {

constexpr std::uint64_t kItemsPerShard = 100;

apps::Recipe recipe_of(std::uint64_t shards) {
    apps::Recipe recipe;
    recipe.items = shards * kItemsPerShard;
    recipe.items_per_shard = kItemsPerShard;
    recipe.calibration_items = 0;
    recipe.meshes.shapes = {apps::BasicShape::Sphere};
    return recipe;
}

void write_shards(const apps::Dataset& dataset) {
    for (std::uint64_t shard = 0; shard < dataset.num_shards(); ++shard) {
        apps::Manifest manifest;
        manifest.fingerprint = dataset.fingerprint();
        manifest.program = "benchmark";
        manifest.file = apps::shard_name(shard) + ".h5";
        manifest.items = dataset.items_of(shard);
        const std::string path = dataset.folder() + "/" + manifest.file;
        test_support::write_file_bytes(path, std::string(1000, static_cast<char>(shard)));
        manifest.bytes = 1000;
        manifest.checksum = *apps::file_checksum(path);
        for (const char* key : {"albedo", "photons", "x_m", "y_m", "z_m"}) {
            manifest.drawn[key].assign(2 * kItemsPerShard, 0.123456789 + double(shard));
        }
        apps::write_manifest(manifest, apps::manifest_path(dataset.folder(), shard));
    }
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::uint64_t> counts;
    for (int i = 1; i < argc; ++i) counts.push_back(std::strtoull(argv[i], nullptr, 10));
    if (counts.empty()) counts = {100, 1000, 10000};
    fmt::print("{:>8} {:>10} {:>10} {:>10} {:>10}\n",
               "shards",
               "write s",
               "resume s",
               "verify s",
               "merge s");
    for (const std::uint64_t count : counts) {
        const test_support::TemporaryFolder folder;
        apps::Dataset dataset(recipe_of(count), folder.path().string());
        dataset.claim_folder({});
        const core::Stopwatch writing;
        write_shards(dataset);
        const double written = writing.seconds();
        const core::Stopwatch resuming;
        const apps::GenerateResult nothing =
            apps::generate(dataset, {}, std::nullopt, "benchmark", {});
        const double resumed = resuming.seconds();
        const core::Stopwatch verifying;
        const apps::DatasetIndex index =
            apps::read_dataset(dataset.folder(), apps::ShardCheck::Contents);
        const double verified = verifying.seconds();
        const core::Stopwatch merging;
        apps::write_index(index, dataset.folder());
        fmt::print("{:>8} {:>10.3f} {:>10.3f} {:>10.3f} {:>10.3f}\n",
                   count,
                   written,
                   resumed,
                   verified,
                   merging.seconds());
        if (nothing.shards_there != count || !index.problems.empty()) return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
