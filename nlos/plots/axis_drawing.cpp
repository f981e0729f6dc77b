// SPDX-License-Identifier: MIT
#include "nlos/plots/axis_drawing.h"

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

enum class Side { Below, Left };

/// Whether the numbers stand clear of each other.
bool have_room(const AxisTicks& ticks, const PixelAxis& axis, Side side) {
    double needed = 0.5 * kTickDistance;
    if (side == Side::Below) {
        needed = kNumberGap;
        for (const std::string& number : ticks.labels) {
            needed = std::max(needed, kNumberGap + Canvas::text_length(number, kTickText));
        }
    }
    for (std::size_t i = 1; i < ticks.values.size(); ++i) {
        const double distance = axis.pixel(ticks.values[i]) - axis.pixel(ticks.values[i - 1]);
        if (std::abs(distance) < needed) return false;
    }
    return true;
}

/// A number of any size: very large and very small ones as multiples of a power of ten.
std::string number_text(double value) {
    const int exponent =
        value == 0.0 ? 0 : static_cast<int>(std::floor(std::log10(std::abs(value)) + 1e-9));
    if (exponent >= -4 && exponent < 6) {
        return (value < 0.0 ? "−" : "") + fmt::format("{:g}", std::abs(value));
    }
    const double factor = value / std::pow(10.0, exponent);
    const std::string power = power_of_ten(exponent);
    return std::abs(factor - 1.0) < 1e-6 ? power : number_text(factor) + "·" + power;
}

void add_tick(double value, AxisTicks& ticks) {
    ticks.values.push_back(value);
    ticks.labels.push_back(number_text(value));
}

/// Every so many of the given ones.
AxisTicks given_ticks(const PixelAxis& axis, std::size_t step) {
    AxisTicks ticks;
    for (std::size_t i = 0; i < axis.ticks.size(); i += step) add_tick(axis.ticks[i], ticks);
    return ticks;
}

/// Every so many powers of ten; 0: also their doubles and fivefolds.
AxisTicks decade_ticks(const PixelAxis& axis, int step) {
    AxisTicks ticks;
    const int last = static_cast<int>(std::floor(std::log10(axis.high) + 1e-9));
    for (int exponent = static_cast<int>(std::floor(std::log10(axis.low))); exponent <= last;
         ++exponent) {
        if (step > 0 && exponent % step != 0) continue;
        for (const double factor : {1.0, 2.0, 5.0}) {
            const double value = factor * std::pow(10.0, exponent);
            const bool is_wanted = step == 0 || factor == 1.0;
            if (is_wanted && value >= axis.low && value <= axis.high) add_tick(value, ticks);
        }
    }
    return ticks;
}

/// The ticks of an axis, as many as have room.
AxisTicks ticks_along(const PixelAxis& axis, Side side) {
    const int most = tick_count(std::abs(axis.high_px - axis.low_px));
    for (int step = 0;; ++step) {
        AxisTicks ticks;
        if (!axis.ticks.empty()) {
            ticks = given_ticks(axis, static_cast<std::size_t>(step) + 1);
        } else if (axis.scale == AxisScale::Logarithmic) {
            ticks = decade_ticks(axis, step);
        } else {
            ticks = choose_ticks(axis.low, axis.high, std::max(1, most - step));
        }
        if (have_room(ticks, axis, side)) return ticks;
    }
}

/// Where the multiples of the powers of ten between the numbers of a logarithmic axis lie.
std::vector<double> minor_ticks(const PixelAxis& axis) {
    constexpr double kMostDecades = 8.0;
    std::vector<double> values;
    if (axis.scale == AxisScale::Linear || axis.high / axis.low > std::pow(10.0, kMostDecades)) {
        return values;
    }
    for (double decade = std::pow(10.0, std::floor(std::log10(axis.low))); decade < axis.high;
         decade *= 10.0) {
        for (int factor = 1; factor < 10; ++factor) {
            const double value = factor * decade;
            if (value >= axis.low && value <= axis.high) values.push_back(value);
        }
    }
    return values;
}

void draw_x_axis(Canvas& canvas,
                 const PixelBox& plot,
                 const PixelAxis& axis,
                 const std::string& label) {
    const auto draw_tick = [&](double value, int length) {
        const int x = nearest_pixel(axis.pixel(value));
        canvas.fill({x - kLine / 2, plot.bottom() + kLine, kLine, length}, kAxisColour);
        return x;
    };
    const AxisTicks ticks = ticks_along(axis, Side::Below);
    for (const double value : minor_ticks(axis)) draw_tick(value, kTickLength / 2);
    for (std::size_t i = 0; i < ticks.values.size(); ++i) {
        canvas.text(draw_tick(ticks.values[i], kTickLength),
                    plot.bottom() + 32,
                    ticks.labels[i],
                    anchored(kTickText, TextAnchor::Centre));
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
    const auto draw_tick = [&](double value, int length) {
        const int y = nearest_pixel(axis.pixel(value));
        canvas.fill({plot.x - kLine - length, y - kLine / 2, length, kLine}, kAxisColour);
        return y;
    };
    const AxisTicks ticks = ticks_along(axis, Side::Left);
    for (const double value : minor_ticks(axis)) draw_tick(value, kTickLength / 2);
    for (std::size_t i = 0; i < ticks.values.size(); ++i) {
        canvas.text(plot.x - 20,
                    draw_tick(ticks.values[i], kTickLength),
                    ticks.labels[i],
                    anchored(kTickText, TextAnchor::End));
    }
    const std::string text = label_with_exponent(label, ticks.exponent);
    canvas.text(plot.x - kLeftMargin + 24,
                plot.y + plot.height / 2,
                text,
                upwards(fitted(kLabelText, text, label_room(plot.height))));
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

void draw_axes(Canvas& canvas,
               const PixelBox& plot,
               const PixelAxis& x,
               const PixelAxis& y,
               const std::string& x_label,
               const std::string& y_label) {
    canvas.frame(plot, kAxisColour, kLine);
    draw_x_axis(canvas, plot, x, x_label);
    draw_y_axis(canvas, plot, y, y_label);
}

void draw_grid(Canvas& canvas, const PixelBox& plot, const PixelAxis& x, const PixelAxis& y) {
    for (const double value : ticks_along(x, Side::Below).values) {
        const int px = nearest_pixel(x.pixel(value));
        canvas.fill({px - kLine / 2, plot.y, kLine, plot.height}, kGridColour);
    }
    for (const double value : ticks_along(y, Side::Left).values) {
        const int py = nearest_pixel(y.pixel(value));
        canvas.fill({plot.x, py - kLine / 2, plot.width, kLine}, kGridColour);
    }
}

}  // namespace nlos
