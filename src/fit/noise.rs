//! What residuals say about the noise of a measurement: how they go on from one sample to the next, and what that does to errors.
//!
//! Records of friction are never white: load cells drift, electronics filter, gouge has a history. Residuals are described as an
//! autoregression x_i = sum of c_k x_(i-k) + e_i; the covariance of least-squares estimates under such noise is the sandwich
//! (J'J)^-1 J' W J (J'J)^-1 with its covariance W.

use nalgebra::DMatrix;

/// No more coefficients.
const MOST_COEFFICIENTS: usize = 24;
/// So many residuals for each coefficient, at least.
const RESIDUALS_EACH: usize = 20;

/// An autoregression.
#[derive(Debug, Clone, PartialEq)]
pub struct Autoregression {
    /// c_1, c_2, ...; none for white noise.
    pub coefficients: Vec<f64>,
    /// The variance of e.
    pub innovation: f64,
}

impl Autoregression {
    /// That of residuals, of the order with the least BIC (Schwarz 1978), by Burg's method, whose autoregressions are stable.
    ///
    /// Burg, J. P. (1967). Maximum entropy spectral analysis. 37th meeting of the Society of Exploration Geophysicists.
    pub fn of(residuals: &[f64]) -> Self {
        let n = residuals.len() as f64;
        let most = MOST_COEFFICIENTS.min(residuals.len() / RESIDUALS_EACH);
        let squares: f64 = residuals.iter().map(|x| x * x).sum();
        let mut known = Autoregression {
            coefficients: Vec::new(),
            innovation: squares / n,
        };
        if squares == 0.0 {
            return known;
        }
        let criterion =
            |one: &Autoregression| n * one.innovation.ln() + one.coefficients.len() as f64 * n.ln();
        let (mut forward, mut backward) = (residuals.to_vec(), residuals.to_vec());
        let mut best = known.clone();
        for order in 1..=most {
            // Errors of prediction, forwards of sample i and backwards of sample i - order.
            let pairs = || forward[order..].iter().zip(&backward[order - 1..]);
            let both: f64 = pairs().map(|(f, b)| f * b).sum();
            let size: f64 = pairs().map(|(f, b)| f * f + b * b).sum();
            if size == 0.0 {
                break;
            }
            let reflection = 2.0 * both / size;
            let before = known.coefficients.clone();
            for (c, mirrored) in known.coefficients.iter_mut().zip(before.iter().rev()) {
                *c -= reflection * mirrored;
            }
            known.coefficients.push(reflection);
            known.innovation *= 1.0 - reflection * reflection;
            for i in (order..residuals.len()).rev() {
                let (f, b) = (forward[i], backward[i - 1]);
                forward[i] = f - reflection * b;
                backward[i] = b - reflection * f;
            }
            if criterion(&known) < criterion(&best) {
                best = known.clone();
            }
        }
        best
    }

    /// How many times more the variance of a mean is than that of as many white samples: 1/(1 - sum of c_k)^2, of the same
    /// innovations.
    pub fn long_run_variance(&self) -> f64 {
        let sum: f64 = self.coefficients.iter().sum();
        self.innovation / (1.0 - sum).powi(2)
    }

    /// Noise becomes its innovations, e = A x; the first few, before which there is noise that is not known, are themselves.
    pub(super) fn innovations(&self, noise: &mut [f64]) {
        for i in (self.coefficients.len()..noise.len()).rev() {
            let before = self.coefficients.iter().enumerate();
            let sum: f64 = before.map(|(k, c)| c * noise[i - k - 1]).sum();
            noise[i] -= sum;
        }
    }

    /// A' times innovations, of which the first few are 0.
    pub(super) fn transposed(&self, innovations: &mut [f64]) {
        let n = innovations.len();
        for i in 0..n {
            let later = self.coefficients.iter().enumerate();
            let later = later.filter(|(k, _)| i + k + 1 < n);
            let sum: f64 = later.map(|(k, c)| c * innovations[i + k + 1]).sum();
            innovations[i] -= sum;
        }
    }

    /// J' W J, with the covariance W of this noise at as many samples as J has rows.
    ///
    /// W = s^2 A^-1 A'^-1 with the triangle A that takes the noise to its innovations; but for the first few samples, before which
    /// there are others.
    pub fn covariance_of(&self, jacobian: &DMatrix<f64>) -> DMatrix<f64> {
        let mut filtered = jacobian.clone();
        let n = filtered.nrows();
        for mut column in filtered.column_iter_mut() {
            for i in (0..n).rev() {
                let later = self.coefficients.iter().enumerate();
                let later = later.filter(|(k, _)| i + k + 1 < n);
                let sum: f64 = later.map(|(k, c)| c * column[i + k + 1]).sum();
                column[i] += sum;
            }
        }
        filtered.tr_mul(&filtered) * self.innovation
    }
}
