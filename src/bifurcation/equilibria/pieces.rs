//! Where the curves begin and end within a range of V_H.
//!
//! The asymmetric states of a law with extrema V_M and V_m form one curve from pitchfork to pitchfork: with a < b < c the three
//! rates of one stress between tau_m and tau_M, it runs through the pairs (a, b), (a, c) and (b, c). So every piece of it within
//! a range has two ends, each a pitchfork or a state at an end of the range, and nothing closed lies within.

use super::curves::CurveVariables;
use super::stationary::pitchforks;
use crate::continuation::{Branch, CurvePoint, Start, Stop};
use crate::equilibrium::{Solver, Symmetry, steady_states};
use crate::error::Result;
use crate::friction::AnyLaw;
use nalgebra::DVector;

/// A begin, or an end.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PieceEnd {
    pub start: Start,
    /// V_H or K there, exactly.
    pub value: f64,
    pub pitchfork: bool,
}

impl PieceEnd {
    pub fn at_range_end(
        law: &AnyLaw,
        curve: CurveVariables,
        value: f64,
        forward: bool,
        rates: [f64; 2],
    ) -> Self {
        let u = curve.unknown(law, rates);
        let mut direction = DVector::zeros(u.len() + 1);
        direction[u.len()] = if forward { 1.0 } else { -1.0 };
        PieceEnd {
            start: Start {
                u,
                lambda: value.ln(),
                direction,
                across: false,
            },
            value,
            pitchfork: false,
        }
    }

    /// Where nothing but lambda changes.
    pub fn on_a_line(law: &AnyLaw, value: f64, forward: bool, rates: [f64; 2]) -> Self {
        let curve = CurveVariables::Symmetric { interfaces: 1 };
        Self::at_range_end(law, curve, value, forward, rates)
    }

    fn at_pitchfork(driving: f64) -> Self {
        PieceEnd {
            start: Start {
                u: DVector::zeros(1),
                lambda: driving.ln(),
                direction: DVector::from_row_slice(&[1.0, 0.0]),
                // at a pitchfork lambda does not say where
                across: true,
            },
            value: driving,
            pitchfork: true,
        }
    }

    /// Distance in z and ln V_H.
    fn distance(&self, point: &CurvePoint) -> f64 {
        (&self.start.u - &point.u).amax() + (self.start.lambda - point.lambda).abs()
    }
}

/// The ends of all pieces of the asymmetric curve that have not been met.
#[derive(Debug)]
pub(super) struct Ends(Vec<PieceEnd>);

impl Ends {
    /// Within this range of V_H, in the order from its first end.
    pub fn of(law: &AnyLaw, (from, to): (f64, f64)) -> Result<Self> {
        let inside = |v: f64| v > from.min(to) && v < from.max(to);
        let mut all: Vec<_> = pitchforks(law)
            .iter()
            .map(|p| p.driving.value)
            .filter(|&v| inside(v))
            .map(PieceEnd::at_pitchfork)
            .collect();
        for (value, other) in [(from, to), (to, from)] {
            for state in steady_states(law, value, 2, Solver::Newton)?.equilibria {
                if state.symmetry == Symmetry::Asymmetric {
                    let rates = [state.slip_rate[0], state.slip_rate[1]];
                    all.push(PieceEnd::at_range_end(
                        law,
                        CurveVariables::Asymmetric,
                        value,
                        value < other,
                        rates,
                    ));
                }
            }
        }
        // the last one is taken next
        let far = |begin: &PieceEnd| (begin.value / from).ln().abs();
        all.sort_by(|a, b| far(b).total_cmp(&far(a)));
        Ok(Ends(all))
    }

    pub fn next(&mut self) -> Option<PieceEnd> {
        self.0.pop()
    }

    /// The end that a piece was followed to is no begin any more.
    pub fn reached(&mut self, branch: &Branch) {
        let Some((last, _)) = branch.points.last() else {
            return;
        };
        let pitchfork = matches!(branch.stopped, Stop::Ended(_));
        let near = |begin: &PieceEnd| begin.pitchfork == pitchfork && begin.distance(last) < 1e-6;
        self.0.retain(|begin| !near(begin));
    }
}
