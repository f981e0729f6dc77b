// SPDX-License-Identifier: MIT
#include "nlos/canvas/canvas.h"

#include "nlos/canvas/png_file.h"
#include "nlos/canvas/raster.h"
#include "renderer/core/error.h"

#include <cairo-ft.h>
#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

// DejaVu Sans (.ttf), which becomes part of the program: pictures need no font where it runs.
extern "C" {
extern const unsigned char nlos_font_begin[];
extern const unsigned char nlos_font_end[];
}

namespace nlos {
namespace {

constexpr double kPointsPerPixel = 0.375;       // of files of lines
constexpr int kRasterDetail = 2;                // pixels of images in them per pixel of a .png
constexpr int kMaxSide = 32'767;                // of cairo's images, in pixels
constexpr double kCapHeight = 1493.0 / 2048.0;  // of the font at size 1

/// Deletes what cairo made.
struct Release {
    void operator()(cairo_t* context) const { cairo_destroy(context); }
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_scaled_font_t* font) const { cairo_scaled_font_destroy(font); }
    void operator()(cairo_font_options_t* options) const { cairo_font_options_destroy(options); }
};
using CairoContext = std::unique_ptr<cairo_t, Release>;
using CairoSurface = std::unique_ptr<cairo_surface_t, Release>;
using CairoFont = std::unique_ptr<cairo_scaled_font_t, Release>;
using CairoFontOptions = std::unique_ptr<cairo_font_options_t, Release>;

void check(cairo_status_t status) {
    if (status == CAIRO_STATUS_SUCCESS) return;
    throw core::Failure("picture",
                        std::string("cannot be drawn: ") + cairo_status_to_string(status));
}

cairo_font_face_t* load_font() {
    FT_Library library = nullptr;
    FT_Face face = nullptr;
    if (FT_Init_FreeType(&library) != 0 ||
        FT_New_Memory_Face(library, nlos_font_begin, nlos_font_end - nlos_font_begin, 0, &face) !=
            0) {
        throw core::Failure("picture", "the font cannot be loaded");
    }
    return cairo_ft_font_face_create_for_ft_face(face, 0);
}

/// The font of all texts, which is kept until the program ends.
cairo_font_face_t* font_face() {
    static cairo_font_face_t* const face = load_font();
    return face;
}

/// Letters keep their shape and distances at every size.
CairoFontOptions font_options() {
    CairoFontOptions options(cairo_font_options_create());
    cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
    return options;
}

double font_size(const TextStyle& style) {
    return style.cap_height_px / kCapHeight;
}

/// How far before its point a text of this length begins.
double offset_to(TextAnchor anchor, double length) {
    if (anchor == TextAnchor::Centre) return 0.5 * length;
    return anchor == TextAnchor::End ? length : 0.0;
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int size) noexcept {
    try {
        static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), size);
        return CAIRO_STATUS_SUCCESS;
    } catch (const std::exception&) {
        return CAIRO_STATUS_NO_MEMORY;
    }
}

CairoSurface make_surface(PictureFormat format,
                          int width,
                          int height,
                          std::string& bytes,
                          std::unique_ptr<unsigned char[]>& pixels) {
    const double width_pt = width * kPointsPerPixel;
    const double height_pt = height * kPointsPerPixel;
    switch (format) {
        case PictureFormat::Png:
            break;
        case PictureFormat::Svg:
            return CairoSurface(
                cairo_svg_surface_create_for_stream(append, &bytes, width_pt, height_pt));
        case PictureFormat::Pdf: {
            CairoSurface surface(
                cairo_pdf_surface_create_for_stream(append, &bytes, width_pt, height_pt));
            // The same picture is the same file, whenever it is drawn.
            cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
            return surface;
        }
    }
    if (std::max(width, height) > kMaxSide) {
        throw core::Failure("picture",
                            fmt::format("would have {} x {} pixels; at most {} a side can be drawn",
                                        width,
                                        height,
                                        kMaxSide));
    }
    const int stride = cairo_format_stride_for_width(CAIRO_FORMAT_RGB24, width);
    pixels = std::make_unique_for_overwrite<unsigned char[]>(static_cast<std::size_t>(stride) *
                                                             static_cast<std::size_t>(height));
    return CairoSurface(cairo_image_surface_create_for_data(
        pixels.get(), CAIRO_FORMAT_RGB24, width, height, stride));
}

CairoSurface surface_of(const Raster& raster) {
    CairoSurface surface(
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, raster.columns, raster.rows));
    check(cairo_surface_status(surface.get()));
    cairo_surface_flush(surface.get());
    unsigned char* const data = cairo_image_surface_get_data(surface.get());
    const int stride = cairo_image_surface_get_stride(surface.get());
    for (int y = 0; y < raster.rows; ++y) {
        auto* row = reinterpret_cast<std::uint32_t*>(data + std::ptrdiff_t{y} * stride);
        for (int x = 0; x < raster.columns; ++x) {
            const Colour& c = raster.at(x, y);
            row[x] = std::uint32_t{c.red} << 16 | std::uint32_t{c.green} << 8 | c.blue;
        }
    }
    cairo_surface_mark_dirty(surface.get());
    return surface;
}

std::string png_of(cairo_surface_t* surface) {
    cairo_surface_flush(surface);
    return encode_png(cairo_image_surface_get_data(surface),
                      cairo_image_surface_get_width(surface),
                      cairo_image_surface_get_height(surface),
                      cairo_image_surface_get_stride(surface));
}

/// Gives an image the bytes to store it with in an .svg; those that cairo packs take longer.
void attach_png(cairo_surface_t* surface) {
    auto bytes = std::make_unique<std::string>(png_of(surface));
    check(cairo_surface_set_mime_data(
        surface,
        CAIRO_MIME_TYPE_PNG,
        reinterpret_cast<const unsigned char*>(bytes->data()),
        bytes->size(),
        [](void* kept) { delete static_cast<std::string*>(kept); },
        bytes.get()));
    bytes.release();
}

}  // namespace

struct Canvas::Drawing {
    PictureFormat format;
    std::string bytes;                        // which a vector surface writes to
    std::unique_ptr<unsigned char[]> pixels;  // of an image surface: cairo's own are small pages
    CairoSurface surface;
    CairoContext context;

    Drawing(int width, int height, PictureFormat stored_as)
        : format(stored_as),
          surface(make_surface(format, width, height, bytes, pixels)),
          context(cairo_create(surface.get())) {
        if (format != PictureFormat::Png) {
            cairo_scale(context.get(), kPointsPerPixel, kPointsPerPixel);
        }
        cairo_set_font_face(context.get(), font_face());
        cairo_set_font_options(context.get(), font_options().get());
        cairo_set_line_join(context.get(), CAIRO_LINE_JOIN_ROUND);
        cairo_set_line_cap(context.get(), CAIRO_LINE_CAP_ROUND);
    }

    void use(Colour colour, double opacity = 1.0) {
        cairo_set_source_rgba(
            context.get(), colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0, opacity);
    }

    void path(const std::vector<std::array<double, 2>>& points) {
        for (const auto& [x, y] : points) cairo_line_to(context.get(), x, y);
    }
};

Canvas::Canvas(int width, int height, Colour background, PictureFormat format)
    : drawing_(std::make_unique<Drawing>(width, height, format)) {
    fill({0, 0, width, height}, background);
}

Canvas::~Canvas() = default;

void Canvas::fill(const PixelBox& box, Colour colour) {
    drawing_->use(colour);
    cairo_rectangle(drawing_->context.get(), box.x, box.y, box.width, box.height);
    cairo_fill(drawing_->context.get());
}

void Canvas::frame(const PixelBox& box, Colour colour, int thickness) {
    const double half = 0.5 * thickness;
    drawing_->use(colour);
    cairo_save(drawing_->context.get());
    cairo_set_dash(drawing_->context.get(), nullptr, 0, 0.0);
    cairo_set_line_join(drawing_->context.get(), CAIRO_LINE_JOIN_MITER);
    cairo_set_line_width(drawing_->context.get(), thickness);
    cairo_rectangle(drawing_->context.get(),
                    box.x - half,
                    box.y - half,
                    box.width + thickness,
                    box.height + thickness);
    cairo_stroke(drawing_->context.get());
    cairo_restore(drawing_->context.get());
}

void Canvas::fill_polygon(const std::vector<std::array<double, 2>>& points,
                          Colour colour,
                          double opacity) {
    drawing_->use(colour, opacity);
    drawing_->path(points);
    cairo_fill(drawing_->context.get());
}

void Canvas::polyline(const std::vector<std::array<double, 2>>& points,
                      Colour colour,
                      int thickness,
                      Stroke stroke) {
    drawing_->use(colour);
    cairo_set_line_width(drawing_->context.get(), thickness);
    drawing_->path(points);
    const std::array<double, 2> dashes{4.0 * thickness, 3.0 * thickness};
    cairo_set_dash(drawing_->context.get(), dashes.data(), stroke == Stroke::Dashed ? 2 : 0, 0.0);
    cairo_stroke(drawing_->context.get());
}

double Canvas::text_length(const std::string& text, const TextStyle& style) {
    cairo_matrix_t size;
    cairo_matrix_t identity;
    cairo_matrix_init_scale(&size, font_size(style), font_size(style));
    cairo_matrix_init_identity(&identity);
    const CairoFont font(
        cairo_scaled_font_create(font_face(), &size, &identity, font_options().get()));
    cairo_text_extents_t extents;
    cairo_scaled_font_text_extents(font.get(), core::printable(text).c_str(), &extents);
    check(cairo_scaled_font_status(font.get()));
    return extents.x_advance;
}

void Canvas::text(int x, int y, const std::string& text, const TextStyle& style) {
    cairo_t* const context = drawing_->context.get();
    drawing_->use(style.colour);
    cairo_save(context);
    cairo_translate(context, x, y);
    if (style.direction == TextDirection::Upwards) cairo_rotate(context, -0.5 * std::numbers::pi);
    cairo_set_font_size(context, font_size(style));
    cairo_move_to(
        context, -offset_to(style.anchor, text_length(text, style)), 0.5 * style.cap_height_px);
    cairo_show_text(context, core::printable(text).c_str());
    cairo_new_path(context);  // which ends where the text does
    cairo_restore(context);
}

void Canvas::image(const PixelBox& box, int columns, int rows, const std::vector<Colour>& colours) {
    const int detail = drawing_->format == PictureFormat::Png ? 1 : kRasterDetail;
    const Raster raster =
        resized({columns, rows, colours}, detail * box.width, detail * box.height);
    cairo_t* const context = drawing_->context.get();
    const CairoSurface surface = surface_of(raster);
    if (drawing_->format == PictureFormat::Svg) attach_png(surface.get());
    cairo_save(context);
    cairo_translate(context, box.x, box.y);
    cairo_scale(context, double(box.width) / raster.columns, double(box.height) / raster.rows);
    cairo_set_source_surface(context, surface.get(), 0.0, 0.0);
    cairo_pattern_set_filter(cairo_get_source(context), CAIRO_FILTER_NEAREST);
    cairo_rectangle(context, 0.0, 0.0, raster.columns, raster.rows);
    cairo_fill(context);
    cairo_restore(context);
}

std::string Canvas::finish() {
    check(cairo_status(drawing_->context.get()));
    if (drawing_->format == PictureFormat::Png) {
        drawing_->bytes = png_of(drawing_->surface.get());
    }
    cairo_surface_finish(drawing_->surface.get());
    check(cairo_surface_status(drawing_->surface.get()));
    return std::move(drawing_->bytes);
}

}  // namespace nlos
