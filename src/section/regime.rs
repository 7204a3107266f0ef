//! What a run has settled on: an equilibrium, a periodic orbit, a torus, chaos; or that it cannot be told.

use super::curve::{InvariantCurve, invariant_curve, regularity};
use super::lyapunov::Exponents;
use super::periodicity::{Closing, Periodic, closing_in};
use super::returns::{Ended, Return, ReturnRecord};
use super::surface::Surface;
use crate::error::Result;
use crate::field::{Matrix, Vector};
use crate::integrate::AnyField;
use crate::number::{Uncertain, symmetric_eigenvalues};

/// Returns without which neither torus nor chaos is told.
pub const FEWEST_RETURNS: usize = 200;
/// Averages over halves that agree to this, relative to their spread, are those of a quasi-periodic run.
pub(crate) const REGULAR: f64 = 1e-5;
/// Averages that differ by more than this are not.
pub(crate) const IRREGULAR: f64 = 1e-3;
/// The error of the run moves a rotation number by so many tolerances.
const PER_ACCURACY: f64 = 100.0;
/// Points that repeat to this part of their spread, or to so many tolerances, are those of an orbit that closes, or that would but
/// for the error of the run; where that grows along the orbit, part of the points shows it.
const REPEATED: f64 = 1e-7;
const REPEATED_PER_ACCURACY: f64 = 1e3;
const PART_THAT_REPEATS: f64 = 0.25;

/// Chaos is told where disturbances have had time to grow by the exponential of this: what grew by less may be a passage from
/// one regular motion to another.
const GROWN: f64 = 10.0;

/// A torus that is seen by its exponents alone has disturbances that grow or shrink by less, in the logarithm, over the record.
const STAYED: f64 = 0.1;

/// What a flow does in the end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regime {
    /// It rests.
    Steady,
    /// It repeats itself.
    Periodic,
    /// It winds around a torus and never repeats itself.
    Torus,
    /// It forgets where it came from.
    Chaotic,
    /// The returns do not tell.
    Undecided,
}

impl Regime {
    /// The name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Regime::Steady => "steady",
            Regime::Periodic => "periodic",
            Regime::Torus => "torus",
            Regime::Chaotic => "chaotic",
            Regime::Undecided => "undecided",
        }
    }
}

/// A regime, with what it rests on.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RegimeVerdict {
    /// The regime.
    pub regime: Regime,
    /// The periodic point that the returns close in on.
    pub periodic: Option<Periodic>,
    /// The closed curves on which the returns of a torus lie, where they bend little enough to be seen.
    pub curve: Option<InvariantCurve>,
    /// Why nothing can be said, and what to try.
    pub why: Option<&'static str>,
}

/// Why a run that stays on an unstable orbit has no regime.
pub const ON_SADDLE: &str = "the returns close in on an unstable orbit, which the run has not left, as none leaves that begins where interfaces are alike; give another `start`";

impl RegimeVerdict {
    fn of(regime: Regime) -> Self {
        RegimeVerdict {
            regime,
            periodic: None,
            curve: None,
            why: None,
        }
    }

    /// Whether the run has stayed on an unstable orbit: its exponents say nothing of its regime then.
    pub fn is_on_saddle(&self) -> bool {
        self.why == Some(ON_SADDLE)
    }

    fn undecided(why: &'static str) -> Self {
        RegimeVerdict {
            why: Some(why),
            ..Self::of(Regime::Undecided)
        }
    }
}

/// The regime of a recorded run. Periodic is one whose returns close in on an attracting periodic point; a torus has
/// quasi-periodic returns and, where the exponents are given, two that vanish within their intervals; chaos has a largest
/// exponent that is positive beyond its interval, for long enough to make much of a disturbance. Without exponents chaos is not
/// told.
///
/// # Errors
/// Those of [`periodicity`](super::periodicity()).
pub fn verdict(
    field: &AnyField<'_>,
    surface: &Surface,
    record: &ReturnRecord,
    exponents: Option<Exponents<'_>>,
) -> Result<RegimeVerdict> {
    if let Ended::Steady { .. } = record.ended {
        return Ok(RegimeVerdict::of(Regime::Steady));
    }
    let returns = &record.returns;
    match closing_in(field, surface, record)? {
        Closing::Attracted(periodic) => {
            return Ok(RegimeVerdict {
                periodic: Some(periodic),
                ..RegimeVerdict::of(Regime::Periodic)
            });
        }
        Closing::OnSaddle => return Ok(RegimeVerdict::undecided(ON_SADDLE)),
        Closing::Nowhere => {}
    }
    if field.dimension() < 3 {
        return Ok(RegimeVerdict::undecided(
            "the returns have not converged to a periodic point, the only attractor of a plane system with returns; skip more, or lower `rtol` and `atol`",
        ));
    }
    if returns.len() < FEWEST_RETURNS {
        return Ok(RegimeVerdict::undecided(
            "fewer than 200 returns, which have not converged to a periodic point; record more, or skip more",
        ));
    }
    Ok(aperiodic(surface, returns, record.accuracy, exponents))
}

/// The regime of returns, 200 or more, that close in on no periodic point.
pub fn aperiodic(
    surface: &Surface,
    returns: &[Return],
    accuracy: f64,
    exponents: Option<Exponents<'_>>,
) -> RegimeVerdict {
    let duration = returns[returns.len() - 1].time - returns[0].time;
    let points = points(surface, returns);
    let mut verdict = wandering(&points, (duration, accuracy), exponents);
    if let Some(curve) = &mut verdict.curve {
        curve.rotation.uncertainty += PER_ACCURACY * accuracy;
    }
    verdict
}

/// The regime of returns that are not periodic, recorded for so long and so accurately.
fn wandering(
    points: &[[f64; 2]],
    (duration, accuracy): (f64, f64),
    exponents: Option<Exponents<'_>>,
) -> RegimeVerdict {
    let disorder = regularity(points);
    let holds_zero = |x: &Uncertain| x.value.abs() <= x.uncertainty;
    // A run that slowly leaves an equilibrium or an orbit has a positive exponent too, but little comes of it.
    let positive = |x: &Uncertain| (x.value - x.uncertainty) * duration > GROWN;
    if disorder < REGULAR {
        if repeats(points, accuracy) {
            return RegimeVerdict::undecided(
                "the returns repeat, but a long period, or one hidden by the error of the run, cannot be distinguished from a torus: lower `rtol`",
            );
        }
        let curve = invariant_curve(points);
        let two_vanish =
            exponents.map(|x| x.values.len() > 1 && x.values[..2].iter().all(holds_zero));
        // Without a curve to be seen an exponent that may vanish is not enough: it must be known to.
        let known = |x: &Uncertain| (x.value.abs() + x.uncertainty) * duration < STAYED;
        let surely = exponents.map(|x| x.values.len() > 1 && x.values[..2].iter().all(known));
        return match (two_vanish, curve) {
            (Some(true), None) if surely == Some(false) => RegimeVerdict::undecided(
                "the returns look quasi-periodic but lie on no simple curve, and the exponents that may vanish are not accurate enough; record more",
            ),
            (Some(false), _) => RegimeVerdict::undecided(
                "the returns look quasi-periodic but no second exponent vanishes; record more",
            ),
            (None, None) => RegimeVerdict::undecided(
                "the returns look quasi-periodic but lie on no simple curve; the exponents (`lyapunov`) may decide",
            ),
            (Some(true), _) | (None, Some(_)) => RegimeVerdict {
                curve,
                ..RegimeVerdict::of(Regime::Torus)
            },
        };
    }
    let Some(exponents) = exponents else {
        return RegimeVerdict::undecided(
            "the returns are neither periodic nor quasi-periodic; the exponents (`lyapunov`) may decide, or skip more",
        );
    };
    if exponents.converged && exponents.values.first().is_some_and(positive) && disorder > IRREGULAR
    {
        // What varies is then the error of the run, which has no order.
        if repeats(points, accuracy) {
            return RegimeVerdict::undecided(ON_SADDLE);
        }
        return RegimeVerdict::of(Regime::Chaotic);
    }
    RegimeVerdict::undecided(
        "no exponent is certainly positive, and the returns have not converged; skip and record more",
    )
}

/// Two coordinates of the returns within the section; of more, those along the principal axes of the returns.
pub(crate) fn points(surface: &Surface, returns: &[Return]) -> Vec<[f64; 2]> {
    let origin = &returns[0].state;
    let inside = surface.directions(origin.as_slice());
    let inside = if inside.ncols() > 2 {
        principal(&inside, origin, returns)
    } else {
        inside
    };
    let along = |point: &Return, j: usize| -> f64 {
        (0..origin.len())
            .map(|i| inside[(i, j)] * (point.state[i] - origin[i]))
            .sum()
    };
    returns
        .iter()
        .map(|point| [along(point, 0), along(point, 1)])
        .collect()
}

/// The two orthogonal directions, out of all these, in which the returns spread most.
fn principal(inside: &Matrix, origin: &Vector, returns: &[Return]) -> Matrix {
    let (count, directions) = (returns.len() as f64, inside.ncols());
    let coordinates = |point: &Return| {
        let moved = &point.state - origin;
        Vector::from_fn(directions, |j, _| inside.column(j).dot(&moved))
    };
    let all: Vec<Vector> = returns.iter().map(coordinates).collect();
    let mean = all.iter().fold(Vector::zeros(directions), |sum, x| sum + x) / count;
    let covariance = all
        .iter()
        .fold(Matrix::zeros(directions, directions), |sum, x| {
            let off = x - &mean;
            sum + &off * off.transpose()
        });
    let mut order: Vec<usize> = (0..directions).collect();
    let Some((values, vectors)) = symmetric_eigenvalues(&covariance) else {
        return inside.columns(0, 2).into_owned();
    };
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    inside * vectors.select_columns(&order[..2])
}

/// Whether many points repeat after some number of returns.
fn repeats(points: &[[f64; 2]], accuracy: f64) -> bool {
    let n = points.len();
    let apart = |i: usize, j: usize| {
        let [x, y] = [0, 1].map(|k| points[i][k] - points[j][k]);
        x.abs().max(y.abs())
    };
    let spread = (1..n).map(|i| apart(i, 0)).fold(0.0, f64::max);
    let same = (REPEATED * spread).max(REPEATED_PER_ACCURACY * accuracy);
    (1..=n / 2).any(|q| {
        let repeating = (q..n).filter(|&i| apart(i, i - q) < same).count();
        repeating as f64 >= PART_THAT_REPEATS * (n - q) as f64
    })
}
