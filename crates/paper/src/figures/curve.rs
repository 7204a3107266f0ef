//! What figures of closed formulas share: grids, and curves that are solid where stable and dashed where not.

use twinslip_output::Cell;
use twinslip_output::plot::{PlotSeries, Stroke};

/// n numbers from `lo` to `hi` at equal distances, both included.
pub fn even(lo: f64, hi: f64, n: usize) -> Vec<f64> {
    let part = |i: usize| i as f64 / (n - 1) as f64;
    (0..n).map(|i| lo + (hi - lo) * part(i)).collect()
}

/// n numbers from `lo` to `hi` at equal ratios, both included.
pub fn geometric(lo: f64, hi: f64, n: usize) -> Vec<f64> {
    let mut numbers: Vec<f64> = even(lo.ln(), hi.ln(), n).iter().map(|x| x.exp()).collect();
    (numbers[0], numbers[n - 1]) = (lo, hi);
    numbers
}

/// Rows of numbers.
pub fn cells<const N: usize>(rows: impl IntoIterator<Item = [f64; N]>) -> Vec<Vec<Cell>> {
    let row = |row: [f64; N]| row.map(Cell::Number).to_vec();
    rows.into_iter().map(row).collect()
}

/// A curve with the stability of its points.
#[derive(Debug, Clone, Default)]
pub struct StabilityCurve {
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    pub stable: Vec<bool>,
}

impl StabilityCurve {
    pub fn push(&mut self, x: f64, y: f64, stable: bool) {
        self.x.push(x);
        self.y.push(y);
        self.stable.push(stable);
    }

    /// The stable parts solid, the others dashed. A stretch is what its end is; parts that there are not are left out.
    pub fn series(&self, label: [&str; 2], colour: usize) -> Vec<PlotSeries> {
        let part = |stable: bool| {
            let belongs = |i: usize| {
                let begins = |j: usize| self.stable.get(j) == Some(&stable);
                self.stable[i] == stable || begins(i + 1)
            };
            let y = (0..self.y.len()).map(|i| if belongs(i) { self.y[i] } else { f64::NAN });
            let y: Vec<f64> = y.collect();
            let stroke = if stable {
                Stroke::Solid
            } else {
                Stroke::Dashed
            };
            let name = label[usize::from(!stable)];
            PlotSeries::new(name, self.x.clone(), y)
                .stroke(stroke)
                .colour(colour)
        };
        [true, false]
            .into_iter()
            .filter(|stable| self.stable.contains(stable))
            .map(part)
            .collect()
    }
}
