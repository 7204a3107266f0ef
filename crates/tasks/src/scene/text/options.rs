//! What a user can set about a system of their own.

use std::path::PathBuf;

/// A system from a file, in place of interfaces.
#[derive(Debug, Clone, Default, PartialEq, clap::Args)]
#[command(next_help_heading = "Model")]
pub struct TextOptions {
    /// A system of one's own in place of interfaces: a TOML file with its states, parameters and rates, or one that is built in,
    /// such as lorenz
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = [
            "law", "interfaces", "clusters", "healing_time", "residual_strength", "direct_effect", "evolution_effect", "reference_friction",
            "si", "slip_length", "reference_rate", "time_unit", "normal_stress", "damping", "shear_modulus", "shear_wave_speed",
        ]
    )]
    pub system: Option<PathBuf>,
    /// Another value of any parameter, NAME=VALUE, by the names that JSON has; may be given again. With _1 or _2 after the name it is
    /// that of one interface: residual_strength_2=0.002
    #[arg(
        long,
        value_name = "NAME=VALUE",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub set: Vec<String>,
}
