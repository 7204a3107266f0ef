//! The colours of regimes. Steps of lightness tell them apart in grey and for the colour-blind, hues for all others: in CIE
//! L*a*b* no two are nearer in L* than 5, from the pale green of the symmetric steady state to the dark red of chaos, nor nearer to one
//! another than 16, whether all cones see them or one kind is missing.

use super::Outcome;
use crate::equilibrium::Symmetry;
use crate::output::plot::Shade;
use crate::section::Regime;

/// A regime as the picture tells them apart, in the order of the legend.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Both interfaces slide alike and steadily, or there is one.
    SteadySymmetric,
    /// They slide steadily at different rates.
    SteadyAsymmetric,
    /// An orbit on which they slide alike, or of one interface.
    PeriodicSymmetric,
    /// An orbit on which they don't.
    PeriodicAsymmetric,
    /// One that closes after two returns.
    Period2,
    /// After three.
    Period3,
    /// After four.
    Period4,
    /// After more.
    PeriodHigher,
    /// A torus.
    Torus,
    /// Chaos.
    Chaotic,
    /// Not told.
    Undecided,
}

/// The colour of chaos at its largest exponent; at smaller ones it is lighter, up to this.
pub const LIGHTEST: f64 = 0.13;

impl Kind {
    /// Of what a run settled on.
    pub fn of(outcome: &Outcome) -> Self {
        let asymmetric = outcome.symmetry == Some(Symmetry::Asymmetric);
        match (outcome.regime, outcome.returns_per_period.unwrap_or(1)) {
            (Regime::Steady, _) if asymmetric => Kind::SteadyAsymmetric,
            (Regime::Steady, _) => Kind::SteadySymmetric,
            (Regime::Periodic, 2) => Kind::Period2,
            (Regime::Periodic, 3) => Kind::Period3,
            (Regime::Periodic, 4) => Kind::Period4,
            (Regime::Periodic, 5..) => Kind::PeriodHigher,
            (Regime::Periodic, _) if asymmetric => Kind::PeriodicAsymmetric,
            (Regime::Periodic, _) => Kind::PeriodicSymmetric,
            (Regime::Torus, _) => Kind::Torus,
            (Regime::Chaotic, _) => Kind::Chaotic,
            (Regime::Undecided, _) => Kind::Undecided,
        }
    }

    /// In words; of the symmetry only where outcomes have one.
    pub fn words(self, symmetries: bool) -> &'static str {
        match self {
            Kind::SteadySymmetric if symmetries => "steady, symmetric",
            Kind::SteadySymmetric => "steady",
            Kind::SteadyAsymmetric => "steady, asymmetric",
            Kind::PeriodicSymmetric if symmetries => "periodic, symmetric",
            Kind::PeriodicSymmetric => "periodic",
            Kind::PeriodicAsymmetric => "periodic, asymmetric",
            Kind::Period2 => "period 2",
            Kind::Period3 => "period 3",
            Kind::Period4 => "period 4",
            Kind::PeriodHigher => "period 5 or more",
            Kind::Torus => "torus",
            Kind::Chaotic => "chaotic",
            Kind::Undecided => "undecided",
        }
    }

    /// Its colour.
    pub const fn shade(self) -> Shade {
        Shade::new(match self {
            Kind::SteadySymmetric => [211, 255, 208],
            Kind::Undecided => [226, 226, 226],
            Kind::SteadyAsymmetric => [234, 206, 122],
            Kind::PeriodicSymmetric => [93, 204, 221],
            Kind::PeriodicAsymmetric => [236, 123, 64],
            Kind::Period2 => [95, 135, 104],
            Kind::Period3 => [182, 71, 132],
            Kind::Period4 => [61, 144, 215],
            Kind::PeriodHigher => [0, 110, 52],
            Kind::Torus => [182, 168, 113],
            Kind::Chaotic => [69, 8, 32],
        })
    }
}
