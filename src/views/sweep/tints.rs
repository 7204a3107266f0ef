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

#[cfg(test)]
mod test {
    use super::*;

    const ALL: [Kind; 11] = [
        Kind::SteadySymmetric,
        Kind::SteadyAsymmetric,
        Kind::PeriodicSymmetric,
        Kind::PeriodicAsymmetric,
        Kind::Period2,
        Kind::Period3,
        Kind::Period4,
        Kind::PeriodHigher,
        Kind::Torus,
        Kind::Chaotic,
        Kind::Undecided,
    ];

    /// Linear light of the parts of a colour (IEC 61966-2-1).
    fn light(shade: Shade) -> [f64; 3] {
        shade.colour.map(|part| {
            let part = f64::from(part);
            let part = (part + shade.lightness * (255.0 - part)) / 255.0;
            if part <= 0.04045 {
                part / 12.92
            } else {
                ((part + 0.055) / 1.055).powf(2.4)
            }
        })
    }

    /// L* of CIE 1976.
    fn lightness([r, g, b]: [f64; 3]) -> f64 {
        let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        if y > 0.008856 {
            116.0 * y.cbrt() - 16.0
        } else {
            903.3 * y
        }
    }

    /// What eyes without one kind of cones see (Machado, Oliveira and Fernandes 2009, severity 1).
    const SEEN: [[[f64; 3]; 3]; 3] = [
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ],
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ],
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ],
    ];

    #[test]
    fn regimes_are_told_apart_in_grey() {
        let mut shades = ALL.map(Kind::shade).to_vec();
        let palest = Kind::Chaotic.shade().lighter(LIGHTEST);
        shades.push(palest);
        for (i, &a) in shades.iter().enumerate() {
            for &b in &shades[..i] {
                let apart = (lightness(light(a)) - lightness(light(b))).abs();
                assert!(apart > 5.0, "{a:?} and {b:?}: {apart}");
            }
        }
    }

    /// Euclidean distance in L*a*b*, where 2.3 can just be seen.
    #[test]
    fn the_colour_blind_tell_them_apart() {
        let lab = |[r, g, b]: [f64; 3]| {
            let f = |t: f64| {
                if t > 0.008856 {
                    t.cbrt()
                } else {
                    7.787 * t + 16.0 / 116.0
                }
            };
            let x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.95047);
            let y = f(0.2126 * r + 0.7152 * g + 0.0722 * b);
            let z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.08883);
            [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
        };
        const ALL_CONES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for seen in SEEN.into_iter().chain([ALL_CONES]) {
            let all = ALL.map(|kind| {
                let rgb = light(kind.shade());
                lab(seen.map(|row| {
                    (row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]).clamp(0.0, 1.0)
                }))
            });
            for (i, a) in all.iter().enumerate() {
                for (j, b) in all[..i].iter().enumerate() {
                    let apart = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
                    assert!(apart > 16.0, "{:?} and {:?}: {apart}", ALL[i], ALL[j]);
                }
            }
        }
    }
}
