// SPDX-License-Identifier: MIT
#pragma once

// The measurement of every row of the catalogue, by the file it is in. Each returns what its row
// bounds: see catalogue.cpp, time_rows.cpp and transport_rows.cpp.

namespace hard_cases {

// transport_cases.cpp
double density_with_nearly_coincident_foci();
double density_near_the_tangent_point();
double density_at_the_tangent_point();
double density_near_the_segment_of_the_foci();
double density_on_the_segment_of_the_foci();
double density_beside_a_focus_on_the_surface();
double drawn_length_of_kilometre_segments();
double inverse_of_drawn_vertices();
double random_connections_that_are_wrong();
double gradients_of_the_length_beside_a_focus();
double gradient_of_the_length_between_the_foci();
double gradients_of_the_velocity_beside_a_focus();

// shift_cases.cpp
double plane_shift_of_coincident_foci();
double plane_shift_of_nearly_coincident_foci();
double plane_shift_of_foci_a_kilometre_away();
double newton_shift_determinant();
double shift_there_and_back();
double hard_shifts_accepted_wrongly();

// bsdf_cases.cpp
double mirror_like_lobe_at_all_angles();
double mirror_like_density_integrates_to_one();
double mirror_like_draws_at_grazing_incidence();

// geometry_cases.cpp
double path_length_in_all_units();
double areas_and_normals_of_slivers();
double transport_at_grazing_angles();
double distances_of_grazing_rays_far_away();
double coplanar_and_touching_facets_in_the_way();

// time_cases.cpp
double bins_of_kilometre_segments();
double edges_of_tiny_and_huge_bins();
double edges_of_the_velocity_axis();
double bounds_of_lengths_over_facets();
double light_before_the_first_arrival();
double energy_of_tiny_and_huge_bins();
double third_bounce_in_all_units();

// histogram_cases.cpp
double box_kernel_of_small_and_large_triangles();
double box_kernel_a_million_bins_out();
double smeared_kernel_at_all_widths();
double gradients_of_the_smeared_kernel();

// arcs_cases.cpp
double exact_arcs_of_tiny_triangles();
double kernel_of_tiny_triangles_and_slivers();
double exact_arcs_of_a_facet_of_kilometres();
double exact_arcs_of_coplanar_triangles();

// response_cases.cpp
double response_with_narrow_core_or_tail();
double moments_of_responses_across_bins();
double shifts_by_parts_of_a_bin();
double squared_range_far_from_the_wall();
double phases_of_a_billion_turns();

// signal_cases.cpp
double deviance_of_nearly_expected_counts();
double deviance_of_no_and_of_huge_counts();
double expected_deviance_from_dark_to_bright();
double first_photons_of_a_saturated_detector();
double rates_behind_pile_up();
double steady_light_on_a_blind_detector();
double bright_peaks_on_a_blind_detector();
double detections_within_a_blind_time();
double budgets_from_one_photon_to_a_quadrillion();
double differences_of_dim_and_bright_captures();
double a_single_photon_in_ten_thousand_bins();

// scan_cases.cpp
double wall_frame_far_from_the_origin();
double wall_frames_of_points_lines_and_duplicates();
double light_on_curved_and_irregular_walls();
double a_point_seen_from_duplicates_and_lists();
double neighbours_of_duplicate_points();

// fit_cases.cpp
double errors_of_nearly_collinear_parameters();
double gradients_of_the_light_of_tiny_and_large_objects();
double direct_returns_of_few_and_of_many_counts();

}  // namespace hard_cases
