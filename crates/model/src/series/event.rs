//! Zeros along solutions given as series: where they pass a section, and where they turn.
//!
//! Along one expansion a linear functional of the variables is a polynomial in time, and so is its derivative: their zeros
//! need no dense output and no law. [`Zeros`] carries the sign from step to step, so that rounding at a joint neither loses
//! nor doubles one.

use super::{Expansion, REFERENCE_ORDER};
use crate::number::polynomial::{Crossing, Root, roots};

/// A function of a state that is watched for zeros, linear in the variables x of an [`Expansion`] and not in its chart: in
/// (tau, psi) for the interfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Section<'a> {
    /// normal . x - offset: the solution passes a plane.
    Plane {
        /// The plane's normal.
        normal: &'a [f64],
        /// Its distance from 0 in the length of the normal.
        offset: f64,
    },
    /// The time derivative of normal . x: it is largest (downwards) or smallest (upwards).
    Extremum {
        /// What is largest or smallest.
        normal: &'a [f64],
    },
}

/// A zero of a section along an expansion.
#[derive(Debug, Clone, PartialEq)]
pub struct Passage {
    /// Time since the beginning of the step; `Expansion::begin` is to be added.
    pub time: f64,
    /// How the section's sign changes as time grows.
    pub crossing: Crossing,
    /// The state there, by the polynomials.
    pub state: Vec<f64>,
}

/// The zeros of a function along consecutive steps. Every step begins with the sign that the one before ended with: what
/// rounding, or the error of a step, makes of it at a joint is no crossing.
#[derive(Debug, Clone, Default)]
pub struct Zeros {
    /// 1 or -1, the sign with which the last step ended; 0 where it is not known, as before the first step.
    pub sign: f64,
    found: Vec<Root>,
}

impl Zeros {
    /// The zeros of sum_k c_k t^k between 0 and `length`, as [`roots`] gives them, a zero at the end included.
    ///
    /// # Panics
    /// If the degree is above [`REFERENCE_ORDER`].
    pub fn follow(&mut self, coefficients: &[f64], length: f64) -> &[Root] {
        self.found.clear();
        let way = length.signum();
        let begins = first_sign(coefficients, way);
        if self.sign == 0.0 {
            self.sign = begins;
        }
        if begins == self.sign {
            roots(coefficients, length, &mut self.found);
        } else {
            // As if the function were 0 at the joint, on the side where it was: then a crossing that is due comes at once. Not
            // so near 0 that a search for it would not end.
            const NEARLY_ZERO: f64 = f64::EPSILON * f64::EPSILON;
            let backwards = coefficients.iter().rev();
            let size = backwards.fold(0.0, |sum, c| sum * length.abs() + c.abs());
            let mut joined = [0.0; REFERENCE_ORDER + 1];
            let joined = &mut joined[..coefficients.len()];
            joined.copy_from_slice(coefficients);
            joined[0] = self.sign * (NEARLY_ZERO * size).max(f64::MIN_POSITIVE);
            roots(joined, length, &mut self.found);
        }
        for root in &self.found {
            match root.crossing {
                Crossing::Upwards => self.sign = way,
                Crossing::Downwards => self.sign = -way,
                Crossing::Touching => {}
            }
        }
        &self.found
    }
}

/// The sign just after 0 on the way; 0 of zero.
fn first_sign(coefficients: &[f64], way: f64) -> f64 {
    let first = coefficients.iter().position(|c| *c != 0.0);
    first.map_or(0.0, |k| {
        coefficients[k].signum() * if k % 2 == 0 { 1.0 } else { way }
    })
}

impl<const N: usize> Expansion<N> {
    /// Appends the zeros of a section within this step to `found`, in the order in which the solution meets them; only those
    /// of one direction if one is given. `zeros` is the same along all steps of a solution.
    ///
    /// ```
    /// use twinslip::field::State;
    /// use twinslip::friction::Parameters;
    /// use twinslip::integrate::{Control, Integrator, MAX_STEPS, Taylor, Tolerances};
    /// use twinslip::model::{Loading, TwoInterfaces};
    /// use twinslip::number::polynomial::Crossing;
    /// use twinslip::series::{Section, Zeros};
    /// # fn main() -> twinslip::Result<()> {
    /// let law = Parameters::heslot_1994().spinodal();
    /// let field = TwoInterfaces { law, loading: Loading::new(10.0, 0.14)? };
    /// let start = State::<3>::new(10.0, 0.5_f64.ln(), 0.001_f64.ln());
    /// // tau rises through 10 once in every cycle
    /// let section = Section::Plane { normal: &[1.0, 0.0, 0.0], offset: 10.0 };
    /// let (mut zeros, mut passages) = (Zeros::default(), Vec::new());
    /// let mut taylor = Taylor::new(Tolerances::equal(1e-12)?, MAX_STEPS)?;
    /// taylor.flow(&field, (0.0, 20.0), &start, Some(&mut |step| {
    ///     if let Some(series) = step.series() {
    ///         series.crossings(section, Some(Crossing::Upwards), &mut zeros, &mut passages);
    ///     }
    ///     Ok(Control::Continue)
    /// }))?;
    /// assert!(passages.len() > 4);
    /// assert!(passages.iter().all(|passage| (passage.state[0] - 10.0).abs() < 1e-14));
    /// # Ok(())
    /// # }
    /// ```
    pub fn crossings(
        &self,
        section: Section<'_>,
        direction: Option<Crossing>,
        zeros: &mut Zeros,
        found: &mut Vec<Passage>,
    ) {
        let (Section::Plane { normal, .. } | Section::Extremum { normal }) = section;
        let variables = normal.len();
        let mut function = [0.0; REFERENCE_ORDER + 1];
        let function = self.along(section, &mut function);
        let roots = zeros.follow(function, self.length / self.unit).iter();
        let wanted = roots.filter(|root| direction.is_none_or(|d| d == root.crossing));
        found.extend(wanted.map(|root| Passage {
            time: root.at * self.unit,
            crossing: root.crossing,
            state: self.state_at(root.at)[..variables].to_vec(),
        }));
    }

    /// The section's coefficients. Those of a derivative are in the unit of the series, which changes no zero.
    fn along<'a>(
        &self,
        section: Section<'_>,
        into: &'a mut [f64; REFERENCE_ORDER + 1],
    ) -> &'a [f64] {
        let (Section::Plane { normal, .. } | Section::Extremum { normal }) = section;
        let projected = |j: usize| -> f64 {
            let parts = normal.iter().zip(&self.variables);
            parts.map(|(along, series)| along * series[j]).sum()
        };
        match section {
            Section::Plane { offset, .. } => {
                for (j, c) in into[..=self.order].iter_mut().enumerate() {
                    *c = projected(j);
                }
                into[0] -= offset;
                &into[..=self.order]
            }
            Section::Extremum { .. } => {
                for (j, c) in into[..self.order].iter_mut().enumerate() {
                    *c = (j + 1) as f64 * projected(j + 1);
                }
                &into[..self.order]
            }
        }
    }
}
