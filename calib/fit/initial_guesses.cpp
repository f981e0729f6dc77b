// SPDX-License-Identifier: MIT
#include "calib/fit/initial_guesses.h"

#include "renderer/core/error.h"
#include "renderer/core/random.h"
#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

using core::Vec3;

constexpr std::uint64_t kRotationSeed = 0x726f74;

std::span<const double> histogram(const FitData& data, std::size_t pair) {
    const auto bins = static_cast<std::size_t>(data.axis.num_bins);
    return std::span(data.values).subspan(pair * bins, bins);
}

Vec3 mean_of(const std::vector<Vec3>& points) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& p : points) sum += p;
    return sum / static_cast<double>(points.size());
}

struct MeanPath {
    double opl_m = 0.0;
    double weight = 0.0;
};

MeanPath mean_path(const FitData& data, std::size_t pair, double ambient, double offset_m) {
    MeanPath mean;
    const auto values = histogram(data, pair);
    const core::BinRange seen = data.observed_range(pair);
    for (int b = seen.begin; b < seen.end; ++b) {
        // Excess below zero counts too: what ambient noise adds then cancels in the mean.
        const double excess = values[static_cast<std::size_t>(b)] - ambient;
        mean.weight += excess;
        mean.opl_m += excess * (data.axis.bin_center_m(b) - offset_m);
    }
    if (mean.weight > 0.0) mean.opl_m /= mean.weight;
    return mean;
}

}  // namespace

Vec3 trilaterate(const core::WallScan& scan,
                 const FitData& data,
                 double ambient,
                 const std::vector<double>& offset_m) {
    std::vector<MeanPath> paths(scan.num_pairs());
    double opl_sum = 0.0;
    double weight_sum = 0.0;
    for (std::size_t pair = 0; pair < paths.size(); ++pair) {
        MeanPath& path = paths[pair] = mean_path(data, pair, ambient, offset_m[pair]);
        const bool is_usable = path.weight > 0.0 && path.opl_m > data.axis.opl_start_m &&
                               path.opl_m < data.axis.opl_end_m();
        if (!is_usable) path.weight = 0.0;
        opl_sum += path.weight * path.opl_m;
        weight_sum += path.weight;
    }
    if (!(weight_sum > 0.0)) {
        throw core::Failure("fit", "the data hold no light beyond the ambient level to start from");
    }
    const Vec3 normal = mean_of(scan.sensing.normals).normalized();
    const Vec3 center = mean_of(scan.sensing.positions);
    Vec3 point = center + 0.5 * opl_sum / weight_sum * normal;
    constexpr int kIterations = 30;
    for (int iteration = 0; iteration < kIterations; ++iteration) {
        core::Mat3 information = 1e-6 * weight_sum * core::Mat3::Identity();
        Vec3 right = Vec3::Zero();
        for (std::size_t pair = 0; pair < paths.size(); ++pair) {
            if (paths[pair].weight == 0.0) continue;
            const Vec3 light = point - scan.illumination.positions[scan.illumination_index(pair)];
            const Vec3 sensor = point - scan.sensing.positions[scan.sensing_index(pair)];
            const Vec3 gradient = light.normalized() + sensor.normalized();
            const double misfit = paths[pair].opl_m - light.norm() - sensor.norm();
            information += paths[pair].weight * gradient * gradient.transpose();
            right += paths[pair].weight * misfit * gradient;
        }
        point += information.ldlt().solve(right);
        const double height = normal.dot(point - center);
        if (height < 0.0) point -= 2.0 * height * normal;  // the mirror image fits as well
    }
    return point;
}

std::vector<Eigen::Quaterniond> spread_rotations(int count) {
    std::vector<Eigen::Quaterniond> chosen{Eigen::Quaterniond::Identity()};
    // Of many random rotations, always the one farthest from all chosen so far.
    constexpr int kCandidates = 200;
    core::Rng rng(kRotationSeed, 0, 0);
    std::vector<Eigen::Quaterniond> candidates;
    for (int i = 0; i < kCandidates; ++i) {
        const double a = std::sqrt(rng.uniform());
        const double b = std::sqrt(1.0 - a * a);
        const double u = 2.0 * core::kPi * rng.uniform();
        const double v = 2.0 * core::kPi * rng.uniform();
        candidates.emplace_back(a * std::cos(u), a * std::sin(u), b * std::cos(v), b * std::sin(v));
    }
    while (static_cast<int>(chosen.size()) < count) {
        double best_distance = -1.0;
        Eigen::Quaterniond best;
        for (const auto& candidate : candidates) {
            double nearest = 10.0;
            for (const auto& other : chosen) {
                nearest = std::min(nearest, candidate.angularDistance(other));
            }
            if (nearest > best_distance) {
                best_distance = nearest;
                best = candidate;
            }
        }
        chosen.push_back(best);
    }
    return chosen;
}

std::vector<Vec3> cluster_centers(const std::vector<Vec3>& points, std::size_t count) {
    constexpr int kRounds = 30;
    const auto nearest = [](const std::vector<Vec3>& centers, const Vec3& point) {
        std::size_t best = 0;
        for (std::size_t c = 1; c < centers.size(); ++c) {
            const double distance = (centers[c] - point).squaredNorm();
            if (distance < (centers[best] - point).squaredNorm()) best = c;
        }
        return best;
    };
    std::vector<Vec3> centers{points.front()};
    while (centers.size() < count) {
        const auto distance = [&](const Vec3& p) {
            return (centers[nearest(centers, p)] - p).squaredNorm();
        };
        centers.push_back(
            *std::max_element(points.begin(), points.end(), [&](const Vec3& a, const Vec3& b) {
                return distance(a) < distance(b);
            }));
    }
    for (int round = 0; round < kRounds; ++round) {
        std::vector<Vec3> sums(count, Vec3::Zero());
        std::vector<double> members(count, 0.0);
        for (const Vec3& p : points) {
            const std::size_t c = nearest(centers, p);
            sums[c] += p;
            members[c] += 1.0;
        }
        for (std::size_t c = 0; c < count; ++c) {
            if (members[c] > 0.0) centers[c] = sums[c] / members[c];
        }
    }
    return centers;
}

/// Takes a pair's light within `reach_m` of a path length as explained: dims its bins.
void dim_near(double opl_m, double reach_m, std::size_t pair, FitData& data) {
    const auto bins = static_cast<std::size_t>(data.axis.num_bins);
    for (std::size_t b = 0; b < bins; ++b) {
        const double center_m = data.axis.bin_center_m(static_cast<double>(b));
        if (std::abs(center_m - opl_m) < reach_m) data.values[pair * bins + b] *= 0.1;
    }
}

std::vector<Vec3> brightest_points(const core::WallScan& scan,
                                   const FitData& data,
                                   double ambient,
                                   double sigma_m,
                                   const std::vector<double>& offset_m,
                                   int count) {
    const Vec3 normal = mean_of(scan.sensing.normals).normalized();
    const Vec3 center = mean_of(scan.sensing.positions);
    Vec3 across = scan.sensing.positions.back() - scan.sensing.positions.front();
    across -= across.dot(normal) * normal;
    const double half_width = std::max(0.7 * 0.5 * across.norm(), 0.1);
    across = across.norm() > 0.0 ? across.normalized() : normal.unitOrthogonal();
    core::Mat3 frame = core::frame_from_normal(normal, across);
    frame.leftCols<2>() =
        (frame.leftCols<2>() * Eigen::Rotation2Dd(core::kPi / 4).toRotationMatrix()).eval();
    constexpr int kCells = 40;
    constexpr double kMinDepth_m = 0.05;
    const double far = 0.5 * data.axis.opl_end_m();
    const double step = 2.0 * half_width / kCells;
    const int layers = std::max(1, static_cast<int>((far - kMinDepth_m) / step));

    FitData rest = data;
    for (double& value : rest.values) value = std::max(0.0, value - ambient);
    std::vector<Vec3> found;
    for (int n = 0; n < count; ++n) {
        const auto cells = static_cast<std::size_t>(kCells * kCells * layers);
        std::vector<double> score(cells, 0.0);
        const auto position = [&](std::size_t cell) {
            const int i = static_cast<int>(cell);
            const double x = (i % kCells + 0.5) * step - half_width;
            const double y = (i / kCells % kCells + 0.5) * step - half_width;
            const double z = kMinDepth_m + (i / (kCells * kCells) + 0.5) * step;
            return Vec3(center + frame * Vec3(x, y, z));
        };
        const auto opl_of = [&](const Vec3& p, std::size_t pair) {
            return (p - scan.illumination.positions[scan.illumination_index(pair)]).norm() +
                   (p - scan.sensing.positions[scan.sensing_index(pair)]).norm() + offset_m[pair];
        };
        core::parallel_blocks(cells, 256, [&](std::size_t begin, std::size_t end) {
            for (std::size_t cell = begin; cell < end; ++cell) {
                const Vec3 p = position(cell);
                for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
                    const auto bin = data.axis.bin_of(opl_of(p, pair));
                    // The root rewards light for every pair over much light for one.
                    if (!bin) continue;
                    score[cell] += std::sqrt(histogram(rest, pair)[static_cast<std::size_t>(*bin)]);
                }
            }
        });
        const auto best = std::max_element(score.begin(), score.end()) - score.begin();
        found.push_back(position(static_cast<std::size_t>(best)));
        for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
            dim_near(opl_of(found.back(), pair), 2.5 * sigma_m + step, pair, rest);
        }
    }
    return found;
}

}  // namespace calib
