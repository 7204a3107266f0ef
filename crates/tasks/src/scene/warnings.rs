//! Warnings on options that are valid and yet hardly meant.

use super::command::Command;
use super::options::SlabOptions;
use super::system::SLIP_LENGTH;
use twinslip::error::Result;
use twinslip::friction::AnyLaw;

/// Driving velocities of faults are below this, in m/s; those of the paper are not.
const PLATE_RATE: f64 = 1e-8;

impl Command {
    /// A sentence on constants of the law that are left at the paper's values, which are those of paper sliding on paper, where other
    /// numbers in SI are those of a fault. None of a command that is quiet.
    pub fn warning(&self) -> Option<String> {
        let slab = self.slab().filter(|_| !self.output().quiet)?;
        // Of options that make no system there is an error to come, and no warning.
        self.units()?;
        let driving = match self {
            Command::Law(options) => options.model.driving,
            Command::Integrate(options) => options.model.driving,
            Command::Equilibria(options) => options.model.driving,
            Command::Orbit(options) => options.model.driving,
            Command::Section(options) => options.model.driving,
            Command::Branch(options) => options.model.driving,
            _ => None,
        };
        // What is wrong with `set` is said where it is used.
        let free = match self {
            Command::Branch(options) => options.along.as_deref(),
            _ => None,
        };
        slab.of_a_fault(driving, free).ok().flatten()
    }
}

impl SlabOptions {
    /// Which constants of a built-in law are the paper's although other numbers are those of a fault.
    fn of_a_fault(&self, driving: Option<f64>, free: Option<&str>) -> Result<Option<String>> {
        let built_in = AnyLaw::NAMES.contains(&self.law.as_str());
        if !self.si || !built_in || self.text.system.is_some() {
            return Ok(None);
        }
        let given = |name: &str| -> Result<bool> {
            let indexed = format!("{name}_1");
            let varies = free.is_some_and(|free| [name, indexed.as_str()].contains(&free));
            Ok(varies || self.flag(name) || self.sets(name)? || self.sets(&indexed)?)
        };
        let mut faults = Vec::new();
        for name in ["slip_length", "normal_stress", "damping"] {
            let is_default = name == "slip_length" && self.slip_length == Some(SLIP_LENGTH);
            // The rock may stand for the damping.
            let name = match name {
                "damping" if self.shear_modulus.is_some() => "shear_modulus",
                name => name,
            };
            if (name == "shear_modulus" || given(name)?) && !is_default {
                faults.push(name);
            }
        }
        if driving.is_some_and(|driving| driving < PLATE_RATE) {
            faults.push("driving");
        }
        let mut constants = vec!["direct_effect", "evolution_effect", "reference_friction"];
        if self.law == "spinodal" {
            constants.push("residual_strength");
        }
        constants.push("slip_length");
        let mut missing = Vec::new();
        for name in constants {
            if !given(name)? {
                missing.push(name);
            }
        }
        if faults.is_empty() || missing.is_empty() {
            return Ok(None);
        }
        let flags = |names: &[&str]| {
            let flags: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
            match &flags[..] {
                [others @ .., last] if !others.is_empty() => {
                    format!("{} and {last}", others.join(", "))
                }
                _ => flags.concat(),
            }
        };
        Ok(Some(format!(
            "the defaults of the law are for paper on paper (Heslot et al., 1994), but {} {} another system: set {} too",
            flags(&faults),
            if faults.len() == 1 {
                "describes"
            } else {
                "describe"
            },
            flags(&missing)
        )))
    }
}
