//! What a user can set of fits.

use crate::scene::options::{Names, OutputOptions, count, number};
use std::path::PathBuf;
use twinslip::friction::AnyLaw;

/// What is fitted unless something else is asked for.
pub(super) const USUALLY_FREE: &str =
    "direct_effect,evolution_effect,slip_length,stiffness,reference_friction";

/// `fit`: friction parameters from a record of velocity steps. All in SI, whatever the units of the file are.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct FitOptions {
    /// The record: CSV, TSV or columns of text, with or without a header; units in its parentheses, such as Displ(um). Several records are
    /// fitted together
    #[arg(value_name = "DATA", id = "data")]
    pub data: Vec<PathBuf>,

    /// Laws to fit, comma-separated: spinodal, bounded, regularised-ageing, dieterich-ruina (or ageing), slip, or FILE.toml; several laws
    /// are each compared with the best
    #[arg(long, value_name = "NAME[,NAME...]", default_value = "dieterich-ruina", value_parser = Names::of(AnyLaw::NAMES), hide_possible_values = true, help_heading = "Model")]
    pub law: String,
    /// State variables: 1 or 2
    #[arg(long, value_name = "N", value_parser = count, default_value_t = 1, help_heading = "Model")]
    pub states: usize,
    /// Parameters to fit, comma-separated; also healing_time, residual_strength, evolution_effect_2, slip_length_2, drift (a straight line,
    /// friction per metre), and those of a law from a file. Parameters with neither a value nor a default are fitted too [default:
    /// direct_effect,evolution_effect,slip_length,stiffness,reference_friction, with --states 2 also evolution_effect_2,slip_length_2]
    #[arg(long, value_name = "NAMES", help_heading = "Model")]
    pub free: Option<String>,
    /// Of several records, parameters that each has its own of, comma-separated; the others are shared [default: those of
    /// stiffness,reference_friction,drift that are fitted]
    #[arg(long, value_name = "NAMES", help_heading = "Model")]
    pub each: Option<String>,
    /// Direct effect a: its value, or the start of the search
    #[arg(long, value_name = "a", value_parser = number, allow_negative_numbers = true, help_heading = "Model")]
    pub direct_effect: Option<f64>,
    /// Evolution effect b
    #[arg(long, value_name = "b", value_parser = number, allow_negative_numbers = true, help_heading = "Model")]
    pub evolution_effect: Option<f64>,
    /// L (D_c) in m
    #[arg(long, value_name = "L", value_parser = number, allow_negative_numbers = true, help_heading = "Model")]
    pub slip_length: Option<f64>,
    /// b of the second state variable
    #[arg(long, alias = "second-evolution-effect", value_name = "b_2", value_parser = number, allow_negative_numbers = true, help_heading = "Model")]
    pub evolution_effect_2: Option<f64>,
    /// L of the second state variable, in m
    #[arg(long, alias = "second-slip-length", value_name = "L_2", value_parser = number, allow_negative_numbers = true, help_heading = "Model")]
    pub slip_length_2: Option<f64>,
    /// Friction coefficient at V*
    #[arg(long, value_name = "a_v", value_parser = number, allow_negative_numbers = true, help_heading = "Model")]
    pub reference_friction: Option<f64>,
    /// Healing time t** in s, for laws that have one [default: 100 L/V*]
    #[arg(long, value_name = "R", value_parser = number, allow_negative_numbers = true, help_heading = "Model")]
    pub healing_time: Option<f64>,
    /// Residual strength c of the spinodal law [default: 1e-3]
    #[arg(long, value_name = "c", value_parser = number, allow_negative_numbers = true, help_heading = "Model")]
    pub residual_strength: Option<f64>,
    /// Stiffness of the apparatus, in Pa/m, or as friction per length: 0.003/um
    #[arg(long, value_name = "K", help_heading = "Model")]
    pub stiffness: Option<String>,
    /// Slope of an added straight line, friction per metre of load-point displacement [default: 0]
    #[arg(long, value_name = "SLOPE", value_parser = number, allow_negative_numbers = true, help_heading = "Model")]
    pub drift: Option<f64>,
    /// Set any parameter by name, such as one of a law from a file; repeatable
    #[arg(
        long,
        value_name = "NAME=VALUE",
        value_delimiter = ',',
        allow_hyphen_values = true,
        help_heading = "Model"
    )]
    pub set: Vec<String>,
    /// V* in m/s [default: the velocity before the first step]
    #[arg(long, value_name = "V*", value_parser = number, allow_negative_numbers = true, help_heading = "Model")]
    pub reference_rate: Option<f64>,
    /// Normal stress in Pa, by which shear stress and stiffness are divided [default: the mean of its column]
    #[arg(long, value_name = "sigma", value_parser = number, allow_negative_numbers = true, help_heading = "Model")]
    pub normal_stress: Option<f64>,

    /// Velocity of the load point: T:V,T:V,... in s and m/s, T1-T2:V for a ramp, or FILE.csv; times as in the record [default: steps
    /// detected from the displacement]
    #[arg(
        long,
        value_name = "PROGRAM",
        allow_hyphen_values = true,
        help_heading = "Loading"
    )]
    pub program: Option<String>,
    /// Velocity before the first change of the program, in m/s [default: from the displacement]
    #[arg(long, value_name = "V", value_parser = number, allow_negative_numbers = true, help_heading = "Loading")]
    pub driving: Option<f64>,
    /// Motion of the load point: the steps of its displacement, or recorded, the whole displacement, smoothed so that friction fits best
    #[arg(long, value_name = "steps|recorded", default_value = "steps", value_parser = Names::of(["steps", "recorded"]), hide_possible_values = true, help_heading = "Loading")]
    pub load_point: String,

    /// Column of the time, by name or number from 1; the same holds for the other columns
    #[arg(long, value_name = "COLUMN", help_heading = "Data")]
    pub time: Option<String>,
    /// Column of the displacement of the load point
    #[arg(long, value_name = "COLUMN", help_heading = "Data")]
    pub displacement: Option<String>,
    /// Column of the friction coefficient, or of the shear stress if its unit is one of stress
    #[arg(long, value_name = "COLUMN", help_heading = "Data")]
    pub friction: Option<String>,
    /// Column of the normal stress
    #[arg(long, value_name = "COLUMN", help_heading = "Data")]
    pub normal_stress_column: Option<String>,
    /// Column of weights of the squared residuals
    #[arg(long, value_name = "COLUMN", help_heading = "Data")]
    pub weights: Option<String>,
    /// First time of the window in s, as in the record
    #[arg(long, value_name = "T", value_parser = number, allow_negative_numbers = true, help_heading = "Data")]
    pub from: Option<f64>,
    /// Last time of the window in s
    #[arg(long, value_name = "T", value_parser = number, allow_negative_numbers = true, help_heading = "Data")]
    pub to: Option<f64>,
    /// Use every N-th sample
    #[arg(long, value_name = "N", value_parser = count, default_value_t = 1, help_heading = "Data")]
    pub decimate: usize,

    /// Range of a parameter, NAME=A:B; repeatable
    #[arg(
        long,
        value_name = "NAME=A:B",
        value_delimiter = ',',
        allow_hyphen_values = true,
        help_heading = "Fit"
    )]
    pub bounds: Vec<String>,
    /// Loss function of the residuals: linear (least squares), or soft-l1, huber or cauchy, which reduce the weight of outliers
    #[arg(long, value_name = "NAME", default_value = "linear", value_parser = Names::of(["linear", "soft-l1", "huber", "cauchy"]), hide_possible_values = true, help_heading = "Fit")]
    pub loss: String,
    /// Scale of a robust loss, in friction [default: 3 times the scatter from sample to sample]
    #[arg(long, value_name = "X", value_parser = number, allow_negative_numbers = true, help_heading = "Fit")]
    pub loss_scale: Option<f64>,
    /// 95 % intervals: by profile, or linear from the standard errors, which is faster
    #[arg(long, value_name = "profile|linear", default_value = "profile", value_parser = Names::of(["profile", "linear"]), hide_possible_values = true, help_heading = "Fit")]
    pub intervals: String,
    /// Also draw so many times from the posterior, by the No-U-Turn sampler in four chains
    #[arg(long, value_name = "N", value_parser = count, help_heading = "Posterior")]
    pub posterior: Option<usize>,
    /// Prior of a parameter, NAME=normal:MEAN:DEVIATION, uniform:A:B or log-uniform:A:B; repeatable [default: wide ones, as the result says]
    #[arg(
        long,
        value_name = "NAME=PRIOR",
        value_delimiter = ',',
        allow_hyphen_values = true,
        help_heading = "Posterior"
    )]
    pub prior: Vec<String>,
    /// Seed of the draws [default: 1]
    #[arg(long, value_name = "N", help_heading = "Posterior")]
    pub seed: Option<u64>,
    /// Recompute the derivatives at the minimum by sensitivities of CVODES, and report the largest difference
    #[arg(long, help_heading = "Fit")]
    pub crosscheck: bool,
    /// Also fit each velocity step separately
    #[arg(long, help_heading = "Fit")]
    pub each_step: bool,

    /// Look at the record without a fit: columns, sampling, gaps, steps of velocity and holds, friction and its noise
    #[arg(long, conflicts_with_all = ["law", "states", "free", "each", "direct_effect", "evolution_effect", "slip_length", "evolution_effect_2", "slip_length_2", "reference_friction", "healing_time", "residual_strength", "stiffness", "drift", "set", "reference_rate", "load_point", "weights", "bounds", "loss", "loss_scale", "intervals", "posterior", "prior", "seed", "crosscheck", "each_step", "plot_parameters", "plot_law", "plot_holds", "plot_records", "report"], help_heading = "Output")]
    pub look: bool,
    /// Draw data, fit and residuals, or with --look friction and displacement, as FILE.svg or FILE.png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub plot: Option<PathBuf>,
    /// Draw the confidence ellipses of all pairs of parameters and their profiles, with --posterior the draws
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub plot_parameters: Option<PathBuf>,
    /// Draw the resulting steady-state law with its 95 % band
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub plot_law: Option<PathBuf>,
    /// Draw healing and the friction at the end of holds against their duration
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub plot_holds: Option<PathBuf>,
    /// Draw what each of several records says of the parameters that they share
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub plot_records: Option<PathBuf>,
    /// Write a page with all results, FILE.html
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub report: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub output: OutputOptions,
}

#[cfg(test)]
mod test {
    use super::FitOptions;
    use clap::Args;

    /// A look uses what says how a record is read, and refuses all that is of fits.
    #[test]
    fn a_look_refuses_what_it_does_not_use() {
        let mut command = FitOptions::augment_args(clap::Command::new("fit"));
        command.build();
        let all: Vec<&clap::Arg> = command.get_arguments().collect();
        let look = all.iter().find(|arg| arg.get_id() == "look");
        let refused = command.get_arg_conflicts_with(look.expect("the option"));
        let used: Vec<&str> = all
            .iter()
            .filter(|arg| !refused.contains(arg))
            .map(|arg| arg.get_id().as_str())
            .filter(|id| {
                ![
                    "help", "look", "output", "format", "force", "quiet", "explain",
                ]
                .contains(id)
            })
            .collect();
        assert_eq!(
            used,
            [
                "data",
                "normal_stress",
                "program",
                "driving",
                "time",
                "displacement",
                "friction",
                "normal_stress_column",
                "from",
                "to",
                "decimate",
                "plot"
            ]
        );
    }
}
