//! What a user can set. Declared once: the flags of the command line, their help and the keys of a scene file are these
//! fields, so they cannot drift apart.

use super::ensemble::EnsembleOptions;
use super::shipped::law_names;
use super::text::TextOptions;
use super::units::TimeUnit;
use clap::builder::{PossibleValue, TypedValueParser};
use std::path::PathBuf;
use twinslip::friction::AnyLaw;
use twinslip::integrate::Choice;

const START_HELP: &str = "Initial state: TAU,PSI1,PSI2 (TAU,PSI for one interface), or near-symmetric[:EPS]: tau and psi1 at the \
    symmetric steady state and psi2 = psi1 exp(EPS), EPS = 0.01 by default, or -0.01 where psi2 would exceed 1; unequal interfaces start \
    at their steady states at V_H/2, the second psi times exp(EPS) [default: near-symmetric; of one interface under a program near-symmetric:0, its \
    steady state]. For N interfaces or clusters: one psi \
    each, or spread[:EPS[:SEED]], psi at the steady state times exp(EPS z) with z drawn between -1 and 1 [default from 8 interfaces on]. For a system from a file: all states in order [default: its table start]";

const ORBIT_START_HELP: &str = "A point on or near the orbit: TAU,PSI1,PSI2 (TAU,PSI for one interface); near-symmetric[:EPS]; or \
    hopf, for the branch from the nearest Hopf point along V_H. By default the orbit is searched for. For a system from a file: \
    all states in order [default: its table start]";

/// The laws with their sources, for help.
fn laws() -> String {
    let laws = AnyLaw::NAMES.iter().zip(AnyLaw::SOURCES);
    let laws: Vec<_> = laws
        .map(|(name, source)| format!("{name} {source}"))
        .collect();
    format!(
        "Friction law, with its equation in the paper or its source: {}; ageing is dieterich-ruina. Or one of {}. Or a user-defined law: \
         FILE.toml with slip_rate (in tau and psi), evolution (in v, psi and stress_rate) and parameters",
        listed(&laws),
        listed(&law_names()[AnyLaw::NAMES.len()..])
    )
}

/// a, b or c.
fn listed(all: &[impl AsRef<str>]) -> String {
    let all: Vec<&str> = all.iter().map(AsRef::as_ref).collect();
    match &all[..] {
        [others @ .., last] if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        _ => all.concat(),
    }
}

/// What slides and how it is driven; the defaults are the paper's.
#[derive(Debug, Clone, PartialEq, clap::Args)]
#[command(next_help_heading = "Model")]
pub struct ModelOptions {
    /// Driving velocity V_H [V*; m/s with --si]
    #[arg(long, value_name = "V_H", conflicts_with = "system", value_parser = number, allow_negative_numbers = true)]
    pub driving: Option<f64>,
    /// Stiffness K = k L/(a sigma) [a sigma/L; k in Pa/m with --si]
    #[arg(long, value_name = "K", conflicts_with = "system", value_parser = number, allow_negative_numbers = true)]
    pub stiffness: Option<f64>,
    /// What slides.
    #[command(flatten)]
    pub slab: SlabOptions,
}

/// The friction law, how many interfaces there are, and the units.
#[derive(Debug, Clone, PartialEq, clap::Args)]
#[command(next_help_heading = "Model")]
pub struct SlabOptions {
    /// Another system.
    #[command(flatten)]
    pub text: TextOptions,
    /// Friction law.
    #[arg(long, value_name = "NAME", help = laws(), default_value = "spinodal", value_parser = Names::of(law_names()), hide_possible_values = true)]
    pub law: String,
    /// Number N of frictional interfaces, all under the same stress: up to 7 independent ones, up to 600 in equilibria, up to millions in
    /// integrate [default: the sum of --clusters, or 2]
    #[arg(long, value_name = "N")]
    pub interfaces: Option<u32>,
    /// Group equal interfaces into clusters that move together: the sizes of the clusters, N in total. States, slip rates and starts then
    /// have one number per cluster
    #[arg(long, value_name = "N1,N2,...")]
    pub clusters: Option<String>,
    /// Healing time R = t** V*/L [default: 100 L/V*; t** in s with --si]
    #[arg(long, value_name = "R", value_parser = number, allow_negative_numbers = true)]
    pub healing_time: Option<f64>,
    /// Residual strength c of the spinodal law [default: 1e-3]
    #[arg(long, value_name = "c", value_parser = number, allow_negative_numbers = true)]
    pub residual_strength: Option<f64>,
    /// Direct effect a [default: 0.0349]
    #[arg(long, value_name = "a", value_parser = number, allow_negative_numbers = true)]
    pub direct_effect: Option<f64>,
    /// Evolution effect b [default: 0.0489]
    #[arg(long, value_name = "b", value_parser = number, allow_negative_numbers = true)]
    pub evolution_effect: Option<f64>,
    /// Friction coefficient a_v at V* [default: 0.369]
    #[arg(long, value_name = "a_v", value_parser = number, allow_negative_numbers = true)]
    pub reference_friction: Option<f64>,
    /// Radiation damping eta V*/(a sigma): tau - eta v stands in place of tau in the law [default: 0; eta in Pa s/m with --si]
    #[arg(long, value_name = "ETA", value_parser = number, allow_negative_numbers = true, conflicts_with_all = ["shear_modulus", "shear_wave_speed"])]
    pub damping: Option<f64>,
    /// Evolution effect b2 of a second state variable, which may be negative: tau gains b2 ln(theta_2 V*/L2)/a, and theta_2 evolves by the
    /// law with L2. Needs --second-slip-length
    #[arg(long, value_name = "b2", value_parser = number, allow_negative_numbers = true)]
    pub second_evolution_effect: Option<f64>,
    /// Slip length L2 of the second state variable [L; m with --si]
    #[arg(long, value_name = "L2", value_parser = number, allow_negative_numbers = true)]
    pub second_slip_length: Option<f64>,
    /// Mass m of an interface per area, m V*^2/(a sigma L): m dv/dt is the stress less the friction at v, and v a variable of its own
    /// [default: 0, without inertia; m in kg/m^2 with --si]
    #[arg(long, value_name = "m", value_parser = number, allow_negative_numbers = true)]
    pub mass: Option<f64>,
    /// Let driving or normal_stress vary, as its value times 1 + EPS cos(2 pi (t/PERIOD + PHASE)); repeatable. For integrate, orbit, section,
    /// sweep, and branch and locus of orbits
    #[arg(
        long,
        value_name = "NAME=EPS:PERIOD[:PHASE]",
        allow_hyphen_values = true
    )]
    pub modulate: Vec<String>,
    /// Coefficient alpha of Linker and Dieterich (1992), for a normal stress sigma that varies: dtheta/dt has the term -(alpha theta/b)
    /// (dsigma/dt)/sigma [default: 0]
    #[arg(long, value_name = "alpha", value_parser = number, allow_negative_numbers = true)]
    pub normal_stress_coupling: Option<f64>,
    /// All input and output in SI units; implied by a value with a unit, such as 10um, 50MPa, 1nm/s or 500year
    #[arg(long, help_heading = "SI units")]
    pub si: bool,
    /// With --si: slip length L in m [default: 0.9e-6]
    #[arg(long, help_heading = "SI units", value_name = "L", requires = "si", value_parser = number, allow_negative_numbers = true)]
    pub slip_length: Option<f64>,
    /// With --si: normal stress sigma in Pa; it only scales stress and stiffness, and the paper gives none [default: 1e6]
    #[arg(long, help_heading = "SI units", value_name = "sigma", requires = "si", value_parser = number, allow_negative_numbers = true)]
    pub normal_stress: Option<f64>,
    /// With --si: V* in m/s [default: 1e-6]
    #[arg(long, help_heading = "SI units", value_name = "V*", requires = "si", value_parser = number, allow_negative_numbers = true)]
    pub reference_rate: Option<f64>,
    /// With --si: unit of times in and out (run, period, and the state of laws in which it is a time); parameters stay in SI
    #[arg(long, help_heading = "SI units", value_name = "UNIT", requires = "si", default_value = "s", value_parser = Names::of(TimeUnit::NAMES))]
    pub time_unit: String,
    /// With --si: G in Pa, for the damping G/(2 c_s)
    #[arg(long, help_heading = "SI units", value_name = "G", requires_all = ["si", "shear_wave_speed"], value_parser = number, allow_negative_numbers = true)]
    pub shear_modulus: Option<f64>,
    /// With --si: c_s in m/s, for the damping G/(2 c_s)
    #[arg(long, help_heading = "SI units", value_name = "c_s", requires_all = ["si", "shear_modulus"], value_parser = number, allow_negative_numbers = true)]
    pub shear_wave_speed: Option<f64>,
}

/// How accurately and by which method.
#[derive(Debug, Clone, PartialEq, clap::Args)]
#[command(next_help_heading = "Numerics")]
pub struct NumericsOptions {
    /// Integrator.
    #[arg(long, value_name = "NAME", help = format!("Integrator: {}", listed(&Choice::names())), default_value = "auto", value_parser = Names::of(Choice::names()), hide_possible_values = true)]
    pub method: String,
    /// Relative local error tolerance
    #[arg(long, value_name = "X", default_value = "1e-8", value_parser = number, allow_negative_numbers = true)]
    pub rtol: f64,
    /// Absolute local error tolerance of tau and ln psi [default: as --rtol]
    #[arg(long, value_name = "X", value_parser = number, allow_negative_numbers = true)]
    pub atol: Option<f64>,
    /// Largest time step, for features shorter than a step: no method sees a pulse that begins and ends within one step
    #[arg(long, value_name = "H", value_parser = number, allow_negative_numbers = true)]
    pub max_step: Option<f64>,
    /// Stop after this many steps
    #[arg(long, value_name = "N", value_parser = count, default_value_t = twinslip::integrate::MAX_STEPS)]
    pub max_steps: usize,
}

/// Where results go and how.
#[derive(Debug, Clone, PartialEq, clap::Args)]
#[command(next_help_heading = "Output")]
pub struct OutputOptions {
    /// table, csv or json [default: by the extension of FILE; else table on a terminal, csv into a file or pipe]
    #[arg(long, value_name = "FORMAT", value_parser = Names::of(["table", "csv", "json"]), hide_possible_values = true)]
    pub format: Option<String>,
    /// Write data to FILE; - is standard output
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Replace FILE even if it holds an unfinished run or was not written by this program
    #[arg(long)]
    pub force: bool,
    /// No messages, progress or summary; errors are still shown
    #[arg(short, long)]
    pub quiet: bool,
    /// Before computing, print the plan on standard error: what is computed, how and why
    #[arg(long)]
    pub explain: bool,
}

/// `law`: the steady-state friction law of one interface.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct LawOptions {
    /// The law; with --driving also where N interfaces slide together, and with --stiffness what they slide on.
    #[command(flatten)]
    pub model: ModelOptions,
    /// The uncertainty of a fit.
    #[command(flatten)]
    pub ensemble: EnsembleOptions,
    /// Lowest slip rate [default: 1e-3 V*]
    #[arg(long, value_name = "V", value_parser = number, allow_negative_numbers = true, help_heading = "Grid")]
    pub from: Option<f64>,
    /// Highest slip rate [default: 1e6 V*]
    #[arg(long, value_name = "V", value_parser = number, allow_negative_numbers = true, help_heading = "Grid")]
    pub to: Option<f64>,
    /// Number of slip rates, equally spaced in ln V
    #[arg(long, value_name = "N", value_parser = count, default_value_t = 200, help_heading = "Grid")]
    pub points: usize,
    /// Measured friction to compare the law with: a table with columns of slip rate and friction coefficient and, if known, its uncertainty
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub data: Option<PathBuf>,
    /// Draw tau_ss, with the measured friction, and k_c against V as FILE.svg or FILE.png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub plot: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub output: OutputOptions,
}

/// `integrate`: a run in time.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct IntegrateOptions {
    /// What slides.
    #[command(flatten)]
    pub model: ModelOptions,
    /// How the run starts.
    #[arg(
        long,
        value_name = "START",
        allow_hyphen_values = true,
        help_heading = "Run",
        help = START_HELP
    )]
    pub start: Option<String>,
    /// Changes of V_H, which begins at --driving: "T:V,T:V,..." for steps to V at T, where V = 0 is a hold, and "T1-T2:V" for a ramp; or
    /// FILE.csv with the columns time, driving and, for ramps, until. Rows then have a column driving and stand on both sides of a change
    #[arg(
        long,
        value_name = "PROGRAM",
        allow_hyphen_values = true,
        help_heading = "Run"
    )]
    pub program: Option<String>,
    /// End time of the run, which begins at 0
    #[arg(long, value_name = "T", value_parser = number, allow_negative_numbers = true, help_heading = "Run")]
    pub until: Option<f64>,
    /// N rows equally spaced in time, both ends included, instead of one per step
    #[arg(long, value_name = "N", value_parser = count, conflicts_with_all = ["every", "final_only"], help_heading = "Run")]
    pub points: Option<usize>,
    /// A row at every multiple of DT
    #[arg(long, value_name = "DT", value_parser = number, allow_negative_numbers = true, conflicts_with = "final_only", help_heading = "Run")]
    pub every: Option<f64>,
    /// Only the last row: nothing else is stored, and without slip columns nothing but the steps is computed
    #[arg(long, conflicts_with = "plot", help_heading = "Run")]
    pub final_only: bool,
    /// Only these columns, comma-separated; columns left out are not computed
    #[arg(long, value_name = "NAMES", help_heading = "Run")]
    pub columns: Option<String>,
    /// Find stick-slip events. With one or two interfaces: from a maximum of stress to the next minimum, while the interfaces together slip
    /// faster than V_H. With three or more: while at least one slips faster than a threshold. In JSON they are result.events; a table on
    /// standard output is followed by a table of events; in CSV they go to FILE, or beside -o RUN.csv to RUN.events.csv
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "", value_parser = path, help_heading = "Run")]
    pub events: Option<PathBuf>,
    /// Count events whose total slip rate exceeds X times V_H [default: 2]; with --program, X times the current V_H, so that a hold (V_H =
    /// 0), in which all slip is faster, counts as one event. With three or more interfaces, an interface slips while it is faster than X
    /// times V_H/N [default: 10]
    #[arg(long, value_name = "X", requires = "events", value_parser = number, allow_negative_numbers = true, help_heading = "Run")]
    pub event_threshold: Option<f64>,
    /// Draw stress, states and slip rates against time, and the phase plane, as FILE.svg or FILE.png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub plot: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub output: OutputOptions,
    /// By which method.
    #[command(flatten)]
    pub numerics: NumericsOptions,
    /// Estimate the error of the last row by a second run with tolerances 10,000 times tighter, or by --reference below --rtol 1e-12
    #[arg(long, help_heading = "Numerics")]
    pub estimate_error: bool,
    /// With --estimate-error: make the second run in double-double arithmetic (31 digits), some hundred times slower than taylor
    #[arg(long, requires = "estimate_error", help_heading = "Numerics")]
    pub reference: bool,
    /// Constants that are drawn.
    #[command(flatten)]
    pub draws: DrawOptions,
    /// With --events of three or more interfaces: for each interface the number of events in which it slips, its slip, and its drawn
    /// constants. In JSON these are result.participation; else they go to FILE, or beside -o RUN.csv to RUN.participation.csv
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "", value_parser = path, requires = "events", help_heading = "Many interfaces")]
    pub participation: Option<PathBuf>,
    /// With --events of three or more interfaces: draw the number of events of each size, and the number of interfaces that slip in each,
    /// as FILE.svg or FILE.png
    #[arg(
        long,
        value_name = "FILE",
        requires = "events",
        help_heading = "Many interfaces"
    )]
    pub plot_events: Option<PathBuf>,
    /// For many interfaces with rows in a CSV file: save the run in FILE at intervals. The same command resumes a killed run from FILE and
    /// gives the same bytes; FILE is removed when the run is complete
    #[arg(long, value_name = "FILE", value_parser = path, help_heading = "Many interfaces")]
    pub checkpoint: Option<PathBuf>,
    /// Steps between two checkpoints
    #[arg(long, value_name = "N", value_parser = count, default_value_t = 1000, requires = "checkpoint", help_heading = "Many interfaces")]
    pub checkpoint_steps: usize,
}

/// `section`: the return map of a run.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct SectionOptions {
    /// What slides.
    #[command(flatten)]
    pub model: ModelOptions,
    /// How the run starts.
    #[arg(
        long,
        value_name = "START",
        allow_hyphen_values = true,
        help_heading = "Run",
        help = START_HELP
    )]
    pub start: Option<String>,
    /// Section of the return map, STATE=VALUE; of interfaces stress=VALUE or log_state_1=VALUE, or stress=auto for the steady stress at the mean
    /// slip rate, tau_ss(V_H/2) of two interfaces [default: stress=auto; required with --system]
    #[arg(long, value_name = "SURFACE", help_heading = "Run")]
    pub surface: Option<String>,
    /// Count returns where the state, by default the stress, rises through the section; by default where it falls
    #[arg(long, help_heading = "Run")]
    pub upwards: bool,
    /// Number of returns to record
    #[arg(long, value_name = "N", value_parser = count, default_value_t = 1000, help_heading = "Run")]
    pub returns: usize,
    /// Number of returns to skip first, as a transient
    #[arg(long, value_name = "M", value_parser = count, default_value_t = 1000, help_heading = "Run")]
    pub skip: usize,
    /// Longest time to wait for a return [default: 1e4 L/V* + 1000/(K V_H); 1e4 with --system]
    #[arg(long, value_name = "T", value_parser = number, allow_negative_numbers = true, help_heading = "Run")]
    pub patience: Option<f64>,
    /// Compute Lyapunov exponents: of a periodic orbit from its multipliers, else along a further run of as many returns; without them
    /// chaos is not recognised
    #[arg(long, help_heading = "Run")]
    pub lyapunov: bool,
    /// Draw v_1 + v_2 at each return against the one before, and the states at the returns, as FILE.svg or FILE.png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub plot: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub output: OutputOptions,
    /// By which method.
    #[command(flatten)]
    pub numerics: NumericsOptions,
}

/// Constants of many interfaces that are drawn at random.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct DrawOptions {
    /// Draw a constant of each of many interfaces at random between A and B, NAME=A:B, or log-uniformly, NAME=A:Blog; repeatable. NAME is
    /// healing_time, residual_strength, direct_effect, evolution_effect, reference_friction, slip_length or normal_stress
    #[arg(
        long,
        value_name = "NAME=A:B",
        value_delimiter = ',',
        allow_hyphen_values = true,
        help_heading = "Many interfaces"
    )]
    pub draw: Vec<String>,
    /// With --draw: the random seed
    #[arg(
        long,
        value_name = "SEED",
        default_value_t = 1,
        requires = "draw",
        help_heading = "Many interfaces"
    )]
    pub seed: u64,
}

/// `equilibria`: all steady states at a driving velocity.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct EquilibriaOptions {
    /// What slides; without --stiffness there are no eigenvalues and no verdict.
    #[command(flatten)]
    pub model: ModelOptions,
    /// The uncertainty of a fit.
    #[command(flatten)]
    pub ensemble: EnsembleOptions,
    /// With --system or a --law from a file: all steady states in a box, a range for every state: x=-10:10,y=0:5 [default for a law: its
    /// steady states at rates from V_H/1e6 to V_H]
    #[arg(
        id = "box",
        long = "box",
        value_name = "RANGES",
        allow_hyphen_values = true,
        help_heading = "Model"
    )]
    pub within: Option<String>,
    /// With --system: search near this point, the values of all states in order [default: its table start]. With a --law from a file
    /// TAU,PSI1,PSI2 or near-symmetric:EPS. With --draw as in integrate [default: near-symmetric:0]: Newton's method finds the one state near it
    #[arg(
        long,
        value_name = "START",
        conflicts_with = "box",
        allow_hyphen_values = true,
        help_heading = "Model"
    )]
    pub start: Option<String>,
    /// Draw the states against the stress, filled where stable, and the eigenvalues, with --draw what each interface does against its
    /// constants, as FILE.svg or FILE.png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub plot: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub output: OutputOptions,
    /// kinsol or newton; both give the same digits [default: kinsol; newton in a build without SUNDIALS]
    #[arg(long, value_name = "NAME", conflicts_with = "system", value_parser = Names::of(["kinsol", "newton"]), hide_possible_values = true, help_heading = "Numerics")]
    pub solver: Option<String>,
    /// Constants that are drawn.
    #[command(flatten)]
    pub draws: DrawOptions,
}

/// `orbit`: a periodic orbit.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct OrbitOptions {
    /// What slides.
    #[command(flatten)]
    pub model: ModelOptions,
    /// symmetric (both interfaces in phase) or asymmetric; not used for unequal interfaces [default: symmetric; without --start, where that
    /// orbit is unstable, the orbit on which runs settle]
    #[arg(
        long,
        value_name = "NAME",
        conflicts_with = "system",
        value_parser = Names::of(["symmetric", "asymmetric"]),
        hide_possible_values = true,
        help_heading = "Orbit"
    )]
    pub symmetry: Option<String>,
    /// At or near the orbit, or at a Hopf point; without it the orbit is looked for.
    #[arg(
        long,
        value_name = "START",
        allow_hyphen_values = true,
        help_heading = "Orbit",
        help = ORBIT_START_HELP
    )]
    pub start: Option<String>,
    /// Approximate period; shorter cycles are then not accepted
    #[arg(long, value_name = "T", value_parser = number, allow_negative_numbers = true, help_heading = "Orbit")]
    pub period_guess: Option<f64>,
    /// With a periodic forcing (the key period of a file, or --modulate): the orbit lasts Q of its periods [default: 1]
    #[arg(long, value_name = "Q", value_parser = count, help_heading = "Orbit")]
    pub turns: Option<usize>,
    /// Rows over one period, as in integrate: N equally spaced in time, from result.orbit.point back to it. A table or CSV then holds these
    /// rows, and JSON has them as result.rows
    #[arg(long, value_name = "N", value_parser = count, help_heading = "Orbit")]
    pub points: Option<usize>,
    /// Derivatives of the period, of the least and largest value of each state and of ln |mu| of each multiplier in these parameters,
    /// comma-separated, as result.orbit.derivatives
    #[arg(long, value_name = "NAME,...", help_heading = "Orbit")]
    pub derivatives: Option<String>,
    /// Rows of the infinitesimal phase response over one period: the time by which a small kick in each state advances the orbit, over the
    /// kick, at the --points [default: 101]
    #[arg(long, help_heading = "Orbit")]
    pub phase_response: bool,
    /// Draw stress, states and slip rates (for a user-defined system all states) over one period, and the phase plane, or with
    /// --phase-response states and responses against the phase, as FILE.svg or FILE.png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub plot: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub output: OutputOptions,
    /// Second method that computes the orbit again as a cross-check, or none [default: cvode-adams; rodas5p in a build without SUNDIALS]
    #[arg(long, value_name = "METHOD", help_heading = "Numerics")]
    pub crosscheck: Option<String>,
    /// Method for the flow and its derivatives: auto (taylor), taylor, cvode-bdf, cvode-adams, rodas5p, rodas4, rosenbrock23 or radau
    #[arg(
        long,
        value_name = "NAME",
        default_value = "auto",
        value_parser = Names::of(Choice::names()),
        hide_possible_values = true,
        help_heading = "Numerics"
    )]
    pub method: String,
    /// Relative local error tolerance [default: 1e-15 for taylor, 1e-13 for radau, 1e-11 for the others]
    #[arg(long, value_name = "X", value_parser = number, allow_negative_numbers = true, help_heading = "Numerics")]
    pub rtol: Option<f64>,
    /// Absolute local error tolerance of tau and ln psi [default: as --rtol]
    #[arg(long, value_name = "X", value_parser = number, allow_negative_numbers = true, help_heading = "Numerics")]
    pub atol: Option<f64>,
    /// Largest time step, for features shorter than a step: no method sees a pulse that begins and ends within one step
    #[arg(long, value_name = "H", value_parser = number, allow_negative_numbers = true, help_heading = "Numerics")]
    pub max_step: Option<f64>,
    /// Stop an arc after this many steps
    #[arg(long, value_name = "N", value_parser = count, default_value_t = twinslip::integrate::MAX_STEPS, help_heading = "Numerics")]
    pub max_steps: usize,
}

/// Takes any text, and tells the shell which names there are: whether a name is one is checked where it has its meaning, by the
/// same words for flags and scenes.
#[derive(Debug, Clone)]
pub(super) struct Names(Vec<&'static str>);

impl Names {
    pub fn of(names: impl Into<Vec<&'static str>>) -> Self {
        Names(names.into())
    }
}

impl TypedValueParser for Names {
    type Value = String;

    fn parse_ref(
        &self,
        _: &clap::Command,
        _: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<String, clap::Error> {
        let text = value.to_str().map(str::to_owned);
        text.ok_or_else(|| clap::Error::new(clap::error::ErrorKind::InvalidUtf8))
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.0.iter().map(PossibleValue::new)))
    }
}

/// A whole number, which may be written as 1e6; the domain of each is checked where it has its meaning.
pub(super) fn count(text: &str) -> Result<usize, String> {
    /// Doubles count to here without gaps.
    const MOST: f64 = 9e15;
    let text = text.trim();
    let plain = text.parse::<usize>().ok();
    let short = || {
        let x = text.parse::<f64>().ok()?;
        (x.fract() == 0.0 && (0.0..=MOST).contains(&x)).then_some(x as usize)
    };
    plain
        .or_else(short)
        .ok_or_else(|| "must be a whole number, not negative".into())
}

/// A path, which is empty where an option that may have one is given without.
fn path(text: &str) -> Result<PathBuf, String> {
    Ok(PathBuf::from(text))
}

/// A finite number; the domain of each parameter is checked where it has its meaning.
pub(super) fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        Ok(_) => Err("must be a finite number".into()),
        Err(_) if text.trim().is_empty() => Err("is empty, must be a number".into()),
        Err(_) => Err("is not a number".into()),
    }
}
