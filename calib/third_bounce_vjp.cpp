// SPDX-License-Identifier: MIT
#include "calib/third_bounce_vjp.h"

#include "calib/adjoint/pair_evaluator.h"
#include "renderer/core/error.h"
#include "renderer/core/system/parallel.h"
#include "renderer/recentred.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <utility>

namespace calib {
namespace {

using core::Error;

constexpr const char* kWhere = "third_bounce_vjp";

void check_mesh(const core::TriangleMesh& mesh, const std::vector<double>& albedo) {
    const std::string where = kWhere;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        core::require(mesh.vertices[i].allFinite(),
                      where + ": mesh",
                      fmt::format("vertex {} that is not finite", i),
                      "finite numbers");
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (const std::uint32_t vertex : mesh.triangles[i]) {
            core::require(vertex < mesh.vertices.size(),
                          where + ": mesh",
                          fmt::format("vertex {} in triangle {}", vertex, i),
                          fmt::format("below the number of vertices, {}", mesh.vertices.size()));
        }
    }
    core::require(albedo.size() == mesh.triangles.size(),
                  where + ": albedo",
                  fmt::format("{} values", albedo.size()),
                  fmt::format("one for each of {} triangles", mesh.triangles.size()));
    for (const double value : albedo) {
        core::check_range(value, {.low = 0.0, .with_low = true}, where + ": albedo");
    }
}

// Of [pair][item]; empty when there is nothing.
// Light and gradients are the same there, and rounding is small.
void move_to_origin(core::TriangleMesh& mesh, core::WallScan& scan) {
    Eigen::AlignedBox3d box;
    for (const core::Vec3& vertex : mesh.vertices) box.extend(vertex);
    for (const core::Vec3& point : scan.path_ends()) box.extend(point);
    const auto way = renderer::way_to_origin(box.center(), box.sizes().maxCoeff());
    if (!way) return;
    for (core::Vec3& vertex : mesh.vertices) vertex += *way;
    scan = core::moved(core::Scan(scan), *way).wall();
}

template <class T>
std::span<T> part_of_pair(std::span<T> all, std::size_t pair, std::size_t num_items) {
    return all.empty() ? all : all.subspan(pair * num_items, num_items);
}

// What is kept at most for the pullback, in bytes; beyond, elements are cut twice.
constexpr std::size_t kMostVisibility = std::size_t{1} << 28U;

// Pairs are evaluated in rounds, between which the caller may stop, and each round in blocks, which
// depend on the number of pairs only.
constexpr std::size_t kBlocksPerRound = 32;
constexpr std::size_t kLargestBlock = 32;

// Calls evaluate(block, begin, end) for the blocks of a round in parallel, then round_done().
void for_each_round(std::size_t num_pairs,
                    const core::Progress& progress,
                    const std::function<void(std::size_t, std::size_t, std::size_t)>& evaluate,
                    const std::function<void()>& round_done) {
    const std::size_t block = std::clamp(
        (num_pairs + kBlocksPerRound - 1) / kBlocksPerRound, std::size_t{1}, kLargestBlock);
    const std::size_t round = block * kBlocksPerRound;
    for (std::size_t first = 0; first < num_pairs; first += round) {
        if (progress.should_stop()) throw core::Failure(kWhere, "interrupted");
        const std::size_t count = std::min(round, num_pairs - first);
        core::parallel_blocks(count, block, [&](std::size_t begin, std::size_t end) {
            evaluate(begin / block, first + begin, first + end);
        });
        round_done();
        progress.update(static_cast<double>(first + count) / static_cast<double>(num_pairs),
                        fmt::format("{} pairs", first + count));
    }
}

}  // namespace

ThirdBounceVjp::ThirdBounceVjp(core::TriangleMesh mesh,
                               const std::vector<double>& albedo,
                               core::WallScan scan,
                               const core::TimeAxis& axis,
                               const ThirdBounceVjpSettings& settings,
                               const core::Progress& progress)
    : counted_((check_mesh(mesh, albedo),
                core::validate(scan, kWhere),
                move_to_origin(mesh, scan),
                std::move(mesh))),
      albedo_(counted_.of_facets(albedo)),
      scan_(std::move(scan)),
      axis_(axis),
      settings_(settings),
      tree_(counted_.mesh()) {
    core::check_ranges(settings_, kWhere);
    validate(axis_, std::string(kWhere) + ": time axis");
    const double smear_m = settings_.sigma_m > 0.0 ? settings_.sigma_m : 0.5 * axis_.bin_width_m;
    elements_ = cut_mesh(counted_.mesh(), tree_, scan_, smear_m, settings_.tolerance);
    const auto num_bins = static_cast<std::size_t>(axis_.num_bins);
    histograms_.assign(scan_.num_pairs() * num_bins, 0.0);
    const AdjointScene scene = this->scene();
    const std::size_t num_visible = scan_.num_pairs() * elements_.size();
    if (num_visible <= kMostVisibility) visibility_.resize(num_visible);
    const auto evaluate = [&](std::size_t, std::size_t begin, std::size_t end) {
        PairEvaluator evaluator(scene);
        for (std::size_t pair = begin; pair < end; ++pair) {
            evaluator.add(pair,
                          {histograms_.data() + pair * num_bins, num_bins},
                          part_of_pair(std::span(visibility_), pair, elements_.size()));
        }
    };
    for_each_round(scan_.num_pairs(), progress, evaluate, [] {});
}

AdjointScene ThirdBounceVjp::scene() const {
    const double wall = settings_.wall_albedo / core::kPi;
    return {counted_.mesh(),
            albedo_,
            tree_,
            elements_,
            scan_,
            axis_,
            wall * wall / core::kPi,
            settings_.sigma_m};
}

MeshGradients ThirdBounceVjp::pullback(std::span<const double> by_value,
                                       const core::Progress& progress) const {
    core::require(by_value.size() == histograms_.size(),
                  std::string(kWhere) + ": gradients by the histograms",
                  fmt::format("{} values", by_value.size()),
                  fmt::format("{} pairs x {} bins", scan_.num_pairs(), axis_.num_bins));
    for (const double value : by_value) {
        core::check_range(value, {}, std::string(kWhere) + ": gradients by the histograms");
    }
    const AdjointScene scene = this->scene();
    const auto num_bins = static_cast<std::size_t>(axis_.num_bins);
    MeshGradients total(counted_.mesh());
    const MeshGradients zero = total;
    std::vector<MeshGradients> partial(kBlocksPerRound, zero);
    const auto evaluate = [&](std::size_t block, std::size_t begin, std::size_t end) {
        PairEvaluator evaluator(scene);
        for (std::size_t pair = begin; pair < end; ++pair) {
            evaluator.pull(pair,
                           by_value.subspan(pair * num_bins, num_bins),
                           part_of_pair(std::span(visibility_), pair, elements_.size()),
                           partial[block]);
        }
    };
    for_each_round(scan_.num_pairs(), progress, evaluate, [&] {
        for (MeshGradients& sum : partial) {
            total += sum;
            sum = zero;
        }
    });
    return counted_.gradients_as_given(total);
}

}  // namespace calib
