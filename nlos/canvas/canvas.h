// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/canvas/colour_map.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace nlos {

/// A rectangle of pixels; y points down.
struct PixelBox {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;

    int right() const { return x + width; }
    int bottom() const { return y + height; }
};

/// What a picture is stored as: pixels, or lines and letters that stay sharp at any size.
enum class PictureFormat { Png, Svg, Pdf };

enum class Stroke { Solid, Dashed };
enum class TextAnchor { Start, Centre, End };
enum class TextDirection { Horizontal, Upwards };

struct TextStyle {
    double cap_height_px = 17.0;  ///< height of a capital letter
    Colour colour{};
    TextAnchor anchor = TextAnchor::Start;  ///< which end of the text lies at the given point
    TextDirection direction = TextDirection::Horizontal;
};

/// A picture to draw on, smooth-edged; needs no display and no font files.
///
/// Sizes are in pixels of a .png, of which an ordinary screen would show two per pixel of its own;
/// in an .svg and a .pdf four of them are as long as 1.5 points.
class Canvas {
 public:
    Canvas(int width, int height, Colour background, PictureFormat format = PictureFormat::Png);
    ~Canvas();
    Canvas(const Canvas&) = delete;
    Canvas& operator=(const Canvas&) = delete;

    void fill(const PixelBox& box, Colour colour);

    /// Draws a line of the given thickness around the box, outside it.
    void frame(const PixelBox& box, Colour colour, int thickness);

    /// Fills the polygon of points (x, y) in pixels, blended in with `opacity` in [0, 1].
    void fill_polygon(const std::vector<std::array<double, 2>>& points,
                      Colour colour,
                      double opacity);

    /// Draws a line through points with round ends; of one point twice, a dot.
    void polyline(const std::vector<std::array<double, 2>>& points,
                  Colour colour,
                  int thickness,
                  Stroke stroke = Stroke::Solid);

    /// Draws text in UTF-8 whose capitals are centred across its line on (x, y).
    void text(int x, int y, const std::string& text, const TextStyle& style);

    /// The length of a text along its direction [pixels].
    static double text_length(const std::string& text, const TextStyle& style);

    /// Fills the box with an image of `columns` x `rows` colours, stored row by row from the top:
    /// averaged where it must shrink, in sharp blocks where it must grow.
    void image(const PixelBox& box, int columns, int rows, const std::vector<Colour>& colours);

    /// Ends the drawing.
    /// returns   the bytes of the file
    /// throws    core::Failure when something could not be drawn
    std::string finish();

 private:
    struct Drawing;
    std::unique_ptr<Drawing> drawing_;
};

}  // namespace nlos
