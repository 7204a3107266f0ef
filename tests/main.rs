//! The tests: one binary, as most of the time that tests take to build goes into binaries. `cargo test --test tests NAME::` runs
//! the file `tests/NAME.rs`. Those that count allocations are a binary of their own, `tests/allocations`.
//!
//! Tests of systems of one's own take a third of the time to compile and are the same with all features: builds with `parquet`, which test files,
//! do without.
#![allow(missing_docs)]
#![cfg_attr(feature = "parquet", allow(dead_code))]

// What tests share.
mod command;
mod common;
mod drawn;

mod any_parameter;
mod any_parameter_slab;
mod any_units;
mod arcs;
mod attraction;
mod batch;
mod boxes;
#[cfg(not(feature = "parquet"))]
mod branch_ends;
mod branches;
mod branches_equilibria;
mod branches_once;
mod branches_orbits;
mod browser;
mod cli_input;
mod cli_runs;
mod cli_words;
mod cluster_branches;
mod cluster_equilibria;
mod clusters;
mod continuation;
mod curves_equilibria;
mod curves_orbits;
#[cfg(feature = "sundials")]
mod cvode_integrator;
mod damping;
mod damping_derivatives;
mod derivatives;
mod difference_chart;
#[cfg(not(feature = "parquet"))]
mod dimensions;
mod double_double;
#[cfg(unix)]
mod durability_files;
#[cfg(unix)]
mod durability_kills;
mod eigenvalues;
mod ensemble;
mod ensemble_input;
mod equilibria;
#[cfg(not(feature = "parquet"))]
mod equilibria_generic;
mod equilibria_random;
mod estimates;
mod events;
mod extremes;
mod figures_of_laws;
mod fit;
mod fit_command;
mod fit_printing;
mod fit_recorded;
mod fit_records;
mod fit_steps;
mod friction;
mod growing_periods;
mod guide;
mod internals;
mod invariant_planes;
mod ivp;
mod ivp_events;
mod ivp_formulas;
mod ivp_solutions;
#[cfg(target_arch = "x86_64")]
mod kernels;
mod lanes;
mod law_bifurcations;
mod law_parameters;
mod lyapunov;
mod many;
#[cfg(not(feature = "parquet"))]
mod many_dimensions;
mod many_equilibria;
mod many_methods;
#[cfg(not(feature = "parquet"))]
mod multiple_points;
#[cfg(not(feature = "parquet"))]
mod normal_forms_of_systems;
mod numbers;
mod options_used;
mod orbit_kinds;
mod orbit_rows;
mod orbits;
#[cfg(not(feature = "parquet"))]
mod orbits_of_systems;
mod oscillators;
mod packages;
mod page;
#[cfg(not(feature = "parquet"))]
mod parameters;
mod parameters_by_name;
#[cfg(feature = "parquet")]
mod parquet;
mod periodic_schur;
mod pictures;
mod polynomials;
mod powers;
mod programs;
mod programs_input;
mod ratios;
mod reproduce;
#[cfg(not(feature = "parquet"))]
mod resonances_of_systems;
mod rooms;
mod rosenbrock;
mod rosenbrock_classics;
mod rosenbrock_extremes;
mod rosenbrock_tangent;
mod row_times;
mod run;
mod said;
mod scenes;
mod scenes_of_states;
mod schema;
mod scorecard;
mod section_exponents;
mod section_landings;
mod section_regimes;
#[cfg(not(feature = "parquet"))]
mod sections_of_systems;
mod series_of_interfaces;
mod slip_events;
mod solution_curves;
mod special_points;
mod step_ends;
mod stress;
mod strong_resonance;
#[cfg(feature = "sundials")]
mod sundials;
mod sweep;
mod sweep_any;
mod sweep_basins;
mod sweep_parts;
mod sweep_rows;
mod sweep_unbounded;
mod switching;
#[cfg(not(feature = "parquet"))]
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
mod transport;
mod unequal;
mod unequal_commands;
mod unequal_equilibria;
mod work_precision;
