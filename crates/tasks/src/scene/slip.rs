//! The slips of both interfaces along a run: term by term where a step is a series, else by quadrature.

use twinslip::field::State;
use twinslip::integrate::Step;
use twinslip::model::Driven;
use twinslip::number::DoubleDouble;

/// Slips since the start. Many small steps are summed, and the slips of short events are differences of long sums: in 31
/// digits neither loses any that the steps have.
pub(super) type Slips = [DoubleDouble; 2];

/// Nodes and weights of the Gauss-Legendre quadrature with five points on (0, 1): exact to degree 9, more than the dense
/// output has.
pub(super) const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668_004, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// The slips at t, from those at the beginning of the step. Always from there, so that a slip does not depend on which rows
/// are asked for. In 2-D the balance K (V_H t - n slip) = tau - tau(0) would do, but loses digits where K is small.
pub(super) fn slips<const N: usize>(
    field: &dyn Driven<N>,
    step: &Step<'_, N>,
    before: &Slips,
    t: f64,
) -> Slips {
    if t == step.t1
        && let Some(within) = step.slips()
    {
        return [0, 1].map(|i| before[i] + within[i]);
    }
    let time = step.since_begin(t);
    let within = match step.series() {
        Some(series) => series.slips(time),
        None => quadrature(field, step, time),
    };
    sum(before, within)
}

pub(super) fn sum(before: &Slips, within: [f64; 2]) -> Slips {
    [0, 1].map(|i| before[i] + within[i])
}

/// The slips within a time h from the beginning of the step, along the dense output.
fn quadrature<const N: usize>(field: &dyn Driven<N>, step: &Step<'_, N>, h: f64) -> [f64; 2] {
    let mut slips = [0.0; 2];
    for (node, weight) in GAUSS {
        let v = field.slip_rates(&step.after(node * h));
        for (slip, v) in slips.iter_mut().zip(v) {
            *slip += weight * h * v;
        }
    }
    slips
}

/// The dense output, and exactly the step's own states at its ends.
pub(super) fn at<const N: usize>(step: &Step<'_, N>, t: f64) -> State<N> {
    if t == step.t1 {
        *step.y1
    } else if t == step.t0 {
        *step.y0
    } else {
        step.dense(t)
    }
}
