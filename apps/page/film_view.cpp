// SPDX-License-Identifier: MIT
#include "apps/page/page_views.h"
#include "nlos/pictures/image_layout.h"
#include "nlos/pictures/light_scale.h"
#include "nlos/preparation/wall_frame.h"
#include "renderer/core/json_file.h"

#include <fmt/core.h>

#include <numeric>

namespace apps {
namespace {

constexpr double kFaintest = 1e-5;     // of the brightest value; what is fainter is not shown
constexpr double kQuietShare = 0.001;  // of all light, before and after the bins called lit

/// Whose histogram each cell shows, cells in the film's order.
std::vector<std::size_t> pairs_of_cells(const core::WallScan& scan,
                                        const std::optional<nlos::WallGrid>& grid) {
    std::vector<std::size_t> pairs(scan.scanned_points().size());
    for (std::size_t cell = 0; cell < pairs.size(); ++cell) {
        const std::size_t point =
            grid ? grid->point(cell / grid->size[1], cell % grid->size[1]) : cell;
        pairs[cell] = nlos::pair_of(scan, point);
    }
    return pairs;
}

/// Sets what the cells are, and returns pairs_of_cells().
std::vector<std::size_t> lay_out(const core::ImageScan& image, FilmView& film) {
    const std::size_t width = image.camera.width();
    const std::size_t height = image.camera.height();
    film.kind = FilmView::Kind::Camera;
    film.size = {width, height};
    film.detail = fmt::format("image of {} × {} pixels", width, height);
    std::vector<std::size_t> pairs(image.num_pairs());
    for (std::size_t cell = 0; cell < pairs.size(); ++cell) {
        pairs[cell] = cell % width * height + cell / width;
    }
    return pairs;
}

std::vector<std::size_t> lay_out(const core::WallScan& scan, FilmView& film) {
    const std::optional<nlos::WallGrid> grid = nlos::derive_wall_frame(scan).grid;
    const std::string pattern(core::enum_name(scan.pattern));
    if (grid) {
        film.kind = FilmView::Kind::Wall;
        film.size = grid->size;
        film.x_m = nlos::cell_edges(grid->first_m[0], grid->pitch_m[0], grid->size[0]);
        film.y_m = nlos::cell_edges(grid->first_m[1], grid->pitch_m[1], grid->size[1]);
        film.detail = fmt::format("{} scan of {} × {} points", pattern, film.size[0], film.size[1]);
    } else {
        film.kind = FilmView::Kind::List;
        film.positions = scan.scanned_points().positions;
        film.size = {film.positions.size(), 1};
        film.detail = fmt::format("{} scan of {} points", pattern, film.size[0]);
    }
    if (scan.is_exhaustive()) {
        const bool of_lit = nlos::shows_lit_points(scan);
        const std::size_t others = (of_lit ? scan.sensing : scan.illumination).size();
        film.detail += of_lit ? ", sensed at " : ", lit at ";
        film.detail +=
            others == 1 ? "one point" : fmt::format("the middle one of {} points", others);
    }
    return pairs_of_cells(scan, grid);
}

/// Codes histograms that are stored one after another, and says which bins hold the light.
void code_light(const std::vector<float>& light, FilmView& film) {
    std::vector<double> per_bin(film.num_bins, 0.0);
    double total = 0.0;
    double faintest = std::numeric_limits<double>::infinity();
    double brightest = 0.0;
    for (std::size_t i = 0; i < light.size(); ++i) {
        const double value = light[i];
        film.whole = film.whole && value == std::round(value);
        if (!(value > 0.0)) continue;
        per_bin[i % film.num_bins] += value;
        total += value;
        faintest = std::min(faintest, value);
        brightest = std::max(brightest, value);
    }
    film.coding = {1.0, 1.0};
    if (brightest > 0.0) film.coding = {std::max(faintest, kFaintest * brightest), brightest};
    film.codes.clear();
    film.codes.reserve(light.size());
    for (const float value : light) film.codes.push_back(film.coding.encode(value));
    film.lit_bins = {0, film.num_bins - 1};
    double sum = 0.0;
    for (std::size_t bin = 0; bin < film.num_bins && total > 0.0; ++bin) {
        if (sum <= kQuietShare * total) film.lit_bins[0] = bin;
        sum += per_bin[bin];
        if (sum >= (1.0 - kQuietShare) * total) {
            film.lit_bins[1] = bin;
            break;
        }
    }
}

void show_frames(const core::Capture& capture,
                 const std::vector<std::size_t>& pairs,
                 FilmView& film) {
    const core::FrameSequence& sequence = *capture.sequence;
    film.num_bins = sequence.frames.size();
    std::vector<float> light;
    for (const std::size_t pair : pairs) {
        for (const core::Transient& frame : sequence.frames) {
            const auto histogram = frame.histogram(pair);
            light.push_back(std::accumulate(histogram.begin(), histogram.end(), 0.0F));
        }
    }
    for (std::size_t i = 0; i < film.num_bins; ++i) {
        const double moved_m = static_cast<double>(film.num_bins - 1 - i) * sequence.gate_step_m;
        film.labels.push_back(fmt::format("frame {}, path length {:.4g} to {:.4g} m",
                                          i,
                                          capture.time_axis.opl_start_m - moved_m,
                                          capture.time_axis.opl_end_m() - moved_m));
    }
    code_light(light, film);
}

void show_time(const core::Capture& capture,
               const std::vector<std::size_t>& pairs,
               FilmView& film) {
    const std::size_t num_bins = capture.transient.num_bins();
    std::size_t first = num_bins;
    std::size_t end = 0;
    for (const std::size_t pair : pairs) {
        const auto histogram = capture.transient.histogram(pair);
        for (std::size_t bin = 0; bin < num_bins; ++bin) {
            if (!(histogram[bin] > 0.0F)) continue;
            first = std::min(first, bin);
            end = std::max(end, bin + 1);
        }
    }
    if (first >= end) {
        first = 0;
        end = num_bins;
    }
    film.num_bins = end - first;
    film.start_m = capture.time_axis.bin_begin_m(static_cast<double>(first));
    film.step_m = capture.time_axis.bin_width_m;
    std::vector<float> light;
    light.reserve(pairs.size() * film.num_bins);
    for (const std::size_t pair : pairs) {
        const auto lit = capture.transient.histogram(pair).subspan(first, film.num_bins);
        light.insert(light.end(), lit.begin(), lit.end());
    }
    code_light(light, film);
}

}  // namespace

FilmView film_view(const core::Capture& capture, const std::string& name) {
    FilmView film;
    film.name = name;
    film.unit = core::enum_name(capture.unit);
    if (nlos::light_label(capture) == nlos::kRenderedRadiance) film.unit = "W/(m² sr)";
    const std::vector<std::size_t> pairs =
        capture.scan.visit([&](const auto& kind) { return lay_out(kind, film); });
    if (capture.sequence) {
        show_frames(capture, pairs, film);
    } else {
        show_time(capture, pairs, film);
    }
    return film;
}

FilmView halved(const FilmView& film) {
    if (!film.labels.empty() || film.num_bins < 2) return film;
    FilmView half = film;
    half.num_bins = (film.num_bins + 1) / 2;
    half.step_m = 2.0 * film.step_m;
    half.merged = 2 * film.merged;
    std::vector<float> light(film.codes.size() / film.num_bins * half.num_bins, 0.0F);
    for (std::size_t i = 0; i < film.codes.size(); ++i) {
        const std::size_t cell = i / film.num_bins;
        const std::size_t bin = i % film.num_bins / 2;
        const double value = film.coding.decode(film.codes[i]);
        light[cell * half.num_bins + bin] +=
            static_cast<float>(film.whole ? std::round(value) : value);
    }
    code_light(light, half);
    return half;
}

core::Json film_json(const FilmView& film,
                     const core::Transform& frame_from_world,
                     PageArrays& arrays) {
    constexpr std::array kKinds{"wall", "camera", "list"};  // in the order of FilmView::Kind
    core::Json values = arrays.add(film.codes);
    values.update({{"coding", "log"}, {"low", film.coding.low}, {"high", film.coding.high}});
    core::Json json{{"name", film.name},
                    {"detail", film.detail},
                    {"unit", film.unit},
                    {"kind", kKinds[static_cast<std::size_t>(film.kind)]},
                    {"size", film.size},
                    {"axis", film.labels.empty() ? "path length" : "frame"},
                    {"bins", film.num_bins},
                    {"start", film.start_m},
                    {"step", film.step_m},
                    {"values", std::move(values)},
                    {"whole", film.whole},
                    {"first_lit", film.lit_bins[0]},
                    {"last_lit", film.lit_bins[1]}};
    if (film.kind == FilmView::Kind::Wall) json.update({{"x_m", film.x_m}, {"y_m", film.y_m}});
    if (film.kind == FilmView::Kind::List) {
        json["positions"] = add_points(arrays, film.positions, frame_from_world);
    }
    if (!film.labels.empty()) json["labels"] = film.labels;
    if (film.merged > 1) {
        json["reduced"] = fmt::format("{} bins are one, to keep the page small", film.merged);
    }
    return json;
}

}  // namespace apps
