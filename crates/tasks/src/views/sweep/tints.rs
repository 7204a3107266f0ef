//! The colours of regimes. Steps of lightness tell them apart in grey and for the colour-blind, hues for all others: in CIE
//! L*a*b* no two are nearer in L* than 5, from the pale green of the symmetric steady state to the dark red of chaos, nor nearer to one
//! another than 16, whether all cones see them or one kind is missing.

use super::PointOutcome;
use twinslip::equilibrium::Symmetry;
use twinslip::section::Regime;
use twinslip_output::plot::Shade;

/// A regime as the picture tells them apart, in the order of the legend.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum RegimeKind {
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

impl RegimeKind {
    /// Of what a run settled on.
    pub fn of(outcome: &PointOutcome) -> Self {
        let asymmetric = outcome.symmetry == Some(Symmetry::Asymmetric);
        match (outcome.regime, outcome.returns_per_period.unwrap_or(1)) {
            (Regime::Steady, _) if asymmetric => RegimeKind::SteadyAsymmetric,
            (Regime::Steady, _) => RegimeKind::SteadySymmetric,
            (Regime::Periodic, 2) => RegimeKind::Period2,
            (Regime::Periodic, 3) => RegimeKind::Period3,
            (Regime::Periodic, 4) => RegimeKind::Period4,
            (Regime::Periodic, 5..) => RegimeKind::PeriodHigher,
            (Regime::Periodic, _) if asymmetric => RegimeKind::PeriodicAsymmetric,
            (Regime::Periodic, _) => RegimeKind::PeriodicSymmetric,
            (Regime::Torus, _) => RegimeKind::Torus,
            (Regime::Chaotic, _) => RegimeKind::Chaotic,
            (Regime::Undecided, _) => RegimeKind::Undecided,
        }
    }

    /// Of a regime alone.
    pub const fn of_regime(regime: Regime) -> Self {
        match regime {
            Regime::Steady => RegimeKind::SteadySymmetric,
            Regime::Periodic => RegimeKind::PeriodicSymmetric,
            Regime::Torus => RegimeKind::Torus,
            Regime::Chaotic => RegimeKind::Chaotic,
            Regime::Undecided => RegimeKind::Undecided,
        }
    }

    /// In words; of the symmetry only where outcomes have one.
    pub fn words(self, symmetries: bool) -> &'static str {
        match self {
            RegimeKind::SteadySymmetric if symmetries => "steady, symmetric",
            RegimeKind::SteadySymmetric => "steady",
            RegimeKind::SteadyAsymmetric => "steady, asymmetric",
            RegimeKind::PeriodicSymmetric if symmetries => "periodic, symmetric",
            RegimeKind::PeriodicSymmetric => "periodic",
            RegimeKind::PeriodicAsymmetric => "periodic, asymmetric",
            RegimeKind::Period2 => "period 2",
            RegimeKind::Period3 => "period 3",
            RegimeKind::Period4 => "period 4",
            RegimeKind::PeriodHigher => "period 5 or more",
            RegimeKind::Torus => "torus",
            RegimeKind::Chaotic => "chaotic",
            RegimeKind::Undecided => "undecided",
        }
    }

    /// Its colour.
    pub const fn shade(self) -> Shade {
        Shade::new(match self {
            RegimeKind::SteadySymmetric => [211, 255, 208],
            RegimeKind::Undecided => [226, 226, 226],
            RegimeKind::SteadyAsymmetric => [234, 206, 122],
            RegimeKind::PeriodicSymmetric => [93, 204, 221],
            RegimeKind::PeriodicAsymmetric => [236, 123, 64],
            RegimeKind::Period2 => [95, 135, 104],
            RegimeKind::Period3 => [182, 71, 132],
            RegimeKind::Period4 => [61, 144, 215],
            RegimeKind::PeriodHigher => [0, 110, 52],
            RegimeKind::Torus => [182, 168, 113],
            RegimeKind::Chaotic => [69, 8, 32],
        })
    }
}
