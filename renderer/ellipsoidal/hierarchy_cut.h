// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/ellipsoidal/triangle_hierarchy.h"

namespace renderer {

/// A cut through a hierarchy for one pair of ends, for many draws with the same ends.
///
/// The descent to the entries of the cut is made once; a draw searches a table, and descends
/// further only where an entry is not a single facet.
class HierarchyCut {
 public:
    explicit HierarchyCut(const TriangleHierarchy& hierarchy) : hierarchy_(&hierarchy) {}

    /// Finds the cut for new ends, with about `max_entries` entries at most.
    void rebuild(const ConnectionEnds& ends, const OplBand& lengths, std::size_t max_entries);

    bool empty() const { return entries_.empty(); }
    /// Estimated fraction of the contribution of all lengths that lies within the interval.
    double fraction_asked() const { return fraction_asked_; }
    const FocusPair& foci() const { return ends_.foci; }

    /// As TriangleHierarchy::sample() for the ends of rebuild(). `hint` is updated so that calls
    /// with rising u are quick (start with 0).
    std::optional<FacetChoice> sample(double u, std::size_t& hint) const;
    FacetChoice evaluate(std::uint32_t facet) const;

 private:
    struct Entry {
        std::int32_t child = 0;   ///< as Node::child
        std::uint32_t first = 0;  ///< position of its first facet
        double weight = 0.0;
        double end = 0.0;  ///< upper end of its interval of [0, 1)
        OplBand lengths;   ///< of a single facet
    };

    bool expand(std::size_t max_entries);
    void append_children(std::int32_t node);
    double facet_weight(std::uint32_t facet, OplBand& lengths) const;
    double fraction(std::size_t entry) const;

    const TriangleHierarchy* hierarchy_;
    ConnectionEnds ends_;
    OplBand lengths_;
    TriangleHierarchy::Query query_;
    double fraction_asked_ = 0.0;
    std::vector<Entry> entries_;
    std::vector<Entry> next_;
};

}  // namespace renderer
