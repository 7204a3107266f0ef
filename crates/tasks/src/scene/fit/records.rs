//! Several records fitted together: each alone, then all with what they share.

use super::law::LawToFit;
use super::plan::{FitPlan, Piece};
use twinslip::error::{Error, Result};
use twinslip::fit::{Agreement, Fit, FittedParameter, FreeParameter, Record};

/// What one of several records says.
#[derive(Debug)]
pub struct OwnRecord {
    /// Its fit alone.
    pub fit: Result<Fit>,
    /// By what its samples are multiplied in the fit of all: the inverse variance of its residuals, times what correlated noise widens the variance of a
    /// parameter by; 1 for the record with the least.
    pub weight: f64,
}

/// The fit of a law.
#[derive(Debug)]
pub struct FittedRecords {
    /// Of all records.
    pub fit: Fit,
    /// Each record alone, where there are several.
    pub alone: Vec<OwnRecord>,
    /// How the records agree on each parameter that they share.
    pub agreements: Vec<Agreement>,
    /// The records as they count.
    pub records: Vec<Record>,
}

impl FittedRecords {
    /// The records as they count, with their motions.
    pub fn pieces<'a>(&'a self, plan: &'a FitPlan) -> Vec<Piece<'a>> {
        weighted(plan, &self.records)
    }
}

fn weighted<'a>(plan: &'a FitPlan, records: &'a [Record]) -> Vec<Piece<'a>> {
    let pairs = plan.pieces().into_iter().zip(records);
    let each = pairs.map(|(piece, record)| Piece { record, ..piece });
    each.collect()
}

impl FitPlan {
    /// Fits a law to all records. Of several the samples of each are weighted by the inverse variance of its noise when it is fitted alone, and
    /// count the same otherwise: a longer record says more. Errors are widened where records differ more than their noise explains.
    ///
    /// # Errors
    /// Those of [`twinslip::fit::fit()`].
    pub fn fit(&self, law: &LawToFit) -> Result<FittedRecords> {
        let pieces = self.pieces();
        let own = |piece: &Piece<'_>| {
            let shown = &self.recordings[piece.of].shown;
            self.fit_from(law, &[*piece], law.starts(shown, self.reference_rate))
        };
        let mut records: Vec<Record> = pieces.iter().map(|piece| piece.record.clone()).collect();
        if let [piece] = pieces.as_slice() {
            return Ok(FittedRecords {
                fit: own(piece)?,
                alone: Vec::new(),
                agreements: Vec::new(),
                records,
            });
        }
        let mut fits: Vec<Result<Fit>> = pieces.iter().map(own).collect();
        if fits.iter().all(Result::is_err) {
            return Err(fits
                .swap_remove(0)
                .err()
                .unwrap_or_else(|| Error::Input("no record is fitted".into())));
        }
        let variance = |fit: &Fit| {
            let widenings = fit.parameters.iter().map(|one| one.widening.powi(2));
            fit.rms.powi(2) * widenings.sum::<f64>() / fit.parameters.len() as f64
        };
        let squares: Vec<Option<f64>> = fits
            .iter()
            .map(|one| one.as_ref().ok().map(variance))
            .map(|own| own.filter(|own| own.is_finite()))
            .collect();
        let least = squares
            .iter()
            .flatten()
            .fold(f64::INFINITY, |least, own| least.min(*own));
        // A record that is not fitted alone counts as the others do.
        let weights: Vec<f64> = squares
            .iter()
            .map(|own| own.filter(|own| *own > 0.0).map_or(1.0, |own| least / own))
            .collect();
        for (record, weight) in records.iter_mut().zip(&weights) {
            record.weights.iter_mut().for_each(|own| *own *= weight);
        }
        let known: Vec<Option<&Fit>> = fits.iter().map(|one| one.as_ref().ok()).collect();
        let free = law.free_of(pieces.len());
        let counted = weighted(self, &records);
        let mut fit = self.fit_from(law, &counted, starts(&free, &known))?;
        let shared = free.iter().filter(|free| free.of_record.is_none());
        let agreements = shared.map(|free| Agreement::of(&free.name, &known));
        let agreements: Vec<Agreement> = agreements.collect();
        let widening = agreements.iter().map(|one| one.widening);
        fit.widen(widening.fold(1.0, f64::max));
        let pairs = fits.into_iter().zip(weights);
        Ok(FittedRecords {
            alone: pairs
                .map(|(fit, weight)| OwnRecord { fit, weight })
                .collect(),
            fit,
            agreements,
            records,
        })
    }
}

/// Where the fit of all records begins: what each has of its own where its fit alone has it, and what they share at the median of their fits, and
/// at each of these.
fn starts(free: &[FreeParameter], alone: &[Option<&Fit>]) -> Vec<Vec<f64>> {
    let of = |fit: &Fit, name: &str| {
        let mut all = fit.parameters.iter();
        all.find(|one: &&FittedParameter| one.name == name)
            .map(|one| one.value)
    };
    let median = |name: &str| {
        let values = alone.iter().flatten().filter_map(|fit| of(fit, name));
        let mut values: Vec<f64> = values.collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    };
    let start = |shared: Option<&Fit>| {
        let each = free.iter().map(|free| {
            let fit = match free.of_record {
                Some(at) => alone[at],
                None => shared,
            };
            let own = fit.and_then(|fit| of(fit, &free.name));
            own.or_else(|| median(&free.name))
        });
        each.collect::<Option<Vec<f64>>>()
    };
    let middle = start(None);
    let each = alone.iter().flatten().filter_map(|fit| start(Some(fit)));
    middle.into_iter().chain(each).collect()
}
