//! A record as few points: where friction changes slowly, samples say the same as polynomials through some of them.
//!
//! Friction near a minimum is that of the minimum and a smooth difference. The difference is interpolated between nodes, which are samples, so
//! that the sum of squares of all innovations is a quadratic form in its values there, made once. A draw then costs the same for a thousand
//! samples as for a million.

use super::super::noise::Autoregression;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Nodes of an element.
const NODES: usize = 9;
/// An element of fewer samples takes them all.
const FEW: usize = 2 * NODES;
/// With more nodes the quadratic form costs more than it spares: its making grows with their square.
const MOST: usize = 500;

/// What a record says of differences of friction from that of the minimum.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Compressed {
    /// The samples at which friction is computed.
    pub nodes: Vec<usize>,
    /// The sum of squares of innovations at the minimum.
    least: f64,
    /// Of the differences at the nodes, and of the slope of a straight line: half of what the sum loses per unit.
    linear: DVector<f64>,
    /// And what it gains by their squares.
    quadratic: DMatrix<f64>,
}

impl Compressed {
    /// With the noise, residuals at the minimum as they count, the roots of the weights, and the times of the samples, which ascend. `shapes` are differences that occur, in standard
    /// deviations of the noise, of which none may be off by more than `tolerance` in the root of the sum of squares; `stretches` are samples
    /// between which friction is smooth. `straight` is what the straight line's slope is multiplied by at each sample. None where that takes
    /// more than [`MOST`] nodes, or more than half of the samples.
    pub fn new(
        (noise, residuals, weights, times): (&Autoregression, &[f64], &[f64], &[f64]),
        straight: &[f64],
        stretches: &[Range<usize>],
        (shapes, tolerance): (&DMatrix<f64>, f64),
    ) -> Option<Self> {
        let count = residuals.len();
        let mut elements = Vec::new();
        for stretch in stretches {
            divide(stretch.clone(), times, (shapes, tolerance), &mut elements);
        }
        let nodes: Vec<usize> = elements.iter().flat_map(|one| one.nodes.clone()).collect();
        if nodes.len() > MOST.min(count / 2) {
            return None;
        }
        // All columns as they count, without the noise's memory.
        let mut columns = DMatrix::zeros(count, nodes.len() + 1);
        let mut begun = 0;
        for element in &elements {
            for row in element.samples.clone() {
                for (k, by) in element.weights_at(row).into_iter().enumerate() {
                    columns[(row, begun + k)] = by * weights[row];
                }
            }
            begun += element.nodes.len();
        }
        for row in 0..count {
            columns[(row, begun)] = straight[row] * weights[row];
        }
        for mut column in columns.column_iter_mut() {
            noise.innovations(column.as_mut_slice());
        }
        let mut innovations = DVector::from_column_slice(residuals);
        noise.innovations(innovations.as_mut_slice());
        let known = noise.coefficients.len();
        let columns = columns.rows(known, count - known);
        let innovations = innovations.rows(known, count - known);
        Some(Compressed {
            nodes,
            least: innovations.norm_squared(),
            linear: columns.tr_mul(&innovations),
            quadratic: columns.tr_mul(&columns),
        })
    }

    /// The sum of squares of innovations where the friction differs by so much at the nodes, with the difference of the slope behind; and its
    /// derivatives in them.
    pub fn squares(&self, differences: &DVector<f64>) -> (f64, DVector<f64>) {
        let curved = &self.quadratic * differences;
        let squares = self.least - 2.0 * self.linear.dot(differences) + curved.dot(differences);
        (squares, (curved - &self.linear) * 2.0)
    }
}

/// Samples between which differences are polynomials in time: clocks tick unevenly.
struct Element<'a> {
    times: &'a [f64],
    samples: Range<usize>,
    nodes: Vec<usize>,
    /// The barycentric weights of the nodes; none where every sample is one.
    barycentric: Vec<f64>,
}

impl<'a> Element<'a> {
    fn new(samples: Range<usize>, times: &'a [f64]) -> Self {
        if samples.len() <= FEW {
            return Element {
                nodes: samples.clone().collect(),
                times,
                samples,
                barycentric: Vec::new(),
            };
        }
        // The samples nearest to Chebyshev's points.
        let last = (samples.len() - 1) as f64;
        let place = |k: usize| {
            let angle = std::f64::consts::PI * k as f64 / (NODES - 1) as f64;
            samples.start + (0.5 * last * (1.0 - angle.cos())).round() as usize
        };
        let nodes: Vec<usize> = (0..NODES).map(place).collect();
        let lasts = times[samples.end - 1] - times[samples.start];
        let weight = |k: usize| {
            let others = (0..NODES).filter(|&j| j != k);
            let product: f64 = others
                .map(|j| (times[nodes[k]] - times[nodes[j]]) / lasts)
                .product();
            1.0 / product
        };
        let barycentric = (0..NODES).map(weight).collect();
        Element {
            times,
            samples,
            nodes,
            barycentric,
        }
    }

    /// By what the values at the nodes are multiplied for that at a sample.
    fn weights_at(&self, row: usize) -> Vec<f64> {
        if let Some(own) = self.nodes.iter().position(|&node| node == row) {
            let mut weights = vec![0.0; self.nodes.len()];
            weights[own] = 1.0;
            return weights;
        }
        let pairs = self.nodes.iter().zip(&self.barycentric);
        let terms: Vec<f64> = pairs
            .map(|(&node, by)| by / (self.times[row] - self.times[node]))
            .collect();
        let sum: f64 = terms.iter().sum();
        terms.into_iter().map(|term| term / sum).collect()
    }
}

/// Elements of a stretch in which no shape is off by its share of the tolerance.
fn divide<'a>(
    samples: Range<usize>,
    times: &'a [f64],
    (shapes, tolerance): (&DMatrix<f64>, f64),
    elements: &mut Vec<Element<'a>>,
) {
    let element = Element::new(samples.clone(), times);
    let share = tolerance.powi(2) * samples.len() as f64 / shapes.nrows() as f64;
    let mut off = DVector::<f64>::zeros(shapes.ncols());
    if !element.barycentric.is_empty() {
        for row in samples.clone() {
            let weights = element.weights_at(row);
            for (j, off) in off.iter_mut().enumerate() {
                let nodes = element.nodes.iter().zip(&weights);
                let made: f64 = nodes.map(|(&node, by)| by * shapes[(node, j)]).sum();
                *off += (made - shapes[(row, j)]).powi(2);
            }
        }
    }
    if off.amax() <= share {
        elements.push(element);
        return;
    }
    let middle = samples.start + samples.len() / 2;
    for half in [samples.start..middle, middle..samples.end] {
        divide(half, times, (shapes, tolerance), elements);
    }
}
