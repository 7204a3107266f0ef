//! The slips of all interfaces along a run: term by term where a step is a series, else by quadrature.

use super::any_system::{AnySystem, SlipRate};
use super::equations::Subspace;
use twinslip::integrate::AnyStep;
use twinslip::number::DoubleDouble;

/// Slips since the start. Many small steps are summed, and the slips of short events are differences of long sums: in 31
/// digits neither loses any that the steps have.
pub(super) type Slips = Vec<DoubleDouble>;

/// Nodes and weights of the Gauss-Legendre quadrature with five points on (0, 1): exact to degree 9, more than the dense
/// output has.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668_004, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// The slip rates of the interfaces of a run, or of its clusters of equal ones.
#[derive(Clone)]
pub(super) struct SlipRates {
    of: SlipRate,
    subspace: Subspace,
    /// How many interfaces each stands for.
    counts: Vec<usize>,
    /// How many variables there are.
    variables: usize,
}

impl SlipRates {
    pub fn of(system: &AnySystem, subspace: Subspace) -> Self {
        SlipRates {
            of: system.slip_rate(),
            counts: system.clusters().to_vec(),
            variables: match subspace {
                Subspace::Whole => system.states().len(),
                Subspace::Symmetric => 2,
            },
            subspace,
        }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.counts.len()
    }

    /// How many interfaces each stands for.
    pub fn counts(&self) -> &[usize] {
        &self.counts
    }

    /// Each of them, at variables that begin with those of the subspace, and end with time where that is one.
    pub fn each(&self, y: &[f64]) -> impl Iterator<Item = f64> {
        let mut states = Vec::with_capacity(self.variables + 1);
        self.subspace.whole(&y[..self.variables], &mut states);
        let time = y[y.len() - 1];
        (0..self.counts.len()).map(move |i| (self.of)(i, &states, time))
    }

    /// Their sum over all interfaces.
    pub fn total(&self, y: &[f64]) -> f64 {
        let each = self.each(y).zip(&self.counts);
        each.map(|(v, &count)| count as f64 * v).sum()
    }
}

/// The slips at t, from those at the beginning of the step. Always from there, so that a slip does not depend on which rows
/// are asked for. In 2-D the balance K (V_H t - n slip) = tau - tau(0) would do, but loses digits where K is small.
pub(super) fn slips(
    rates: &SlipRates,
    step: &AnyStep<'_>,
    before: &[DoubleDouble],
    t: f64,
    into: &mut Slips,
) {
    into.clear();
    if t == step.t1
        && let Some(within) = step.slips()
    {
        let both = before.iter().zip(within);
        into.extend(both.map(|(before, within)| *before + within));
        return;
    }
    let time = step.since_begin(t);
    if let Some(series) = step.series() {
        let each = before.iter().enumerate();
        into.extend(each.map(|(i, before)| *before + series.slip(i, time)));
        return;
    }
    let both = before.iter().zip(quadrature(rates, step, time));
    into.extend(both.map(|(before, within)| *before + within));
}

/// The slips within a time h from the beginning of the step, along the dense output.
fn quadrature(rates: &SlipRates, step: &AnyStep<'_>, h: f64) -> Vec<f64> {
    let mut slips = vec![0.0; rates.count()];
    for (node, weight) in GAUSS {
        let y = step.after(node * h);
        for (slip, v) in slips.iter_mut().zip(rates.each(y.as_slice())) {
            *slip += weight * h * v;
        }
    }
    slips
}
