// SPDX-License-Identifier: MIT
#include "tests/hard_cases/cases.h"
#include "tests/hard_cases/hard_case.h"

namespace hard_cases {
namespace {

std::vector<HardCase> geometry_rows() {
    return {
        {"path_length_in_all_units",
         "geometry",
         "segments of 1e-9 m to 1e6 m, up to 1e9 m from the origin, vertices next to a focus",
         "length of both segments, relative",
         1e-15,
         path_length_in_all_units},
        {"areas_and_normals_of_slivers",
         "geometry",
         "edges nearly parallel: their cross product is a small difference, aspects to 1e8",
         "area, relative, and the normal's direction",
         1e-7,
         areas_and_normals_of_slivers},
        {"transport_at_grazing_angles",
         "geometry",
         "both cosines down to 1e-9",
         "BSDF x cosines / distance^2 of a connection",
         2e-7,
         transport_at_grazing_angles},
        {"distances_of_grazing_rays_far_away",
         "geometry",
         "rays at 1e-3 rad, scenes up to 1e6 m from the origin, single precision in the ray "
         "caster",
         "distance to the facet, relative",
         5e-15,
         distances_of_grazing_rays_far_away},
        {"coplanar_and_touching_facets_in_the_way",
         "geometry",
         "segments in the plane of facets, and between facets that touch, to 0.1 mm from their "
         "edge",
         "wrong answers of 60,000",
         0.0,
         coplanar_and_touching_facets_in_the_way},
    };
}

std::vector<HardCase> signal_rows() {
    return {
        {"deviance_of_nearly_expected_counts",
         "signal",
         "the difference of equal terms: counts 1e-12 to 0.8 from their expectation",
         "signed deviance and gradient, relative",
         5e-10,
         deviance_of_nearly_expected_counts},
        {"deviance_of_no_and_of_huge_counts",
         "signal",
         "none, one, 1e15; expectations 1e-12 to 1e15",
         "signed deviance and gradient, relative",
         1e-11,
         deviance_of_no_and_of_huge_counts},
        {"expected_deviance_from_dark_to_bright",
         "signal",
         "expectations 1e-9 to 80, from a sum to a series",
         "mean deviance of a count, relative",
         5e-7,
         expected_deviance_from_dark_to_bright},
        {"first_photons_of_a_saturated_detector",
         "signal",
         "1e-12 to 700 photons per bin: no pulse is left after the first",
         "counts over the first bin's",
         2e-15,
         first_photons_of_a_saturated_detector},
        {"rates_behind_pile_up",
         "signal",
         "Coates' inversion until 1e-4 of the pulses are left",
         "rate from expected counts, relative",
         1e-11,
         rates_behind_pile_up},
        {"steady_light_on_a_blind_detector",
         "signal",
         "blind for parts of and several periods, up to 0.1 photons per bin",
         "counts against p/(1 + b p), relative",
         5e-8,
         steady_light_on_a_blind_detector},
        {"bright_peaks_on_a_blind_detector",
         "signal",
         "a peak of 10 photons per bin, blind for one bin to 2.5 periods, in step with it too",
         "counts against the linear system of the steady state, relative",
         5e-8,
         bright_peaks_on_a_blind_detector},
        {"detections_within_a_blind_time",
         "signal",
         "up to 700 photons per bin: detections stay in step with the pulses",
         "detections in a blind time and one bin, beyond 1",
         1e-12,
         detections_within_a_blind_time},
        {"budgets_from_one_photon_to_a_quadrillion",
         "signal",
         "1e-6 to 1e15 photons, radiance 1e-30 to 1e30",
         "expected counts, relative",
         1e-7,
         budgets_from_one_photon_to_a_quadrillion},
        {"differences_of_dim_and_bright_captures",
         "signal",
         "squares of 1e-30 and of 1e30, negative values, differences of 1e-6",
         "relative mean square error, relative",
         1e-14,
         differences_of_dim_and_bright_captures},
        {"a_single_photon_in_ten_thousand_bins",
         "signal",
         "a budget of one photon, 100 times",
         "standard deviations of the sum of whole numbers",
         3.0,
         a_single_photon_in_ten_thousand_bins,
         "a Poisson number of mean 100; what is drawn is whole and not negative"},
    };
}

std::vector<HardCase> scan_rows() {
    return {
        {"wall_frame_far_from_the_origin",
         "scan shapes",
         "a turned grid up to 1e5 m away",
         "pitch, axes and centre",
         1e-10,
         wall_frame_far_from_the_origin},
        {"wall_frames_of_points_lines_and_duplicates",
         "scan shapes",
         "one point, lines, a grid of equal points, one of 4 nm",
         "axes orthonormal, points in their plane",
         1e-14,
         wall_frames_of_points_lines_and_duplicates},
        {"light_on_curved_and_irregular_walls",
         "scan shapes",
         "one point, irregular points of a bowl, each twice; all patterns",
         "third bounce of a 0.2 mm patch, relative",
         4e-7,
         light_on_curved_and_irregular_walls},
        {"a_point_seen_from_duplicates_and_lists",
         "scan shapes",
         "irregular points, each twice",
         "backprojection: twice as bright, at the same place",
         1e-6,
         a_point_seen_from_duplicates_and_lists},
        {"neighbours_of_duplicate_points",
         "scan shapes",
         "40 equal points among others",
         "distances of the four nearest",
         1e-15,
         neighbours_of_duplicate_points},
    };
}

std::vector<HardCase> fit_rows() {
    return {
        {"errors_of_nearly_collinear_parameters",
         "fits",
         "correlation 1 - 1e-8, units of 1e-8 to 1e8",
         "standard deviations, relative, and that it is said",
         5e-8,
         errors_of_nearly_collinear_parameters},
        {"gradients_of_the_light_of_tiny_and_large_objects",
         "fits",
         "objects of 1e-6 m to 2 m: divided differences by hand against automatic derivatives",
         "derivatives by the pose, relative L2",
         5e-10,
         gradients_of_the_light_of_tiny_and_large_objects},
        {"direct_returns_of_few_and_of_many_counts",
         "fits",
         "30 to 1e9 counts side by side",
         "place of each peak in bins, width, relative",
         5e-8,
         direct_returns_of_few_and_of_many_counts},
    };
}

}  // namespace

const std::vector<HardCase>& catalogue() {
    static const std::vector<HardCase> all = [] {
        std::vector<HardCase> rows;
        for (const auto& group : {geometry_rows(),
                                  time_rows(),
                                  transport_rows(),
                                  signal_rows(),
                                  scan_rows(),
                                  fit_rows()}) {
            rows.insert(rows.end(), group.begin(), group.end());
        }
        return rows;
    }();
    return all;
}

}  // namespace hard_cases
