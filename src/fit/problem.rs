//! What is fitted to what: the record of a measurement, the slider, and which of its parameters are free.

use super::least_squares::{Minimum, Residuals, minimise};
use super::response::{Response, steady_friction};
use super::slider::{Motion, Sliders, Stretch};
use crate::error::{Error, Result};
use nalgebra::{DMatrix, DVector};
use std::cell::{Cell, RefCell};

/// The name of the slope of a straight line that is added to the friction, per metre that the load point moves.
pub const DRIFT: &str = "drift";

/// A measurement: friction coefficients at ascending times.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// In s.
    pub times: Vec<f64>,
    /// How far the load point has moved since the beginning, in m.
    pub displacement: Vec<f64>,
    /// The friction coefficient.
    pub friction: Vec<f64>,
    /// How much the square of each residual counts.
    pub weights: Vec<f64>,
}

impl Record {
    /// Every so-manieth sample of it.
    pub fn thinned(&self, most: usize) -> Self {
        let stride = self.times.len().div_ceil(most.max(1)).max(1);
        self.only(&(0..self.times.len()).step_by(stride).collect::<Vec<_>>())
    }

    /// As many samples of it at most as twice `most`: half of them evenly, and half where each stretch of the motion begins, ever more
    /// sparsely, as friction changes fast after a step of velocity and slowly later.
    pub fn thinned_along(&self, motion: &Motion, most: usize) -> Self {
        let count = self.times.len();
        let stride = count.div_ceil(most.max(1)).max(1);
        let mut rows: Vec<usize> = (0..count).step_by(stride).collect();
        let each = most / motion.stretches.len().max(1);
        for Stretch { span, .. } in &motion.stretches {
            let first = self.times.partition_point(|&t| t < span.0);
            let last = self.times.partition_point(|&t| t <= span.1);
            let length = last.saturating_sub(first) as f64;
            let part = |k: usize| length.powf(k as f64 / each as f64) - 1.0;
            rows.extend((0..each).map(|k| first + part(k).max(0.0) as usize));
        }
        rows.retain(|&row| row < count);
        rows.sort_unstable();
        rows.dedup();
        self.only(&rows)
    }

    fn only(&self, rows: &[usize]) -> Self {
        let of = |all: &[f64]| rows.iter().map(|&row| all[row]).collect();
        Record {
            times: of(&self.times),
            displacement: of(&self.displacement),
            friction: of(&self.friction),
            weights: of(&self.weights),
        }
    }
}

/// What a parameter is varied by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Its logarithm: it stays positive, and errors are relative.
    Logarithmic,
    /// Itself.
    Linear,
}

impl Scale {
    /// The variable at a value of the parameter.
    pub fn inward(self, value: f64) -> f64 {
        match self {
            Scale::Logarithmic => value.ln(),
            Scale::Linear => value,
        }
    }

    /// The value of the parameter.
    pub fn outward(self, variable: f64) -> f64 {
        match self {
            Scale::Logarithmic => variable.exp(),
            Scale::Linear => variable,
        }
    }

    /// d value / d variable
    pub fn slope(self, value: f64) -> f64 {
        match self {
            Scale::Logarithmic => value,
            Scale::Linear => 1.0,
        }
    }
}

/// A parameter that is looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeParameter {
    /// Its name: one of [`Sliders::names`], or [`DRIFT`].
    pub name: String,
    /// What it is varied by.
    pub scale: Scale,
    /// Between which values.
    pub bounds: (f64, f64),
}

/// How residuals count that are large beside `scale`: each rho(r^2/scale^2), rho(u) = u for small u.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Loss {
    /// u
    Linear,
    /// 2 (sqrt(1 + u) - 1)
    SoftL1 {
        /// In friction.
        scale: f64,
    },
    /// u up to 1, then 2 sqrt(u) - 1
    Huber {
        /// In friction.
        scale: f64,
    },
    /// ln(1 + u)
    Cauchy {
        /// In friction.
        scale: f64,
    },
}

impl Loss {
    /// The z with z^2 = scale^2 rho and the sign of r, and dz/dr.
    fn apply(self, r: f64) -> (f64, f64) {
        let scale = match self {
            Loss::Linear => return (r, 1.0),
            Loss::Huber { scale } if r.abs() <= scale => return (r, 1.0),
            Loss::SoftL1 { scale } | Loss::Huber { scale } | Loss::Cauchy { scale } => scale,
        };
        let u = (r / scale).powi(2);
        if u == 0.0 {
            return (r, 1.0);
        }
        let (rho, slope) = match self {
            Loss::Linear => (u, 1.0),
            Loss::SoftL1 { .. } => {
                let root = (1.0 + u).sqrt();
                (2.0 * u / (root + 1.0), 1.0 / root)
            }
            Loss::Huber { .. } => (2.0 * u.sqrt() - 1.0, 1.0 / u.sqrt()),
            Loss::Cauchy { .. } => (u.ln_1p(), 1.0 / (1.0 + u)),
        };
        let z = (scale * rho.sqrt()).copysign(r);
        (z, slope * r / z)
    }
}

/// A fit that is asked for.
pub struct Problem<'a, const N: usize> {
    /// What slides.
    pub sliders: &'a dyn Sliders<N>,
    /// How its load point moves.
    pub motion: &'a Motion,
    /// What was measured.
    pub record: &'a Record,
    /// The parameters of the sliders: those that are fixed.
    pub parameters: Vec<f64>,
    /// The slope where it is fixed.
    pub drift: f64,
    /// What is looked for.
    pub free: Vec<FreeParameter>,
    /// How residuals count.
    pub loss: Loss,
}

impl<const N: usize> Problem<'_, N> {
    /// The places of free parameters among those of the sliders, and their columns.
    pub(super) fn places(&self) -> (Vec<usize>, Vec<usize>) {
        let names = self.sliders.names();
        let place = |free: &FreeParameter| names.iter().position(|name| *name == free.name);
        let columns = self.free.iter().enumerate();
        let found = columns.filter_map(|(column, free)| Some((place(free)?, column)));
        found.unzip()
    }

    /// All parameters of the sliders, and the slope, at these variables.
    pub fn parameters_at(&self, variables: &[f64]) -> (Vec<f64>, f64) {
        let (places, columns) = self.places();
        let value = |column: usize| self.free[column].scale.outward(variables[column]);
        let mut all = self.parameters.clone();
        for (place, column) in places.into_iter().zip(columns) {
            all[place] = value(column);
        }
        let drift = self.free.iter().position(|free| free.name == DRIFT);
        (all, drift.map_or(self.drift, value))
    }

    /// The friction coefficient of steady sliding at v V*, and its derivatives in the variables.
    ///
    /// # Errors
    /// Those of [`steady_friction`].
    pub fn steady(&self, variables: &[f64], v: f64) -> Result<(f64, Vec<f64>)> {
        let (places, columns) = self.places();
        let (parameters, _) = self.parameters_at(variables);
        let (friction, slopes) = steady_friction(self.sliders, (&parameters, &places), v)?;
        let mut all = vec![0.0; self.free.len()];
        for ((slope, place), column) in slopes.iter().zip(&places).zip(columns) {
            all[column] = slope * self.free[column].scale.slope(parameters[*place]);
        }
        Ok((friction, all))
    }

    /// The friction at these variables.
    ///
    /// # Errors
    /// Those of [`Response::of`].
    pub fn friction(&self, variables: &[f64]) -> Result<Vec<f64>> {
        let (parameters, drift) = self.parameters_at(variables);
        let Record {
            times,
            displacement,
            ..
        } = self.record;
        let response = Response::of(self.sliders, self.motion, times, (&parameters, &[]))?;
        let with_drift = response.friction.iter().zip(displacement);
        Ok(with_drift.map(|(mu, x)| mu + drift * x).collect())
    }

    /// The sum of squares of the residuals at these variables, as they count; infinite where there is no friction.
    pub(super) fn cost(&self, variables: &[f64]) -> f64 {
        let Ok(friction) = self.friction(variables) else {
            return f64::INFINITY;
        };
        let pairs = self.record.friction.iter().zip(&friction);
        let squares = pairs
            .zip(&self.record.weights)
            .map(|((measured, made), weight)| weight * self.loss.apply(measured - made).0.powi(2));
        squares.sum()
    }

    /// The friction at these variables, and its derivatives in them.
    ///
    /// # Errors
    /// Those of [`Response::of`].
    pub fn response(&self, variables: &[f64]) -> Result<(Vec<f64>, DMatrix<f64>)> {
        let (places, columns) = self.places();
        let (parameters, drift) = self.parameters_at(variables);
        let Record {
            times,
            displacement,
            ..
        } = self.record;
        let response = Response::of(self.sliders, self.motion, times, (&parameters, &places))?;
        let mut slopes = DMatrix::zeros(times.len(), self.free.len());
        for (j, &column) in columns.iter().enumerate() {
            let by = self.free[column].scale.slope(parameters[places[j]]);
            slopes.set_column(column, &(response.derivatives.column(j) * by));
        }
        if let Some(column) = self.free.iter().position(|free| free.name == DRIFT) {
            slopes.column_mut(column).copy_from_slice(displacement);
        }
        let with_drift = response.friction.iter().zip(displacement);
        let friction: Vec<f64> = with_drift.map(|(mu, x)| mu + drift * x).collect();
        if friction.iter().chain(&slopes).all(|x| x.is_finite()) {
            Ok((friction, slopes))
        } else {
            let what = "the friction of the slider";
            Err(Error::NonFinite { what, t: times[0] })
        }
    }

    /// The residuals, measured less computed, as they count.
    fn residuals(&self, friction: &[f64], mut slopes: DMatrix<f64>) -> Residuals {
        let Record {
            friction: measured,
            weights,
            ..
        } = self.record;
        let mut values = DVector::zeros(measured.len());
        for i in 0..measured.len() {
            let weight = weights[i].sqrt();
            let (z, slope) = self.loss.apply(measured[i] - friction[i]);
            values[i] = weight * z;
            let mut row = slopes.row_mut(i);
            row *= -weight * slope;
        }
        Residuals {
            values,
            jacobian: slopes,
        }
    }

    /// The variables at these values of the free parameters.
    pub fn variables(&self, values: &[f64]) -> Vec<f64> {
        let each = self.free.iter().zip(values);
        each.map(|(free, &value)| free.scale.inward(value))
            .collect()
    }

    /// The bounds of the variables.
    pub fn bounds(&self) -> Vec<(f64, f64)> {
        let of = |FreeParameter { scale, bounds, .. }: &FreeParameter| {
            (scale.inward(bounds.0), scale.inward(bounds.1))
        };
        self.free.iter().map(of).collect()
    }

    /// The least sum of squares from these variables on, within bounds, in `most` steps at most, to so many variances of a residual.
    ///
    /// # Errors
    /// Those of [`Problem::response`] at the start. Elsewhere such variables are too far.
    pub fn minimum(
        &self,
        variables: &[f64],
        bounds: &[(f64, f64)],
        effort: (usize, f64),
    ) -> Result<Minimum> {
        let failure = RefCell::new(None);
        let first = Cell::new(true);
        let mut evaluate = |x: &[f64]| {
            let response = self.response(x);
            let is_first = first.replace(false);
            match response {
                Ok((friction, slopes)) => Some(self.residuals(&friction, slopes)),
                Err(error) => {
                    if is_first {
                        failure.replace(Some(error));
                    }
                    None
                }
            }
        };
        let found = minimise(variables, bounds, effort, &mut evaluate);
        found.ok_or_else(|| {
            let known = failure.into_inner();
            known.unwrap_or(Error::NonFinite {
                what: "the friction of the slider",
                t: self.record.times[0],
            })
        })
    }
}
