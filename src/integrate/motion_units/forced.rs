//! The units of a run of a system that depends on time itself.

use super::{MotionUnits, completed, fastest, round, sizes_at_start};
use crate::error::Result;
use crate::field::Vector;
use crate::integrate::AnyField;
use crate::model::TextSystem;
use std::borrow::Cow;

/// Times within the run at which the rates are looked at.
const LOOKS: usize = 64;
/// Of what a state comes to that does not move yet.
const PART: f64 = 1e-8;

impl MotionUnits {
    /// Those at the start of a run that lasts so long, which has the initial time after the states: time counts by the fastest rate of the linearised
    /// system and of what drives it. States that begin at 0 and do not move yet, as before a switch, have a tiny part of what the rates come to.
    pub(super) fn at_start_in_time(
        system: &TextSystem,
        start: &Vector,
        lasting: f64,
    ) -> Result<Self> {
        let field = AnyField::of_text(Cow::Borrowed(system))?;
        let jacobian = field.jacobian(start);
        let time = round(1.0 / fastest(&jacobian).max(fastest_drive(system, start)));
        let time = if time.is_normal() {
            time
        } else {
            round(lasting)
        };
        let mut sizes = sizes_at_start((&field, &jacobian), start, time);
        let last = start.len() - 1;
        let mut way = Vector::zeros(start.len());
        for k in 1..=LOOKS {
            let mut then = start.clone();
            then[last] += lasting * k as f64 / LOOKS as f64;
            for (way, rate) in way.iter_mut().zip(&field.f(&then)) {
                *way = way.max(if rate.is_finite() { rate.abs() } else { 0.0 });
            }
        }
        way *= PART * time;
        for _ in 0..last {
            for (size, way) in sizes.iter_mut().zip(&way) {
                if !size.is_normal() {
                    *size = *way;
                }
            }
            way = jacobian.abs() * way * time;
        }
        Ok(Self::new(completed(&sizes.as_slice()[..last]), time).rounded())
    }
}

/// How fast time itself changes the rates: of A sin(w t + p) it is w, whatever the phase. 0 where nothing says so, as of a rate that only grows in
/// proportion to time.
fn fastest_drive(system: &TextSystem, start: &Vector) -> f64 {
    let [f, first, second, third] = system.derivatives_in_last(start.as_slice());
    let rate = |i: usize| {
        // Either may be by chance: where its denominator passes 0.
        let both = [second[i] / f[i], third[i] / first[i]];
        let known = both.map(|ratio| ratio.abs().sqrt()).into_iter();
        let known = known.filter(|rate| rate.is_normal());
        known.reduce(f64::min).unwrap_or(0.0)
    };
    (0..f.len()).map(rate).fold(0.0, f64::max)
}
