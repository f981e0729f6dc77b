// SPDX-License-Identifier: MIT
#include "apps/bench/regression.h"

#include "renderer/core/settings/json_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace apps {
namespace {

using core::Json;

// How a figure is judged: a factor that is more than noise, or a difference.
enum class Judgement { Factor, Difference, Target };

/// Figures that say how good a run is; everything else describes what was run.
struct Quantity {
    Judgement judgement;
    double tolerance;
    std::vector<std::string_view> names;
};
const std::vector<Quantity> kQuantities{
    // times
    {Judgement::Factor,
     1.25,
     {"cpu_seconds",
      "cpu_s",
      "process_cpu_s",
      "cpu_s_at_1_percent",
      "seconds",
      "seconds_per_frame"}},
    // memory and errors
    {Judgement::Factor,
     1.1,
     {"peak_bytes",
      "peak_mb",
      "bytes",
      "rel_l2",
      "rel_mse",
      "trimmed_rel_mse",
      "variance_seconds",
      "depth_mae_m",
      "depth_mae_mm",
      "stated_mae_mm",
      "depth_median_m",
      "depth_rmse_m",
      "normal_median_deg",
      "position_rms_m",
      "rotation_rms_deg"}},
    // fractions, of which more is better
    {Judgement::Difference,
     0.02,
     {"mask_iou", "mask_iou_best", "accepted_share", "iou", "iou_best"}},
    {Judgement::Target, 0.0, {"consistent", "holds", "met"}}};

const Quantity* quantity_named(const std::string& name) {
    const auto it = std::ranges::find_if(kQuantities, [&](const Quantity& quantity) {
        return std::ranges::count(quantity.names, name) > 0;
    });
    return it == kQuantities.end() ? nullptr : &*it;
}

// Fields that name a row.
constexpr std::array kNames{
    "name",    "scene",        "pattern",  "points",      "light",    "capture",     "program",
    "samples", "target_error", "sequence", "method",      "choice",   "of",          "mode",
    "effort",  "size",         "gate_mm",  "max_bounces", "center_m", "peak_counts", "at_rel_l2"};

std::string name_of(const Json& row) {
    std::string name;
    if (!row.is_object()) return name;
    for (const char* field : kNames) {
        if (!row.contains(field)) continue;
        const Json& value = row[field];
        if (value.is_array() && !value.empty() && value.front().is_object()) continue;  // rows
        if (!name.empty()) name += "/";
        name += value.is_string() ? value.get<std::string>() : value.dump();
    }
    return name;
}

const Json* row_named(const Json& rows, const std::string& name, std::size_t index) {
    if (name.empty()) return index < rows.size() ? &rows[index] : nullptr;
    const auto found = std::find_if(
        rows.begin(), rows.end(), [&](const Json& row) { return name_of(row) == name; });
    return found == rows.end() ? nullptr : &*found;
}

double number_of(const Json& value) {
    if (value.is_boolean()) return value.get<bool>() ? 1.0 : 0.0;
    if (value.is_string()) return value == "yes" ? 1.0 : 0.0;
    return value.get<double>();
}

bool is_figure(const Json& value, const Quantity& quantity) {
    if (value.is_number()) return std::isfinite(value.get<double>());
    if (quantity.judgement != Judgement::Target) return false;
    return value.is_boolean() || value == "yes" || value == "no";
}

class Walk {
 public:
    explicit Walk(BenchRegression& result) : result_(result) {}

    void compare(const Json& before, const Json& now, const std::string& where) {
        if (now.is_object() && before.is_object()) {
            for (const auto& [key, value] : now.items()) {
                if (before.contains(key)) compare_field(before[key], value, where, key);
            }
        } else if (now.is_array() && before.is_array()) {
            for (std::size_t i = 0; i < now.size(); ++i) {
                const std::string name = name_of(now[i]);
                const Json* row = row_named(before, name, i);
                if (row == nullptr) {
                    ++result_.num_missing;
                } else {
                    compare(*row, now[i], where + "/" + (name.empty() ? std::to_string(i) : name));
                }
            }
        }
    }

 private:
    void compare_field(const Json& before,
                       const Json& now,
                       const std::string& where,
                       const std::string& key) {
        const Quantity* quantity = quantity_named(key);
        if (quantity == nullptr) {
            compare(before, now, where.empty() ? key : where + "/" + key);
        } else if (now.is_array() && before.is_array()) {
            for (std::size_t i = 0; i < std::min(now.size(), before.size()); ++i) {
                judge(before[i], now[i], {where + "/" + std::to_string(i), key}, *quantity);
            }
        } else {
            judge(before, now, {where, key}, *quantity);
        }
    }

    void judge(const Json& before, const Json& now, BenchChange change, const Quantity& quantity) {
        if (!is_figure(before, quantity) || !is_figure(now, quantity)) return;
        change.before = number_of(before);
        change.now = number_of(now);
        bool differs = change.before != change.now;
        if (quantity.judgement == Judgement::Factor) {
            const auto [low, high] = std::minmax(change.before, change.now);
            differs = high > quantity.tolerance * low;
            change.is_worse = change.now > change.before;
        } else {
            differs = std::abs(change.now - change.before) > quantity.tolerance;
            change.is_worse = change.now < change.before;
        }
        if (differs) {
            result_.changes.push_back(std::move(change));
        } else {
            ++result_.num_alike;
        }
    }

    BenchRegression& result_;
};

// How far apart two figures are, for sorting.
double size_of(const BenchChange& change) {
    const auto [low, high] = std::minmax(change.before, change.now);
    return high / std::max(low, 1e-300);
}

}  // namespace

BenchRegression compare_benches(const Json& before, const Json& now) {
    BenchRegression result;
    result.program = before.at("program");
    result.machine = before.at("machine");
    Walk(result).compare(before, now, "");
    std::sort(result.changes.begin(),
              result.changes.end(),
              [](const BenchChange& a, const BenchChange& b) {
                  return a.is_worse != b.is_worse ? a.is_worse : size_of(a) > size_of(b);
              });
    return result;
}

}  // namespace apps
