// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/core/settings/json_fwd.h"

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace nlos {

// A layout says what the arrays of a file mean: which one holds the histograms, in what order of
// axes, and how wall points, bins and time zero follow from the others. It is data, a small JSON
// file, so that a new kind of file needs no new code: data/layouts/README.md explains the keys,
// data/layouts/*.json are those of the field.
//
// Arrays are named as ArrayReader names them; "other.mat:name" is an array of another file in the
// same folder. Axes are counted as the program counts them that wrote the file: MATLAB files as in
// MATLAB, all others slowest first.

/// A number that a layout gives, takes from an array, or asks for. In JSON a plain number is one
/// that is given.
struct LayoutNumber {
    std::optional<double> value;
    std::string array;    ///< it is one of the array's values
    int element = 0;      ///< which one, in storage order
    std::string step_of;  ///< it is the mean step of this array
    std::string peak_of;  ///< it is the bin in which this array, a histogram or several, peaks
    double factor = 1.0;  ///< from the array's unit to the key's
    double offset = 0.0;  ///< added after that
    std::string ask;      ///< the file does not hold it: values that publications give

    bool is_given() const {
        return value || !array.empty() || !step_of.empty() || !peak_of.empty() || !ask.empty();
    }
};

template <class Visitor>
void for_each_field(LayoutNumber& n, Visitor&& visit) {
    visit("value", n.value, "the number itself");
    visit("array", n.array, "array that holds it");
    visit("element", n.element, core::at_least(0, "which of the array's values, as stored"));
    visit("step_of", n.step_of, "array whose mean step it is");
    visit("peak_of", n.peak_of, "array of a histogram or several, in whose sum it is the peak");
    visit("factor", n.factor, "from the array's unit to that of the key");
    visit("offset", n.offset, "added after that");
    visit("ask", n.ask, "the file does not hold it: typical values, for the message");
}
void read_value(const core::Json& json, const std::string& where, LayoutNumber& number);
core::Json write_value(const LayoutNumber& number);

/// Arrays by name, each with the numbers of axes that it may have; axes of extent 1 need not count.
/// In JSON an object of numbers or lists of numbers.
struct LayoutRanks {
    std::map<std::string, std::vector<int>> of;
};
void read_value(const core::Json& json, const std::string& where, LayoutRanks& ranks);
core::Json write_value(const LayoutRanks& ranks);

struct LayoutRecognition {
    std::vector<std::string> containers;   ///< as ArrayReader::container() says; none: any
    LayoutRanks arrays;                    ///< that such files hold
    std::map<std::string, double> values;  ///< of scalars among these
    std::vector<std::string> absent;       ///< arrays that such files do not hold
    std::vector<std::string> beside;       ///< files in the same folder
    bool alone = false;                    ///< the histograms are all that such files hold
};

template <class Visitor>
void for_each_field(LayoutRecognition& r, Visitor&& visit) {
    visit("containers", r.containers, "kinds of files; none: any");
    visit("arrays", r.arrays, "arrays that such files hold, each with its number of axes");
    visit("values", r.values, "values that some of these have");
    visit("absent", r.absent, "arrays that they do not hold");
    visit("beside", r.beside, "files that lie beside them");
    visit("alone", r.alone, "they hold nothing but the histograms");
}

/// One axis of an array that stands for two, as lists of the points of a grid do.
struct LayoutSplit {
    std::string axis;
    std::vector<std::string> into;      ///< names of the two, in the writer's order
    std::vector<LayoutNumber> extents;  ///< numbers, or scalars of the file
};

template <class Visitor>
void for_each_field(LayoutSplit& s, Visitor&& visit) {
    visit("axis", s.axis, "axis that stands for two");
    visit("into", s.into, "their names, in the writer's order");
    visit("extents", s.extents, "their extents, numbers or arrays that hold them");
}

struct LayoutHistogram {
    std::vector<std::string> array;  ///< the first of these that the file holds
    std::vector<std::string> axes;   ///< see kHistogramAxes; any other name is summed over
    std::optional<LayoutSplit> split;
    bool also_reversed = false;  ///< the same axes from last to first are as good
    int first_order = 1;         ///< bounces of the first entry along the axis `order`
    bool square = false;         ///< x and y have one extent, which tells axes apart
    core::TransientUnit unit = core::TransientUnit::Counts;
    LayoutNumber is_counts;            ///< instead of unit: 0 says radiance
    LayoutNumber counts_per_radiance;  ///< 0: unknown
    std::vector<std::string>
        background;  ///< histograms without the object; their mean is subtracted
};

template <class Visitor>
void for_each_field(LayoutHistogram& h, Visitor&& visit) {
    visit("array", h.array, "the first of these arrays that the file holds");
    visit("axes",
          h.axes,
          "t, x, y, lx, ly, sx, sy, l, s, pair, frame, order; others are summed over");
    visit("split", h.split, "an axis that stands for two");
    visit("also_reversed", h.also_reversed, "the same axes from last to first are as good");
    visit("first_order",
          h.first_order,
          core::at_least(1, "bounces of the first entry along the axis order"));
    visit("square", h.square, "x and y have one extent");
    visit("unit", h.unit, "what the numbers are");
    visit("is_counts", h.is_counts, "instead of unit: 0 for radiance");
    visit("counts_per_radiance", h.counts_per_radiance, "scale of counts; 0: unknown");
    visit("background", h.background, "arrays without the object, whose mean is subtracted");
}

/// How long after the others a histogram starts.
struct LayoutShift {
    std::string array;  ///< one delay per histogram
    std::vector<std::string> axes{"x", "y"};
    double bins_per_unit = 1.0;  ///< delays are rounded down to whole bins
    bool required = true;        ///< whether the array must be there
};

template <class Visitor>
void for_each_field(LayoutShift& s, Visitor&& visit) {
    visit("array", s.array, "one delay per histogram");
    visit("axes", s.axes, "its axes");
    visit("bins_per_unit", s.bins_per_unit, "from its unit to bins, rounded down");
    visit("required", s.required, "whether it must be there");
}

struct LayoutBins {
    LayoutNumber width_m;
    LayoutNumber width_s;  ///< instead
    LayoutNumber start_m;  ///< of bin 0
    LayoutNumber start_s;
    LayoutNumber start_bins;
    LayoutNumber centre_m;  ///< of bin 0
    std::optional<LayoutShift> shift;
    int leading_unobserved = 0;
    bool zeros_are_unobserved = false;
};

template <class Visitor>
void for_each_field(LayoutBins& b, Visitor&& visit) {
    visit("width_m", b.width_m, "width in path length [m]");
    visit("width_s", b.width_s, "or in time [s]");
    visit("start_m", b.start_m, "path length at the start of bin 0 [m]");
    visit("start_s", b.start_s, "or time [s]");
    visit("start_bins", b.start_bins, "or in bins");
    visit("centre_m", b.centre_m, "or path length at the centre of bin 0 [m]");
    visit("shift", b.shift, "delays of single histograms, taken off");
    visit("leading_unobserved",
          b.leading_unobserved,
          core::at_least(0, "leading bins that were not observed, or hold the direct return"));
    visit("zeros_are_unobserved",
          b.zeros_are_unobserved,
          "leading and trailing bins that are 0 in all histograms were not observed");
}

enum class GridDirection { Increasing, Decreasing };
enum class GridSamples { EndsIncluded, CellCentres };

/// A grid around the origin of the wall z = 0.
struct LayoutGrid {
    std::vector<LayoutNumber> size_m;       ///< extent along x and y, or one for both; or:
    std::vector<LayoutNumber> half_size_m;  ///< half of it
    std::vector<LayoutNumber> pitch_m;      ///< distance of neighbours
    GridDirection x = GridDirection::Increasing;
    GridDirection y = GridDirection::Increasing;
    GridSamples samples = GridSamples::EndsIncluded;
};

template <class Visitor>
void for_each_field(LayoutGrid& g, Visitor&& visit) {
    visit("size_m", g.size_m, "extent along x and y, or one for both [m]");
    visit("half_size_m", g.half_size_m, "or half of it [m]");
    visit("pitch_m", g.pitch_m, "or the distance of neighbours [m]");
    visit("x", g.x, "how x runs along its axis");
    visit("y", g.y, "how y runs along its axis");
    visit("samples", g.samples, "whether the extent runs from the first to the last point");
}

/// Wall points: one of grid, array, or x and y.
struct LayoutPoints {
    std::optional<LayoutGrid> grid;
    std::string array;                                ///< coordinates, along an axis of extent 3
    std::vector<std::string> axes;                    ///< of array, "xyz" for the coordinates
    std::vector<std::string> columns{"x", "y", "z"};  ///< which coordinate each is; "-x" negates
    std::vector<std::string> list_order;  ///< how a list runs over two axes, slowest axis first
    std::string x;                        ///< arrays of one coordinate each, z = 0
    std::string y;
    LayoutNumber pitch_m;   ///< given: the arrays hold indices, these times it are metres
    std::string normals;    ///< as array; without: those of a plane through the points
    std::string index;      ///< the sensing point with these indices from 1, in the axes' order
    LayoutNumber wall_z_m;  ///< z becomes this minus z, and the wall looks along +z
    std::vector<double> position_m;  ///< one point
    /// Arrays of the first point, the last along x, the last along y: a grid between them.
    std::vector<std::string> corners;
};

template <class Visitor>
void for_each_field(LayoutPoints& p, Visitor&& visit) {
    visit("grid", p.grid, "a grid around the origin");
    visit("array", p.array, "or an array of points, coordinates along an axis of extent 3");
    visit("axes", p.axes, "its axes, xyz for the coordinates");
    visit("columns", p.columns, "which coordinate each column is; -x negates");
    visit("list_order", p.list_order, "how a list runs over two axes, slowest axis first");
    visit("x", p.x, "or an array of x");
    visit("y", p.y, "and one of y");
    visit("pitch_m", p.pitch_m, "the arrays hold indices, distance of neighbours [m]");
    visit("normals", p.normals, "array of normals");
    visit("index", p.index, "array of the indices of one of the other points, from 1");
    visit("wall_z_m", p.wall_z_m, "the wall's z, where the object is at the origin [m]");
    visit("position_m", p.position_m, "one point [m]");
    visit("corners", p.corners, "arrays of the corners of a grid: first, end of x, end of y");
}

enum class LayoutPattern { Single, Confocal, Exhaustive, ByPoints };

struct LayoutDevices {
    std::string laser;  ///< array of 3 values, world [m]
    std::string detector;
    std::vector<double> position_m;  ///< of both; or:
    LayoutNumber distance_m;         ///< of both from the wall z = 0, above its origin
    bool legs_included = false;      ///< whether path lengths start and end there
    LayoutNumber legs_excluded;      ///< instead: 0 says included
};

template <class Visitor>
void for_each_field(LayoutDevices& d, Visitor&& visit) {
    visit("laser", d.laser, "array of the laser's position [m]");
    visit("detector", d.detector, "array of the detector's position [m]");
    visit("position_m", d.position_m, "position of both [m]");
    visit("distance_m", d.distance_m, "or their distance from the origin of the wall z = 0 [m]");
    visit("legs_included", d.legs_included, "path lengths start and end at the devices");
    visit("legs_excluded", d.legs_excluded, "instead: 0 says that they do");
}

struct Layout {
    std::string name;
    std::string title;
    std::string source;  ///< publication, a key of REFERENCES.md
    bool tried = true;   ///< on a file of others
    LayoutRecognition recognise;
    LayoutHistogram histogram;
    LayoutBins bins;
    LayoutPattern pattern = LayoutPattern::Confocal;
    LayoutPoints sensing;
    LayoutPoints illumination;  ///< confocal: none, they are the sensing points
    LayoutDevices devices;
    bool files_are_frames = false;   ///< several such files, or a folder of them, are a sequence
    LayoutNumber response_fwhm_s;    ///< of the detector, goes to the provenance
    LayoutNumber spot_fwhm_m;        ///< on the wall, likewise
    std::vector<std::string> keep;   ///< short arrays that go to the provenance
    std::vector<std::string> notes;  ///< what a user should know, shown by `nlos info`
};

template <class Visitor>
void for_each_field(Layout& l, Visitor&& visit) {
    visit("name", l.name, "short name");
    visit("title", l.title, "name for people");
    visit("source", l.source, "publication");
    visit("tried", l.tried, "whether a file of others was read");
    visit("recognise", l.recognise, "how such files are told");
    visit("histogram", l.histogram, "where the histograms are");
    visit("bins", l.bins, "the axis of path lengths");
    visit("pattern", l.pattern, "how points pair up");
    visit("sensing", l.sensing, "points that are looked at");
    visit("illumination", l.illumination, "points that are lit");
    visit("devices", l.devices, "laser and detector");
    visit("files_are_frames", l.files_are_frames, "several files are frames");
    visit("response_fwhm_s", l.response_fwhm_s, "full width at half maximum of the response [s]");
    visit("spot_fwhm_m", l.spot_fwhm_m, "full width at half maximum of the spot on the wall [m]");
    visit("keep", l.keep, "short arrays that go to the provenance");
    visit("notes", l.notes, "what a user should know");
}

/// Throws core::Error unless the keys fit together.
void validate(const Layout& layout, const std::string& where);

/// Reads and validates a layout. Throws core::Error naming file and key.
Layout read_layout(const std::string& path);

/// The layouts that the program knows, data/layouts/*.json, in the order in which a file is tried.
const std::vector<Layout>& shipped_layouts();

/// The shipped layout of this name, or the one in the JSON file `name_or_path`.
/// Throws core::Error that lists the names when there is neither.
Layout find_layout(const std::string& name_or_path);

/// Name and text of data/layouts/*.json, which are compiled into the program.
const std::vector<std::pair<std::string_view, std::string_view>>& shipped_layout_texts();

}  // namespace nlos

template <>
struct core::EnumNames<nlos::GridDirection> {
    static constexpr auto value =
        core::names_from_zero<nlos::GridDirection>("increasing", "decreasing");
};
template <>
struct core::EnumNames<nlos::GridSamples> {
    static constexpr auto value =
        core::names_from_zero<nlos::GridSamples>("ends_included", "cell_centres");
};

template <>
struct core::EnumNames<nlos::LayoutPattern> {
    static constexpr auto value =
        core::names_from_zero<nlos::LayoutPattern>("single", "confocal", "exhaustive", "by_points");
};
