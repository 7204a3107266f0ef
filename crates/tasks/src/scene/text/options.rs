//! What a user can set about a system of their own.

use std::path::PathBuf;

/// A system from a file, in place of interfaces.
#[derive(Debug, Clone, Default, PartialEq, clap::Args)]
#[command(next_help_heading = "Model")]
pub struct TextOptions {
    /// A user-defined system in place of interfaces: a TOML file with its states, parameters and rates, or a built-in one, such as lorenz
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = [
            "law", "interfaces", "clusters", "healing_time", "residual_strength", "direct_effect", "evolution_effect", "reference_friction",
            "si", "slip_length", "reference_rate", "time_unit", "normal_stress", "damping", "shear_modulus", "shear_wave_speed",
            "second_evolution_effect", "second_slip_length", "mass", "modulate", "normal_stress_coupling",
        ]
    )]
    pub system: Option<PathBuf>,
    /// Set any parameter, NAME=VALUE; repeatable. NAME is as in the JSON output, or a symbol: a, b, c, Dc, mu0, V0, sigma, K. A suffix _1
    /// or _2 sets it for one interface: residual_strength_2=0.002
    #[arg(
        long,
        value_name = "NAME=VALUE",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub set: Vec<String>,
}
