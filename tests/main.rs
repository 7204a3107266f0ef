//! The tests whose results are the same with all features of a build; the others are in `features.rs`. `cargo test NAME::` runs the file
//! `tests/NAME.rs`. There are these two binaries, as most of the time that tests take to build goes into binaries, and one of the tests that
//! count allocations, `tests/allocations`.
#![allow(missing_docs)]

// What tests share.
mod command;
mod common;
mod drawn;

mod any_parameter;
mod any_parameter_slab;
mod any_units;
mod any_units_branches;
mod arcs;
mod attraction;
mod batch;
mod boxes;
mod branch_ends;
mod branches_equilibria;
mod branches_once;
mod branches_orbits;
mod browser;
mod cluster_branches;
mod cluster_equilibria;
mod clusters;
mod codimension_two;
mod continuation;
mod crossings;
mod curves_equilibria;
mod curves_orbits;
mod curves_that_begin;
#[cfg(feature = "sundials")]
mod cvode_integrator;
mod damping;
mod damping_derivatives;
mod derivatives;
mod description;
mod diagrams;
mod difference_chart;
mod dimensions;
mod double_double;
#[cfg(unix)]
mod durability_files;
#[cfg(unix)]
mod durability_kills;
mod eigenvalues;
mod ensemble;
mod ensemble_input;
mod equilibria_generic;
mod equilibria_pictures;
mod estimates;
mod events;
#[cfg(feature = "explore")]
mod explore_answers;
#[cfg(feature = "explore")]
mod explore_hostile;
#[cfg(feature = "explore")]
mod explore_queue;
#[cfg(feature = "explore")]
mod explore_refused;
#[cfg(feature = "explore")]
mod explore_starts;
mod figures_of_laws;
mod fit;
mod fit_command;
mod fit_coverage;
mod fit_formats;
mod fit_laboratory;
mod fit_look;
mod fit_mutations;
mod fit_printing;
mod fit_recorded;
mod fit_records;
mod fit_steps;
mod forced;
mod friction;
mod golden;
mod growing_periods;
#[cfg(unix)]
mod guide;
mod homoclinic;
mod invariant_planes;
mod ivp;
mod ivp_events;
mod ivp_formulas;
mod ivp_solutions;
mod jacobian_differences;
#[cfg(target_arch = "x86_64")]
mod kernels;
mod lanes;
mod large;
mod law_bifurcations;
mod law_data;
mod law_parameters;
mod laws_by_name;
mod lyapunov;
mod many;
mod many_dimensions;
mod many_equilibria;
mod many_methods;
mod many_variables;
mod many_variables_branches;
mod many_variables_orbits;
mod modulated;
mod more_states;
mod multiple_points;
#[cfg(target_arch = "x86_64")]
mod new_parameters;
mod normal_forms_of_autonomous_resonances;
mod normal_forms_of_resonances;
mod normal_forms_of_systems;
mod numbers;
mod options_used;
mod orbit_kinds;
mod orbit_rows;
mod orbits_of_systems;
mod oscillators;
mod packages;
mod page;
mod parameters;
mod parameters_by_name;
mod periodic_schur;
mod phase_response;
mod pictures;
mod points_met;
mod polynomials;
mod powers;
mod programs;
mod programs_input;
mod radau;
mod ratios;
mod reference;
mod reproduce;
mod resonances_of_systems;
mod rooms;
mod rosenbrock;
mod rosenbrock_classics;
mod rosenbrock_extremes;
mod rosenbrock_tangent;
mod row_times;
mod run;
mod said;
mod scenes_of_states;
mod section_exponents;
mod section_landings;
mod section_regimes;
mod sections_of_systems;
mod series_of_interfaces;
mod si_varies;
mod slip_events;
mod solution_curves;
mod special_points;
mod spikes;
mod spring_sliders;
mod step_ends;
mod strong_resonance;
#[cfg(feature = "sundials")]
mod sundials;
mod sweep;
mod sweep_any;
mod sweep_basins;
mod sweep_unbounded;
mod switching;
mod systems;
mod tableaus;
mod taylor;
mod text_commands;
mod text_files;
mod text_given;
mod text_laws;
mod text_laws_input;
mod text_laws_steady;
mod text_systems;
mod textbook_models;
mod time_in_formulas;
mod transport;
mod unequal;
mod unequal_commands;
mod unequal_equilibria;
mod user_functions;
mod versions;
mod work_precision;
