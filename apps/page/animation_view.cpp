// SPDX-License-Identifier: MIT
#include "apps/page/page_views.h"
#include "nlos/pictures/image_layout.h"
#include "nlos/pictures/light_scale.h"
#include "nlos/preparation/wall_frame.h"
#include "renderer/core/settings/json_file.h"

#include <fmt/core.h>

#include <numeric>

namespace apps {
namespace {

constexpr double kFaintest = 1e-5;        // of the brightest value; what is fainter is not shown
constexpr double kQuietFraction = 0.001;  // of all light, before and after the bins called lit

/// Whose histogram each cell shows, cells in the order of the view.
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
std::vector<std::size_t> lay_out(const core::ImageScan& image, AnimationView& view) {
    const std::size_t width = image.camera.width();
    const std::size_t height = image.camera.height();
    view.kind = AnimationView::Kind::Camera;
    view.size = {width, height};
    view.detail = fmt::format("image of {} × {} pixels", width, height);
    std::vector<std::size_t> pairs(image.num_pairs());
    for (std::size_t cell = 0; cell < pairs.size(); ++cell) {
        pairs[cell] = cell % width * height + cell / width;
    }
    return pairs;
}

std::vector<std::size_t> lay_out(const core::WallScan& scan, AnimationView& view) {
    const std::optional<nlos::WallGrid> grid = nlos::derive_wall_frame(scan).grid;
    const std::string pattern(core::enum_name(scan.pattern));
    if (grid) {
        view.kind = AnimationView::Kind::Wall;
        view.size = grid->size;
        view.x_m = nlos::cell_edges(grid->first_m[0], grid->pitch_m[0], grid->size[0]);
        view.y_m = nlos::cell_edges(grid->first_m[1], grid->pitch_m[1], grid->size[1]);
        view.detail = fmt::format("{} scan of {} × {} points", pattern, view.size[0], view.size[1]);
    } else {
        view.kind = AnimationView::Kind::List;
        view.positions = scan.scanned_points().positions;
        view.size = {view.positions.size(), 1};
        view.detail = fmt::format("{} scan of {} points", pattern, view.size[0]);
    }
    if (scan.is_exhaustive()) {
        const bool of_lit = nlos::shows_lit_points(scan);
        const std::size_t others = (of_lit ? scan.sensing : scan.illumination).size();
        view.detail += of_lit ? ", sensed at " : ", lit at ";
        view.detail +=
            others == 1 ? "one point" : fmt::format("the middle one of {} points", others);
    }
    return pairs_of_cells(scan, grid);
}

/// Codes histograms that are stored one after another, and says which bins hold the light.
void code_light(const std::vector<float>& light, AnimationView& view) {
    std::vector<double> per_bin(view.num_bins, 0.0);
    double total = 0.0;
    double faintest = std::numeric_limits<double>::infinity();
    double brightest = 0.0;
    for (std::size_t i = 0; i < light.size(); ++i) {
        const double value = light[i];
        view.whole = view.whole && value == std::round(value);
        if (!(value > 0.0)) continue;
        per_bin[i % view.num_bins] += value;
        total += value;
        faintest = std::min(faintest, value);
        brightest = std::max(brightest, value);
    }
    view.coding = {1.0, 1.0};
    if (brightest > 0.0) view.coding = {std::max(faintest, kFaintest * brightest), brightest};
    view.codes.clear();
    view.codes.reserve(light.size());
    for (const float value : light) view.codes.push_back(view.coding.encode(value));
    view.lit_bins = {0, view.num_bins - 1};
    double sum = 0.0;
    for (std::size_t bin = 0; bin < view.num_bins && total > 0.0; ++bin) {
        if (sum <= kQuietFraction * total) view.lit_bins[0] = bin;
        sum += per_bin[bin];
        if (sum >= (1.0 - kQuietFraction) * total) {
            view.lit_bins[1] = bin;
            break;
        }
    }
}

void show_frames(const core::Capture& capture,
                 const std::vector<std::size_t>& pairs,
                 AnimationView& view) {
    const core::FrameSequence& sequence = *capture.sequence;
    view.num_bins = sequence.frames.size();
    std::vector<float> light;
    for (const std::size_t pair : pairs) {
        for (const core::Transient& frame : sequence.frames) {
            const auto histogram = frame.histogram(pair);
            light.push_back(std::accumulate(histogram.begin(), histogram.end(), 0.0F));
        }
    }
    for (std::size_t i = 0; i < view.num_bins; ++i) {
        const double moved_m = static_cast<double>(view.num_bins - 1 - i) * sequence.gate_step_m;
        view.labels.push_back(fmt::format("frame {}, path length {:.4g} to {:.4g} m",
                                          i,
                                          capture.time_axis.opl_start_m - moved_m,
                                          capture.time_axis.opl_end_m() - moved_m));
    }
    code_light(light, view);
}

void show_time(const core::Capture& capture,
               const std::vector<std::size_t>& pairs,
               AnimationView& view) {
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
    view.num_bins = end - first;
    view.start_m = capture.time_axis.bin_begin_m(static_cast<double>(first));
    view.step_m = capture.time_axis.bin_width_m;
    std::vector<float> light;
    light.reserve(pairs.size() * view.num_bins);
    for (const std::size_t pair : pairs) {
        const auto lit = capture.transient.histogram(pair).subspan(first, view.num_bins);
        light.insert(light.end(), lit.begin(), lit.end());
    }
    code_light(light, view);
}

}  // namespace

AnimationView animation_view(const core::Capture& capture, const std::string& name) {
    AnimationView view;
    view.name = name;
    view.unit = core::enum_name(capture.unit);
    if (nlos::light_label(capture) == nlos::kRenderedRadiance) view.unit = "W/(m² sr)";
    const std::vector<std::size_t> pairs =
        capture.scan.visit([&](const auto& kind) { return lay_out(kind, view); });
    if (capture.sequence) {
        show_frames(capture, pairs, view);
    } else {
        show_time(capture, pairs, view);
    }
    return view;
}

AnimationView halved(const AnimationView& view) {
    if (!view.labels.empty() || view.num_bins < 2) return view;
    AnimationView half = view;
    half.num_bins = (view.num_bins + 1) / 2;
    half.step_m = 2.0 * view.step_m;
    half.merged = 2 * view.merged;
    std::vector<float> light(view.codes.size() / view.num_bins * half.num_bins, 0.0F);
    for (std::size_t i = 0; i < view.codes.size(); ++i) {
        const std::size_t cell = i / view.num_bins;
        const std::size_t bin = i % view.num_bins / 2;
        const double value = view.coding.decode(view.codes[i]);
        light[cell * half.num_bins + bin] +=
            static_cast<float>(view.whole ? std::round(value) : value);
    }
    code_light(light, half);
    return half;
}

int halvings_of(const AnimationView& view) {
    return view.labels.empty() ? halvings_of(view.num_bins) : 0;
}

core::Json animation_json(AnimationView view,
                          const core::Transform& frame_from_world,
                          int halvings,
                          PageArrays& arrays) {
    halvings = std::min(halvings, halvings_of(view));
    for (int i = 0; i < halvings; ++i) view = halved(view);
    constexpr std::array kKinds{"wall", "camera", "list"};  // in the order of AnimationView::Kind
    core::Json values = arrays.add(view.codes);
    values.update({{"coding", "log"}, {"low", view.coding.low}, {"high", view.coding.high}});
    core::Json json{{"name", view.name},
                    {"detail", view.detail},
                    {"unit", view.unit},
                    {"kind", kKinds[static_cast<std::size_t>(view.kind)]},
                    {"size", view.size},
                    {"axis", view.labels.empty() ? "path length" : "frame"},
                    {"bins", view.num_bins},
                    {"start", view.start_m},
                    {"step", view.step_m},
                    {"values", std::move(values)},
                    {"whole", view.whole},
                    {"first_lit", view.lit_bins[0]},
                    {"last_lit", view.lit_bins[1]}};
    if (view.kind == AnimationView::Kind::Wall) json.update({{"x_m", view.x_m}, {"y_m", view.y_m}});
    if (view.kind == AnimationView::Kind::List) {
        json["positions"] = add_points(arrays, view.positions, frame_from_world);
    }
    if (!view.labels.empty()) json["labels"] = view.labels;
    if (view.merged > 1) {
        json["reduced"] = fmt::format("{} bins are one, to keep the page small", view.merged);
    }
    return json;
}

}  // namespace apps
