// SPDX-License-Identifier: MIT
#include "apps/dataset/generate.h"

#include "apps/batch/checksum.h"
#include "apps/dataset/element_tolerance.h"
#include "apps/dataset/item_preview.h"
#include "nlos/pictures/picture.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/stopwatch.h"
#include "renderer/core/system/output_file.h"
#include "renderer/core/system/parallel.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

namespace apps {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecipeFile = "recipe.json";

/// Numbers among the drawn values and those of objects, by key.
void note_drawn(const core::Json& parameters, std::map<std::string, std::vector<double>>& drawn) {
    const auto note = [&](const std::string& key, const core::Json& value) {
        if (value.is_number()) drawn[key].push_back(value.get<double>());
    };
    for (const auto& [key, value] : parameters.at("drawn").items()) note(key, value);
    const core::Json& objects = parameters.at("objects");
    note("objects.count", objects.size());
    for (const core::Json& object : objects) {
        note("objects.albedo", object.at("albedo"));
        for (const std::size_t axis : {0, 1, 2}) {
            note(fmt::format("objects.{}_m", "xyz"[axis]), object.at("position_m")[axis]);
        }
    }
}

/// An item that was computed and waits for its turn.
struct MadeItem {
    Item item;
    PackedItem packed;
    std::vector<nlos::Panel> preview;  ///< of the first few of the data set
};

constexpr std::uint64_t kPreviewItems = 6;

MadeItem make_packed(Dataset& dataset, std::uint64_t number, const core::Progress& progress) {
    MadeItem made;
    core::run_on_one_thread([&] {
        made.item = make_item(dataset.item_recipe(), dataset.meshes(), number, progress);
        if (made.item.interrupted) return;
        if (number < std::min(kPreviewItems, dataset.recipe().items_per_shard))
            made.preview = preview_panels(dataset.recipe(), made.item);
        const core::ThreadStopwatch clock;
        made.packed = pack_item(dataset.recipe(), made.item);
        made.item.profile.packing += clock.seconds();
    });
    return made;
}

void note_item(Dataset& dataset, const Item& item, Manifest& manifest) {
    manifest.profile.add(item.profile);
    for (const std::size_t index : item.broken_meshes) {
        manifest.broken_meshes[dataset.meshes().name(index)] = dataset.meshes().why_broken(index);
    }
    manifest.dark_items += item.is_dark ? 1 : 0;
    manifest.clipped_counts += item.clipped_counts;
    note_drawn(item.parameters, manifest.drawn);
}

/// Computes items side by side and writes them in their order.
/// returns   nothing when the run was asked to stop
std::optional<Manifest> make_shard(Dataset& dataset,
                                   std::uint64_t shard,
                                   const ItemRange& items,
                                   const std::string& program,
                                   const core::Progress& progress,
                                   const std::function<bool()>& next_item) {
    const core::Stopwatch clock;
    Manifest manifest;
    manifest.fingerprint = dataset.fingerprint();
    manifest.program = program;
    const bool is_hdf5 = dataset.recipe().format == DatasetFormat::Hdf5;
    manifest.file = shard_name(shard) + (is_hdf5 ? ".h5" : ".tar");
    manifest.items = items;
    const std::string path = (fs::path(dataset.folder()) / manifest.file).string();
    std::vector<nlos::Panel> preview;
    std::size_t preview_columns = 0;
    const auto writer = make_shard_writer(dataset.recipe(), path, items, program);
    const bool is_whole = core::parallel_in_order<MadeItem>(
        items.size(),
        [&](std::size_t i) { return make_packed(dataset, items.begin + i, progress); },
        [&](std::size_t i, MadeItem made) {
            if (made.item.interrupted) return false;
            const core::ThreadStopwatch writing;
            writer->add(std::move(made.packed));
            note_item(dataset, made.item, manifest);
            if (!made.preview.empty()) preview_columns = made.preview.size();
            std::move(made.preview.begin(), made.preview.end(), std::back_inserter(preview));
            manifest.profile.packing += writing.seconds();
            return next_item() || i + 1 == items.size();  // a whole shard is kept
        });
    if (!is_whole) return std::nullopt;
    writer->finish();
    if (!preview.empty()) {
        for (const char* suffix : {".svg", ".png"}) {
            nlos::write_panels(
                preview_path(dataset.folder(), suffix), preview, static_cast<int>(preview_columns));
        }
    }
    manifest.bytes = fs::file_size(path);
    manifest.checksum = file_checksum(path).value_or("");
    manifest.seconds = clock.seconds();
    return manifest;
}

/// A shard that is not all there, and what of it shall be.
struct MissingShard {
    std::uint64_t shard;
    ItemRange items;
};

std::vector<MissingShard> find_missing(const Dataset& dataset,
                                       const WorkShare& share,
                                       const ItemRange& wanted,
                                       std::uint64_t& shards_there) {
    std::vector<MissingShard> missing;
    for (std::uint64_t shard = 0; shard < dataset.num_shards(); ++shard) {
        if (!share.takes(shard)) continue;
        const ItemRange all = dataset.items_of(shard);
        ItemRange items{std::max(all.begin, wanted.begin), std::min(all.end, wanted.end)};
        if (items.begin >= items.end) continue;
        const auto manifest = read_manifest(manifest_path(dataset.folder(), shard));
        if (manifest && manifest->fingerprint == dataset.fingerprint() &&
            !find_damage(*manifest, dataset.folder())) {
            if (manifest->items.contains(items)) {
                ++shards_there;
                continue;
            }
            items = {std::min(items.begin, manifest->items.begin),
                     std::max(items.end, manifest->items.end)};
        }
        missing.push_back({shard, items});
    }
    return missing;
}

}  // namespace

Dataset::Dataset(Recipe recipe, std::string folder)
    : recipe_(std::move(recipe)),
      item_recipe_(recipe_),
      folder_(std::move(folder)),
      meshes_(recipe_),
      fingerprint_(text_checksum(write_identity(recipe_).dump() + meshes_.listing().dump())) {}

std::uint64_t Dataset::num_shards() const {
    return (recipe_.items + recipe_.items_per_shard - 1) / recipe_.items_per_shard;
}

ItemRange Dataset::items_of(std::uint64_t shard) const {
    const std::uint64_t begin = shard * recipe_.items_per_shard;
    return {begin, std::min(recipe_.items, begin + recipe_.items_per_shard)};
}

bool Dataset::claim_folder(const core::Progress& progress) {
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) throw core::Error(folder_, error.message(), "must be a folder, or a place for one");
    const std::string path = (fs::path(folder_) / kRecipeFile).string();
    const bool is_new = !fs::exists(path, error);
    if (is_new) {
        use_tolerance(find_element_tolerance(recipe_, meshes_, progress));
        write_claim(path);
    }
    // Another process may have been faster, with this recipe or another one.
    const core::Json there = core::read_json_file(path);
    const auto fingerprint = there.find("fingerprint");
    const auto known = there.find("element_tolerance");
    if (fingerprint == there.end() || *fingerprint != fingerprint_ || known == there.end()) {
        throw core::Error(folder_,
                          "holds the data set of another recipe",
                          "must be a new folder, or that of this recipe and these meshes");
    }
    std::optional<double> tolerance;
    core::read_value(*known, path + ": element_tolerance", tolerance);
    use_tolerance(tolerance);
    const std::uint64_t items = there.at("recipe").at("items").get<std::uint64_t>();
    if (items > recipe_.items) {
        throw core::Error(folder_,
                          fmt::format("holds the data set of {} items", items),
                          "must be that of at most as many as are asked for: they can only grow");
    }
    if (items < recipe_.items) core::write_text_file(path, claim());
    return is_new;
}

std::string Dataset::claim() const {
    return core::json_text(
        {{"fingerprint", fingerprint_},
         {"element_tolerance", core::write_value(item_recipe_.scene.render.element_tolerance)},
         {"recipe", core::write_value(recipe_)}});
}

void Dataset::use_tolerance(const std::optional<double>& tolerance) {
    item_recipe_ = recipe_;
    if (!tolerance) return;
    item_recipe_.scene.render.element_tolerance = tolerance;
    item_recipe_.scene.render.target_error.reset();
}

/// Writes the recipe unless somebody else has done so: of two that try at once, one succeeds.
void Dataset::write_claim(const std::string& path) const {
    const std::string own = path + fmt::format(".{}", ::getpid());
    core::write_text_file(own, claim());
    std::error_code taken;
    fs::create_hard_link(own, path, taken);
    std::error_code ignored;
    if (taken && !fs::exists(path, ignored)) fs::rename(own, path);  // without hard links
    fs::remove(own, ignored);
}

void Dataset::give_up_folder() const {
    std::error_code ignored;
    fs::remove(fs::path(folder_) / kRecipeFile, ignored);
}

namespace {

/// Makes what is missing of some items; all, unless these are named.
void make_missing(Dataset& dataset,
                  const WorkShare& share,
                  const std::optional<ItemRange>& items,
                  const std::string& program,
                  const core::Progress& progress,
                  GenerateResult& result) {
    const core::Stopwatch clock;
    const ItemRange wanted = items.value_or(ItemRange{0, dataset.recipe().items});
    const auto missing = find_missing(dataset, share, wanted, result.shards_there);
    std::uint64_t total = 0;
    for (const MissingShard& shard : missing) total += shard.items.size();
    std::uint64_t done = 0;
    core::Progress stopping;
    stopping.stop_requested = progress.stop_requested;
    for (const MissingShard& shard : missing) {
        auto manifest = make_shard(dataset, shard.shard, shard.items, program, stopping, [&] {
            ++done;
            progress.update(
                static_cast<double>(done) / static_cast<double>(total),
                fmt::format("{:.3g} items/s", static_cast<double>(done) / clock.seconds()));
            return !progress.should_stop();
        });
        if (!manifest) {
            result.interrupted = true;
            break;
        }
        manifest->asked = items;
        write_manifest(*manifest, manifest_path(dataset.folder(), shard.shard));
        ++result.shards_written;
        result.items_written += manifest->items.size();
        result.add(*manifest);
    }
}

}  // namespace

GenerateResult generate(Dataset& dataset,
                        const WorkShare& share,
                        const std::optional<ItemRange>& items,
                        const std::string& program,
                        const core::Progress& progress) {
    const core::Stopwatch clock;
    const ItemRange all{0, dataset.recipe().items};
    const ItemRange wanted = items.value_or(all);
    if (wanted.begin >= wanted.end || !all.contains(wanted)) {
        throw core::Error("items",
                          fmt::format("found {} to {}", wanted.begin, wanted.end),
                          fmt::format("must rise within 0 to {}", all.end));
    }
    const bool is_new = dataset.claim_folder(progress);
    GenerateResult result;
    try {
        make_missing(dataset, share, items, program, progress, result);
    } catch (const core::Error&) {
        // The recipe is at fault: once mended it is another one, which may have this folder.
        if (is_new && result.shards_written + result.shards_there == 0) dataset.give_up_folder();
        throw;
    }
    result.seconds = clock.seconds();
    return result;
}

}  // namespace apps
