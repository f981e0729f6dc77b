// SPDX-License-Identifier: MIT
#include "nlos/preparation/conservative_resampling.h"

namespace nlos {
namespace {

/// Where the content of one bin lies.
class Content {
 public:
    Content(std::span<const double> edges, std::size_t bin, BinSpread spread)
        : begin_(edges[bin]), end_(edges[bin + 1]), spread_(spread) {
        if (spread == BinSpread::Even) return;
        middle_ = 0.5 * (begin_ + end_);
        const double width = end_ - begin_;
        begin_ = bin > 0 ? 0.5 * (edges[bin - 1] + begin_) : middle_ - width;
        end_ = bin + 2 < edges.size() ? 0.5 * (end_ + edges[bin + 2]) : middle_ + width;
    }

    double begin() const { return begin_; }
    double end() const { return end_; }

    /// The fraction of it before a place on the axis.
    double before(double position) const {
        const double width = end_ - begin_;
        if (position <= begin_ || !(width > 0.0)) return 0.0;
        if (position >= end_) return 1.0;
        if (spread_ == BinSpread::Even) return (position - begin_) / width;
        const double from_begin = position - begin_;
        const double to_end = end_ - position;
        return position < middle_ ? from_begin * from_begin / (width * (middle_ - begin_))
                                  : 1.0 - to_end * to_end / (width * (end_ - middle_));
    }

 private:
    double begin_, end_;
    double middle_ = 0.0;
    BinSpread spread_;
};

}  // namespace

ConservativeResampling::ConservativeResampling(std::span<const double> from_edges,
                                               std::span<const double> to_edges,
                                               std::span<const double> from_scale,
                                               BinSpread spread) {
    const std::size_t num_inputs = from_edges.size() - 1;
    std::vector<Content> contents;
    for (std::size_t i = 0; i < num_inputs; ++i) contents.emplace_back(from_edges, i, spread);
    rows_.resize(to_edges.size() - 1);
    weights_.reserve(num_inputs + rows_.size());
    std::size_t first = 0;
    for (std::size_t row = 0; row < rows_.size(); ++row) {
        const double begin = to_edges[row];
        const double end = to_edges[row + 1];
        while (first < num_inputs && contents[first].end() <= begin) ++first;
        rows_[row].first_input = first;
        rows_[row].first_weight = weights_.size();
        for (std::size_t i = first; i < num_inputs && contents[i].begin() < end; ++i) {
            const double fraction = contents[i].before(end) - contents[i].before(begin);
            weights_.push_back(static_cast<float>(from_scale[i] * fraction));
            ++rows_[row].count;
        }
    }
}

std::vector<double> even_edges(double begin, double end, std::size_t count) {
    std::vector<double> edges(count + 1);
    for (std::size_t i = 0; i <= count; ++i) {
        edges[i] = begin + (end - begin) * static_cast<double>(i) / static_cast<double>(count);
    }
    return edges;
}

}  // namespace nlos
