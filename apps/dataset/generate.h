// SPDX-License-Identifier: MIT
#pragma once

#include "apps/batch/work_share.h"
#include "apps/dataset/manifest.h"
#include "apps/dataset/recipe.h"
#include "renderer/core/progress.h"

#include <cstdint>
#include <optional>
#include <string>

namespace apps {

/// A data set in its folder: a recipe and the meshes that it names now.
class Dataset {
 public:
    /// throws   core::Error when the recipe's meshes do not exist
    Dataset(Recipe recipe, std::string folder);

    const Recipe& recipe() const { return recipe_; }
    /// The recipe as items are computed: after claim_folder(), with the tolerance of elements found
    /// for all of them.
    const Recipe& item_recipe() const { return item_recipe_; }
    const std::string& folder() const { return folder_; }
    /// Tells data sets apart: of everything that items follow from, their number left out.
    const std::string& fingerprint() const { return fingerprint_; }
    std::uint64_t num_shards() const;
    /// The items that a shard has when it is whole.
    ItemRange items_of(std::uint64_t shard) const;

    /// Writes the recipe, and what find_element_tolerance() says of it, into the folder, which it
    /// makes; a folder that was claimed before is asked instead.
    ///
    /// returns  whether nobody had claimed it before
    /// throws   core::Error when the folder holds another data set, or one of more items;
    ///          core::Failure when asked to stop
    bool claim_folder(const core::Progress& progress);
    /// Takes the claim back.
    void give_up_folder() const;

    MeshLibrary& meshes() { return meshes_; }

 private:
    std::string claim() const;
    void use_tolerance(const std::optional<double>& tolerance);
    void write_claim(const std::string& path) const;

    Recipe recipe_;
    Recipe item_recipe_;
    std::string folder_;
    MeshLibrary meshes_;
    std::string fingerprint_;
};

/// What a run did.
struct GenerateResult : ItemTotals {
    std::uint64_t shards_written = 0;
    std::uint64_t shards_there = 0;  ///< which were whole before
    std::uint64_t items_written = 0;
    double seconds = 0.0;
    bool interrupted = false;
};

/// Makes the shards of a data set that are missing or damaged, each whole or not at all, with its
/// manifest beside it; several processes may work in the same folder, each on its share. Items are
/// computed side by side, each on one thread, and kept in memory only until their turn to be
/// written.
///
/// share      shards that this process makes
/// items      only these, if given; a shard of which others are there already keeps them
/// program    what makes them, for people
/// progress   announced to before the work; asked after every item whether to stop: the shard in
/// work is then given up throws     core::Error, core::Failure as make_item() does, naming the item
GenerateResult generate(Dataset& dataset,
                        const WorkShare& share,
                        const std::optional<ItemRange>& items,
                        const std::string& program,
                        const core::Progress& progress);

}  // namespace apps
