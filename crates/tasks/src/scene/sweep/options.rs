//! What a user can set of sweeps; as in `options` above, these fields are the flags and the keys of a scene file.

use super::super::ensemble::EnsembleOptions;
use super::super::options::{OutputOptions, SlabOptions, count, number};
use clap::Parser;
use std::path::PathBuf;
use twinslip::integrate::MAX_STEPS;

/// `sweep`: the regime at every point of a grid.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct SweepOptions {
    /// What slides.
    #[command(flatten)]
    pub slab: SlabOptions,
    /// The uncertainty of a fit.
    #[command(flatten)]
    pub ensemble: EnsembleOptions,
    /// N values of V_H from A to B, both included; with log equally spaced in ln V_H. A single value keeps V_H fixed
    #[arg(
        long,
        value_name = "A:B:N[log]",
        allow_hyphen_values = true,
        help_heading = "Grid"
    )]
    pub driving: Option<String>,
    /// M values of K from A to B, both included; with log equally spaced in ln K. A single value keeps K fixed
    #[arg(
        long,
        value_name = "A:B:M[log]",
        allow_hyphen_values = true,
        help_heading = "Grid"
    )]
    pub stiffness: Option<String>,
    /// Values of any other parameter by name: healing_time=10:1000:30log, of one interface residual_strength_2=1e-4:1e-2:20log, of a
    /// --system any parameter, which may be negative. Repeatable: two parameters vary at most, in the order V_H, K, then these, the first
    /// fastest
    #[arg(
        long,
        value_name = "NAME=A:B:N[log]",
        value_delimiter = ',',
        allow_hyphen_values = true,
        help_heading = "Grid"
    )]
    pub grid: Vec<String>,
    /// With --system: the section whose returns give the regime, STATE=VALUE, crossed falling; or STATE, at the middle of its range after
    /// the transient [default: the first state]. For interfaces it is tau_ss at the mean slip rate
    #[arg(
        long,
        value_name = "STATE[=VALUE]",
        requires = "system",
        allow_hyphen_values = true,
        help_heading = "Grid"
    )]
    pub surface: Option<String>,
    /// With --system: the values of all states in order, where the first run of every point starts [default: its table start]
    #[arg(
        long,
        value_name = "START",
        requires = "system",
        allow_hyphen_values = true,
        help_heading = "Grid"
    )]
    pub start: Option<String>,
    /// A grid of starting states instead of parameters: the attractor to which each leads, at one V_H and K or for one --system
    #[arg(long, requires_all = ["state_1", "state_2"], conflicts_with_all = ["follow", "starts"], help_heading = "Grid")]
    pub basin: bool,
    /// With --basin: the starting values of psi1; or of any state by name, as x=-2:2:50 of a --system, or stress, state_1 or state_2 of
    /// interfaces
    #[arg(
        long = "state-1",
        value_name = "[NAME=]A:B:N[log]",
        requires = "basin",
        allow_hyphen_values = true,
        help_heading = "Grid"
    )]
    pub state_1: Option<String>,
    /// With --basin: the starting values of psi2, or of stress for a single interface; or of any other state by name
    #[arg(
        long = "state-2",
        value_name = "[NAME=]A:B:M[log]",
        requires = "basin",
        allow_hyphen_values = true,
        help_heading = "Grid"
    )]
    pub state_2: Option<String>,
    /// Number of starts at each point, with a row for each: the first beside the symmetric steady state, the second with equal interfaces,
    /// the third far from it, the others at random (--seed). With --system the first is its start, the others lie at random around it, in
    /// each state x within 1 + |x|
    #[arg(long, value_name = "S", value_parser = count, default_value_t = 1, help_heading = "Grid")]
    pub starts: usize,
    /// Seed of the random starts
    #[arg(long, value_name = "SEED", default_value_t = 1, help_heading = "Grid")]
    pub seed: u64,
    /// Start each point on the attractor found at the previous one along the first parameter: shorter transients, and hysteresis is visible
    #[arg(long, help_heading = "Grid")]
    pub follow: bool,
    /// Instead of regimes the values that this state comes back to on each attractor, a row each: its local maxima, or under a periodic forcing
    /// its values at the phase 0 (of --surface phase=VALUE with --system). One period of what is periodic, 200 values of what is not
    #[arg(long, value_name = "STATE", help_heading = "Grid")]
    pub diagram: Option<String>,
    /// Draw the map of regimes, or with one free parameter the returns along it, as FILE.svg or FILE.png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub plot: Option<PathBuf>,
    /// Bifurcations to draw over the map, comma-separated, named as in locus, or none
    #[arg(
        long,
        value_name = "NAMES",
        default_value = "pitchfork,hopf,orbit-pitchfork,period-doubling,torus",
        help_heading = "Output"
    )]
    pub curves: String,
    /// Continue FILE, the CSV of an interrupted run of the same sweep: its complete rows are kept
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub resume: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub output: OutputOptions,
    /// Threads [default: one per processor]; rows do not depend on their number
    #[arg(long, value_name = "N", value_parser = count, help_heading = "Running")]
    pub threads: Option<usize>,
    /// Compute only the I-th of N parts of the grid, I from 1; `twinslip merge` joins the files of all parts
    #[arg(
        long,
        value_name = "I/N",
        allow_hyphen_values = true,
        help_heading = "Running"
    )]
    pub shard: Option<String>,
    /// Relative local error tolerance
    #[arg(long, value_name = "X", default_value = "1e-8", value_parser = number, allow_negative_numbers = true, help_heading = "Numerics")]
    pub rtol: f64,
    /// Compute the largest Lyapunov exponent of every point, not only of those whose regime needs it
    #[arg(long, help_heading = "Numerics")]
    pub lyapunov: bool,
    /// A point is undecided after this many returns to its section
    #[arg(
        long,
        value_name = "N",
        value_parser = count,
        default_value_t = 2000,
        help_heading = "Numerics"
    )]
    pub max_returns: usize,
    /// A point is undecided after this many steps
    #[arg(long, value_name = "N", value_parser = count, default_value_t = MAX_STEPS, help_heading = "Numerics")]
    pub max_steps: usize,
}

/// The command line of a sweep, as its files tell it.
#[derive(Parser)]
pub(super) struct SweepLine {
    #[command(flatten)]
    pub options: SweepOptions,
}
