// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/canvas/canvas.h"

#include <cmath>
#include <string>
#include <vector>

namespace nlos {

struct PixelSize {
    int width = 0;
    int height = 0;
};

// Around a plot, in pixels of the canvas.
inline constexpr int kPlotSize = 640;      // longer side of a plot
inline constexpr int kLeftMargin = 132;    // y label and tick labels
inline constexpr int kBottomMargin = 108;  // tick labels and x label
inline constexpr int kSmallestRoom = 200;  // of a plot along either axis, however thin it is
inline constexpr int kTickLength = 9;
inline constexpr int kLine = 2;

inline constexpr Colour kInk{32, 36, 44};
inline constexpr Colour kSoftInk{92, 98, 108};
inline constexpr Colour kAxisColour{120, 126, 136};
inline constexpr Colour kGridColour{228, 231, 235};

inline constexpr TextStyle kTickText{15.0, kSoftInk, TextAnchor::Start};
inline constexpr TextStyle kLabelText{16.0, kInk, TextAnchor::Centre};

TextStyle anchored(TextStyle style, TextAnchor anchor);
TextStyle upwards(TextStyle style);

/// The style, with smaller letters where the text would be longer than `length_px`.
TextStyle fitted(TextStyle style, const std::string& text, int length_px);

enum class AxisScale { Linear, Logarithmic };

/// One axis of a plot: from value to pixel.
struct PixelAxis {
    double low = 0.0;
    double high = 1.0;
    int low_px = 0;
    int high_px = 1;
    AxisScale scale = AxisScale::Linear;
    std::vector<double> ticks{};  ///< where numbers stand; empty: where round ones do

    double pixel(double value) const {
        const auto position = [&](double of) {
            return scale == AxisScale::Linear ? of : std::log(of);
        };
        return low_px + (position(value) - position(low)) / (position(high) - position(low)) *
                            (high_px - low_px);
    }
};

/// Numbers along an axis with the texts to print beside them.
struct AxisTicks {
    std::vector<double> values;
    std::vector<std::string> labels;  ///< of values / 10^exponent
    int exponent = 0;                 ///< a multiple of 3; to be named beside the axis unless 0
};

/// Chooses ticks at multiples of 1, 2 or 5 times a power of ten.
///
/// low, high   ends of the axis, in any order
/// at_most     the largest number of ticks wanted, at least 1
AxisTicks choose_ticks(double low, double high, int at_most);

/// The label of an axis with the power of ten that its numbers are multiples of, as a part of its
/// unit: "light [W]" becomes "light [10⁻⁶ W]".
std::string label_with_exponent(std::string label, int exponent);

/// The largest number of ticks along an axis that goes upwards.
int tick_count(int length_px);

/// Draws frame, ticks with their numbers, and labels of a plot.
void draw_axes(Canvas& canvas,
               const PixelBox& plot,
               const PixelAxis& x,
               const PixelAxis& y,
               const std::string& x_label,
               const std::string& y_label);

/// Lines across the plot at the ticks of both axes.
void draw_grid(Canvas& canvas, const PixelBox& plot, const PixelAxis& x, const PixelAxis& y);

}  // namespace nlos
