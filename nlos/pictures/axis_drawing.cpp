// SPDX-License-Identifier: MIT
#include "nlos/pictures/axis_drawing.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace nlos {
namespace {

constexpr int kTickDistance = 70;  // at least, between ticks
constexpr int kMostTicks = 9;
constexpr double kNumberGap = 14.0;  // at least, between the numbers along x
constexpr int kLabelOverhang = 40;   // of a label beyond either end of its axis

/// The first and last multiple of a step inside an axis, in steps.
std::array<double, 2> multiples_inside(double low, double high, double step) {
    const double slack = 1e-6 * (high - low);
    return {std::ceil((low - slack) / step), std::floor((high + slack) / step)};
}

/// The smallest of 1, 2, 5 x 10^k of which at most `at_most` multiples lie inside the axis.
double round_step(double low, double high, int at_most) {
    double decade = std::pow(10.0, std::floor(std::log10((high - low) / at_most)));
    while (true) {
        for (const double factor : {1.0, 2.0, 5.0}) {
            const auto [first, last] = multiples_inside(low, high, factor * decade);
            if (last - first + 1.0 <= at_most) return factor * decade;
        }
        decade *= 10.0;
    }
}

/// Powers of ten worth taking out of the labels: only far from everyday numbers.
int common_exponent(double largest) {
    if (largest >= 0.01 && largest < 1e5) return 0;
    return 3 * static_cast<int>(std::floor(std::log10(largest) / 3.0));
}

/// "10⁻⁶".
std::string power_of_ten(int exponent) {
    constexpr std::array kRaised{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string text = exponent < 0 ? "10⁻" : "10";
    for (const char digit : std::to_string(std::abs(exponent))) {
        text += kRaised[static_cast<std::size_t>(digit - '0')];
    }
    return text;
}

int nearest_pixel(double position) {
    return static_cast<int>(std::lround(position));
}

int label_room(int length_px) {
    return std::max(kSmallestRoom, length_px) + 2 * kLabelOverhang;
}

/// As many ticks as have room for their numbers side by side.
AxisTicks x_ticks(const PixelAxis& axis) {
    const int length = std::abs(axis.high_px - axis.low_px);
    for (int count = tick_count(length);; --count) {
        AxisTicks ticks = choose_ticks(axis.low, axis.high, count);
        if (ticks.values.size() < 2 || count == 1) return ticks;
        double widest = 0.0;
        for (const std::string& number : ticks.labels) {
            widest = std::max(widest, Canvas::text_length(number, kTickText));
        }
        const double distance = std::abs(axis.pixel(ticks.values[1]) - axis.pixel(ticks.values[0]));
        if (widest + kNumberGap <= distance) return ticks;
    }
}

}  // namespace

AxisTicks choose_ticks(double low, double high, int at_most) {
    AxisTicks ticks;
    if (low > high) std::swap(low, high);
    const double span = high - low;
    if (!(span > 0.0) || !std::isfinite(span)) return ticks;

    const double step = round_step(low, high, std::max(1, at_most));
    const auto [first, last] = multiples_inside(low, high, step);
    ticks.exponent = common_exponent(std::max(std::abs(low), std::abs(high)));
    const double scale = std::pow(10.0, -ticks.exponent);
    const int decimals =
        std::clamp(static_cast<int>(-std::floor(std::log10(step * scale) + 1e-9)), 0, 9);
    for (double multiple = first; multiple <= last; multiple += 1.0) {
        const double value = multiple * step + 0.0;  // + 0.0 turns -0 into 0
        ticks.values.push_back(value);
        const std::string digits = fmt::format("{:.{}f}", std::abs(value) * scale, decimals);
        ticks.labels.push_back((value < 0.0 ? "−" : "") + digits);
    }
    return ticks;
}

std::string label_with_exponent(std::string label, int exponent) {
    if (exponent == 0) return label;
    const std::size_t unit = label.find('[');
    if (unit == std::string::npos) return label + " [" + power_of_ten(exponent) + "]";
    return label.insert(unit + 1, power_of_ten(exponent) + " ");
}

TextStyle anchored(TextStyle style, TextAnchor anchor) {
    style.anchor = anchor;
    return style;
}

TextStyle upwards(TextStyle style) {
    style.direction = TextDirection::Upwards;
    return style;
}

TextStyle fitted(TextStyle style, const std::string& text, int length_px) {
    const double length = Canvas::text_length(text, style);
    if (length > length_px) style.cap_height_px *= length_px / length;
    return style;
}

int tick_count(int length_px) {
    return std::clamp(length_px / kTickDistance + 1, 1, kMostTicks);
}

void draw_x_axis(Canvas& canvas,
                 const PixelBox& plot,
                 const PixelAxis& axis,
                 const std::string& label) {
    const AxisTicks ticks = x_ticks(axis);
    for (std::size_t i = 0; i < ticks.values.size(); ++i) {
        const int x = nearest_pixel(axis.pixel(ticks.values[i]));
        canvas.fill({x - kLine / 2, plot.bottom() + kLine, kLine, kTickLength}, kAxisColour);
        canvas.text(
            x, plot.bottom() + 32, ticks.labels[i], anchored(kTickText, TextAnchor::Centre));
    }
    const std::string text = label_with_exponent(label, ticks.exponent);
    canvas.text(plot.x + plot.width / 2,
                plot.bottom() + 76,
                text,
                fitted(kLabelText, text, label_room(plot.width)));
}

void draw_y_axis(Canvas& canvas,
                 const PixelBox& plot,
                 const PixelAxis& axis,
                 const std::string& label) {
    const AxisTicks ticks = choose_ticks(axis.low, axis.high, tick_count(plot.height));
    for (std::size_t i = 0; i < ticks.values.size(); ++i) {
        const int y = nearest_pixel(axis.pixel(ticks.values[i]));
        canvas.fill({plot.x - kLine - kTickLength, y - kLine / 2, kTickLength, kLine}, kAxisColour);
        canvas.text(plot.x - 20, y, ticks.labels[i], anchored(kTickText, TextAnchor::End));
    }
    const std::string text = label_with_exponent(label, ticks.exponent);
    canvas.text(plot.x - kLeftMargin + 24,
                plot.y + plot.height / 2,
                text,
                upwards(fitted(kLabelText, text, label_room(plot.height))));
}

void draw_grid(Canvas& canvas, const PixelBox& plot, const PixelAxis& x, const PixelAxis& y) {
    for (const double value : x_ticks(x).values) {
        const int px = nearest_pixel(x.pixel(value));
        canvas.fill({px - kLine / 2, plot.y, kLine, plot.height}, kGridColour);
    }
    for (const double value : choose_ticks(y.low, y.high, tick_count(plot.height)).values) {
        const int py = nearest_pixel(y.pixel(value));
        canvas.fill({plot.x, py - kLine / 2, plot.width, kLine}, kGridColour);
    }
}

}  // namespace nlos
