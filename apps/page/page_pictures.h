// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace apps {

/// The pictures of a page, which is made twice: first to see how much they take, then, after fit(),
/// with them in it.
class PagePictures {
 public:
    /// An <img> that carries its own bytes; a PNG is shown at half its pixels, sharp on dense
    /// screens. Before fit() it carries none, and words stand in place of what was left out.
    ///
    /// bytes       of a .png or .svg file, which stay where they are until the page is made
    /// alternative what the picture shows, in words
    std::string image(std::string_view bytes, std::string_view alternative);

    /// Makes the largest pictures so small that all together, as text, take at most so many bytes.
    /// What cannot be made small enough - drawings in SVG, and most of very many - is left out.
    void fit(double limit_bytes);

    /// What all pictures take as they are [bytes of text].
    double whole_bytes() const;

    std::size_t count() const { return uses_.size(); }
    std::size_t num_reduced() const { return num_reduced_; }
    std::size_t num_left_out() const { return num_left_out_; }

 private:
    struct Picture {
        std::string_view whole;
        std::string reduced{};  ///< a thumbnail in place of `whole`; empty: none
        bool is_left_out = false;

        std::string_view shown() const { return reduced.empty() ? whole : reduced; }
    };

    std::vector<Picture> pictures_;
    std::map<const char*, std::size_t> index_;  ///< of pictures, by where their bytes lie
    std::vector<std::size_t> uses_;             ///< pictures in the order of the page
    bool is_fitted_ = false;
    std::size_t num_reduced_ = 0;
    std::size_t num_left_out_ = 0;
};

}  // namespace apps
