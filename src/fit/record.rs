//! What was measured.

use super::slider::{Motion, Stretch};

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
