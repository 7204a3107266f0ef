//! What is fitted to what: the records of measurements, the slider, and which of its parameters are free.

use super::free::{DRIFT, FreeParameter};
use super::least_squares::{Minimum, Residuals, minimise};
use super::loss::Loss;
use super::record::Record;
use super::response::{Response, TOLERANCE, steady_friction};
use super::slider::{Motion, Sliders};
use crate::error::{Error, Result};
use nalgebra::{DMatrix, DVector};
use std::cell::{Cell, RefCell};

/// A record that is fitted, with what is fixed for it.
#[derive(Clone)]
pub struct FittedRecord<'a> {
    /// What was measured.
    pub record: &'a Record,
    /// How the load point moved.
    pub motion: &'a Motion,
    /// The parameters of the sliders: those that are fixed.
    pub parameters: Vec<f64>,
    /// The slope where it is fixed.
    pub drift: f64,
}

/// A fit that is asked for: of one record, or of several with parameters in common.
#[derive(Clone)]
pub struct Problem<'a, const N: usize> {
    /// What slides.
    pub sliders: &'a dyn Sliders<N>,
    /// What was measured, at least one record.
    pub records: Vec<FittedRecord<'a>>,
    /// What is looked for.
    pub free: Vec<FreeParameter>,
    /// How residuals count.
    pub loss: Loss,
}

impl<const N: usize> Problem<'_, N> {
    /// The same of these records in place of its own, one for each.
    pub(super) fn with<'b>(&'b self, records: &'b [Record]) -> Problem<'b, N> {
        let each = self.records.iter().zip(records);
        let of = |(own, record): (&'b FittedRecord<'_>, &'b Record)| FittedRecord {
            record,
            ..own.clone()
        };
        Problem {
            records: each.map(of).collect(),
            ..self.clone()
        }
    }

    /// How many samples there are in all records.
    pub fn samples(&self) -> usize {
        let each = self.records.iter();
        each.map(|one| one.record.times.len()).sum()
    }

    /// The rows of each record among all.
    pub(super) fn rows(&self) -> Vec<std::ops::Range<usize>> {
        let mut begun = 0;
        let each = self.records.iter().map(|one| {
            let first = begun;
            begun += one.record.times.len();
            first..begun
        });
        each.collect()
    }

    /// The friction that was measured, of all records one after the other.
    pub(super) fn measured(&self) -> impl Iterator<Item = f64> + '_ {
        let each = self.records.iter();
        each.flat_map(|one| one.record.friction.iter().copied())
    }

    /// The places of a record's free parameters among those of the sliders, and their columns.
    pub(super) fn places(&self, record: usize) -> (Vec<usize>, Vec<usize>) {
        let names = self.sliders.names();
        let place = |free: &FreeParameter| names.iter().position(|name| *name == free.name);
        let found = self.columns(record);
        found
            .filter_map(|(column, free)| Some((place(free)?, column)))
            .unzip()
    }

    /// The free parameters that a record has.
    fn columns(&self, record: usize) -> impl Iterator<Item = (usize, &FreeParameter)> {
        let all = self.free.iter().enumerate();
        all.filter(move |(_, free)| free.of_record.is_none_or(|own| own == record))
    }

    pub(super) fn drift_column(&self, record: usize) -> Option<usize> {
        let mut all = self.columns(record);
        all.find_map(|(column, free)| (free.name == DRIFT).then_some(column))
    }

    /// All parameters of the sliders, and the slope, of a record at these variables.
    pub fn parameters_at(&self, record: usize, variables: &[f64]) -> (Vec<f64>, f64) {
        let (places, columns) = self.places(record);
        let value = |column: usize| self.free[column].scale.outward(variables[column]);
        let own = &self.records[record];
        let mut all = own.parameters.clone();
        for (place, column) in places.into_iter().zip(columns) {
            all[place] = value(column);
        }
        (all, self.drift_column(record).map_or(own.drift, value))
    }

    /// The friction coefficient of steady sliding at v V* with the parameters of a record, and its derivatives in the variables.
    ///
    /// # Errors
    /// Those of [`steady_friction`].
    pub fn steady(&self, record: usize, variables: &[f64], v: f64) -> Result<(f64, Vec<f64>)> {
        let (places, columns) = self.places(record);
        let (parameters, _) = self.parameters_at(record, variables);
        let (friction, slopes) = steady_friction(self.sliders, (&parameters, &places), v)?;
        let mut all = vec![0.0; self.free.len()];
        for ((slope, place), column) in slopes.iter().zip(&places).zip(columns) {
            all[column] = slope * self.free[column].scale.slope(parameters[*place]);
        }
        Ok((friction, all))
    }

    /// The friction at these variables, of all records one after the other.
    ///
    /// # Errors
    /// Those of [`Response::of`].
    pub fn friction(&self, variables: &[f64]) -> Result<Vec<f64>> {
        let mut all = Vec::with_capacity(self.samples());
        for (i, one) in self.records.iter().enumerate() {
            let (parameters, drift) = self.parameters_at(i, variables);
            let times = &one.record.times;
            let response = Response::of(self.sliders, one.motion, times, (&parameters, &[]))?;
            let with_drift = response.friction.iter().zip(&one.record.displacement);
            all.extend(with_drift.map(|(mu, x)| mu + drift * x));
        }
        Ok(all)
    }

    /// The sum of squares of the residuals at these variables, as they count; infinite where there is no friction.
    pub(super) fn cost(&self, variables: &[f64]) -> f64 {
        let Ok(friction) = self.friction(variables) else {
            return f64::INFINITY;
        };
        let residuals = self.measured().zip(&friction).map(|(own, made)| own - made);
        let squares = residuals
            .zip(self.weights())
            .map(|(residual, weight)| weight * self.loss.apply(residual).0.powi(2));
        squares.sum()
    }

    /// How much the square of each residual counts.
    fn weights(&self) -> impl Iterator<Item = f64> + '_ {
        let each = self.records.iter();
        each.flat_map(|one| one.record.weights.iter().copied())
    }

    /// The friction of a record at some times, when the load point has moved so far, and its derivatives in the variables; steps may err by the
    /// tolerance.
    ///
    /// # Errors
    /// Those of [`Response::of`].
    pub(super) fn response_of(
        &self,
        record: usize,
        (times, moved): (&[f64], &[f64]),
        variables: &[f64],
        tolerance: f64,
    ) -> Result<(Vec<f64>, DMatrix<f64>)> {
        let (places, columns) = self.places(record);
        let (parameters, drift) = self.parameters_at(record, variables);
        let of = (self.sliders, self.records[record].motion);
        let response = Response::to(tolerance, of, times, (&parameters, &places))?;
        let with_drift = response.friction.iter().zip(moved);
        let friction = with_drift.map(|(mu, x)| mu + drift * x).collect();
        let mut slopes = DMatrix::zeros(times.len(), self.free.len());
        for (j, &column) in columns.iter().enumerate() {
            let by = self.free[column].scale.slope(parameters[places[j]]);
            slopes.set_column(column, &(response.derivatives.column(j) * by));
        }
        if let Some(column) = self.drift_column(record) {
            slopes.column_mut(column).copy_from_slice(moved);
        }
        Ok((friction, slopes))
    }

    /// The friction at these variables, of all records one after the other, and its derivatives in them.
    ///
    /// # Errors
    /// Those of [`Response::of`].
    pub fn response(&self, variables: &[f64]) -> Result<(Vec<f64>, DMatrix<f64>)> {
        let mut slopes = DMatrix::zeros(self.samples(), self.free.len());
        let mut friction = Vec::with_capacity(self.samples());
        for (i, rows) in self.rows().into_iter().enumerate() {
            let Record {
                times,
                displacement,
                ..
            } = self.records[i].record;
            let (own, of_own) = self.response_of(i, (times, displacement), variables, TOLERANCE)?;
            friction.extend(own);
            let mut rows = slopes.rows_mut(rows.start, rows.len());
            rows.copy_from(&of_own);
        }
        if friction.iter().chain(&slopes).all(|x| x.is_finite()) {
            Ok((friction, slopes))
        } else {
            let what = "the friction of the slider";
            let t = self.records[0].record.times[0];
            Err(Error::NonFinite { what, t })
        }
    }

    /// The residuals, measured less computed, as they count.
    pub(super) fn residuals(&self, friction: &[f64], mut slopes: DMatrix<f64>) -> Residuals {
        let mut values = DVector::zeros(friction.len());
        let all = self.measured().zip(self.weights()).zip(friction);
        for (i, ((measured, weight), made)) in all.enumerate() {
            let weight = weight.sqrt();
            let (z, slope) = self.loss.apply(measured - made);
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
                t: self.records[0].record.times[0],
            })
        })
    }
}
