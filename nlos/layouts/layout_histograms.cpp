// SPDX-License-Identifier: MIT
#include "nlos/layouts/layout_histograms.h"

#include "nlos/containers/file_memory.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>

namespace nlos {
namespace {

using core::Error;

/// What one step along an axis of the array changes.
struct AxisStep {
    std::size_t extent = 1;
    std::size_t illumination = 0;
    std::size_t sensing = 0;
    std::size_t bin = 0;
    std::size_t frame = 0;
    std::size_t order = 0;
};

/// Entries number points with x before y.
AxisStep step_of(const HistogramArray& array, std::size_t axis) {
    const std::string& name = array.axes[axis];
    AxisStep step{.extent = array.extents[axis]};
    const auto rows = [&](const char* y) { return array.extent(y).value_or(1); };
    if (name == "t") step.bin = 1;
    if (name == "frame") step.frame = 1;
    if (name == "order") step.order = 1;
    if (name == "y" || name == "sy" || name == "s" || name == "pair") step.sensing = 1;
    if (name == "x") step.sensing = rows("y");
    if (name == "sx") step.sensing = rows("sy");
    if (name == "ly" || name == "l") step.illumination = 1;
    if (name == "lx") step.illumination = rows("ly");
    return step;
}

/// Axes of the array, the one that runs fastest in storage first.
std::vector<AxisStep> steps_of(const HistogramArray& array, bool first_index_fastest) {
    std::vector<AxisStep> steps;
    for (std::size_t i = 0; i < array.axes.size(); ++i) steps.push_back(step_of(array, i));
    if (!first_index_fastest) std::reverse(steps.begin(), steps.end());
    return steps;
}

/// Where the next value of an array goes; advances with storage order.
class Walk {
 public:
    explicit Walk(std::vector<AxisStep> steps) : steps_(std::move(steps)), index_(steps_.size()) {}

    const AxisStep& position() const { return position_; }

    void advance() {
        for (std::size_t axis = 0; axis < steps_.size(); ++axis) {
            const AxisStep& step = steps_[axis];
            const std::size_t back = index_[axis] + 1 == step.extent ? index_[axis] : 0;
            if (back == 0 && step.extent > 1) {
                ++index_[axis];
                move(step, 1);
                return;
            }
            move(step, std::size_t{0} - back);  // modulo 2^64, as unsigned numbers count
            index_[axis] = 0;
        }
    }

 private:
    void move(const AxisStep& step, std::size_t count) {
        position_.illumination += count * step.illumination;
        position_.sensing += count * step.sensing;
        position_.bin += count * step.bin;
        position_.frame += count * step.frame;
        position_.order += count * step.order;
    }

    std::vector<AxisStep> steps_;
    std::vector<std::size_t> index_;
    AxisStep position_;
};

}  // namespace

Histograms read_histograms(const LayoutFiles& files,
                           const HistogramArray& array,
                           const PairNumbers& numbers,
                           std::size_t num_pairs,
                           std::optional<int> frame) {
    const std::size_t bins = array.extent("t").value();
    const std::size_t frames = array.extent("frame").value_or(1);
    const std::string where = files.where(array.name);
    if (bins > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        throw Error(where, fmt::format("has {} bins", bins), "must have fewer than 2^31");
    }
    if (frame && static_cast<std::size_t>(*frame) >= frames) {
        throw Error("capture.frame",
                    fmt::format("found {}", *frame),
                    fmt::format("must be less than the {} frames of {}", frames, where));
    }
    const std::size_t kept = frame ? 1 : frames;
    const std::size_t num_orders = array.extent("order").value_or(1);
    const std::size_t orders = num_orders > 1 ? num_orders : 0;
    require_memory(sizeof(float) * num_pairs * bins * (kept + (kept > 1 ? 1 : 0) + orders), where);
    const core::Transient dark(num_pairs, static_cast<int>(bins));
    Histograms read{std::vector(kept, dark), std::vector(orders, dark)};
    Walk walk(steps_of(array, files.first_index_fastest(array.name)));
    files.read_runs(array.name, [&](const std::vector<float>& values) {
        for (const float value : values) {
            const AxisStep& position = walk.position();
            if (!frame || position.frame == static_cast<std::size_t>(*frame)) {
                const std::size_t pair = numbers.pair(position.illumination, position.sensing);
                read.frames[frame ? 0 : position.frame].histogram(pair)[position.bin] += value;
                if (orders > 0)
                    read.by_order[position.order].histogram(pair)[position.bin] += value;
            }
            walk.advance();
        }
    });
    return read;
}

void subtract_background(const LayoutFiles& files,
                         const std::vector<std::string>& background,
                         core::Transient& transient) {
    std::vector<double> mean(transient.num_bins(), 0.0);
    for (const std::string& name : background) {
        const std::vector<double> values = files.read(name);
        if (values.size() != mean.size()) {
            throw Error(files.where(name),
                        fmt::format("holds {} values", values.size()),
                        fmt::format("must hold one for each of {} bins", mean.size()));
        }
        for (std::size_t bin = 0; bin < mean.size(); ++bin) {
            mean[bin] += values[bin] / static_cast<double>(background.size());
        }
    }
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        const auto histogram = transient.histogram(pair);
        for (std::size_t bin = 0; bin < mean.size(); ++bin) {
            histogram[bin] -= static_cast<float>(mean[bin]);
        }
    }
}

}  // namespace nlos
