//! Eight interfaces side by side: their power series, coefficient by coefficient.

use pulp::NullaryFnOnce;
#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V4};

/// Interfaces in a block.
pub(super) const LANES: usize = 8;
/// A number of each.
pub(super) type Lanes = [f64; LANES];
/// The highest order of the series.
pub(super) const MOST: usize = 20;

/// What the interfaces of a block are: v = s(tau) gamma (x)^(-beta), x = a_0 + a_1 psi, dpsi/dt = g_0 + g_1 psi - |v| psi / l.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Constants {
    /// beta
    pub beta: Lanes,
    /// gamma0, or half of it where the direct effect is exponential; 0 where there is no interface.
    pub factor: Lanes,
    /// a_0
    pub rest: Lanes,
    /// a_1
    pub slope: Lanes,
    /// g_0
    pub source: Lanes,
    /// g_1
    pub relaxation: Lanes,
    /// 1/l
    pub per_length: Lanes,
}

/// The series of eight interfaces. The strength x stands for the state, which it is linear in.
#[derive(Debug, Clone)]
pub(super) struct Block {
    /// x
    pub strength: [Lanes; MOST + 1],
    /// gamma x^(-beta)
    compliance: [Lanes; MOST],
    /// v
    pub rate: [Lanes; MOST],
}

impl Block {
    pub fn at(strength: Lanes) -> Self {
        let mut block = Block {
            strength: [[0.0; LANES]; MOST + 1],
            compliance: [[0.0; LANES]; MOST],
            rate: [[0.0; LANES]; MOST],
        };
        block.strength[0] = strength;
        block
    }

    /// psi at the beginning of the step.
    pub fn state(&self, constants: &Constants, lane: usize) -> f64 {
        (self.strength[0][lane] - constants.rest[lane]) / constants.slope[lane]
    }

    /// The k-th coefficients of the slip rates, and the next ones of the strengths, in this unit of time. `activation` has the series of
    /// s(tau) to this order.
    #[inline(always)]
    fn order(&mut self, of: &Constants, activation: &[f64; MOST], k: usize, unit: f64) -> Lanes {
        let first = self.strength[0];
        let mut u = [0.0; LANES];
        if k == 0 {
            for l in 0..LANES {
                u[l] = of.factor[l] * first[l].powf(-of.beta[l]);
            }
        } else {
            // x u' = -beta x' u
            for j in 1..=k {
                let (x, y) = (&self.strength[j], &self.compliance[k - j]);
                let (taken, left) = (j as f64, (k - j) as f64);
                for l in 0..LANES {
                    u[l] += (of.beta[l] * taken + left) * x[l] * y[l];
                }
            }
            let by = -1.0 / k as f64;
            for l in 0..LANES {
                u[l] = u[l] * by / first[l];
            }
        }
        self.compliance[k] = u;
        let mut v = [0.0; LANES];
        let compliances = self.compliance[..=k].iter().rev();
        for (s, u) in activation.iter().zip(compliances) {
            for l in 0..LANES {
                v[l] += s * u[l];
            }
        }
        self.rate[k] = v;
        let mut product = [0.0; LANES];
        for j in 0..=k {
            let (v, x) = (&self.rate[j], &self.strength[k - j]);
            for l in 0..LANES {
                product[l] += v[l] * x[l];
            }
        }
        let by = unit / (k + 1) as f64;
        let constant = if k == 0 { 1.0 } else { 0.0 };
        let here = self.strength[k];
        let next = &mut self.strength[k + 1];
        for l in 0..LANES {
            let source = of.slope[l] * of.source[l] - of.relaxation[l] * of.rest[l];
            let worn = of.per_length[l] * (product[l] - of.rest[l] * v[l]);
            next[l] = by * (constant * source + of.relaxation[l] * here[l] - worn);
        }
        v
    }

    /// The strengths so many units later.
    #[inline(always)]
    fn strengths(&self, order: usize, later: f64) -> Lanes {
        let mut sum = self.strength[order];
        for term in self.strength[..order].iter().rev() {
            for l in 0..LANES {
                sum[l] = sum[l] * later + term[l];
            }
        }
        sum
    }
}

/// The k-th coefficients of the slip rates of some blocks, added up.
pub(super) struct NextOrder<'a> {
    pub blocks: &'a mut [Block],
    pub constants: &'a [Constants],
    pub activation: &'a [f64; MOST],
    pub k: usize,
    pub unit: f64,
}

impl NullaryFnOnce for NextOrder<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        let mut sum = [0.0; LANES];
        for (i, block) in self.blocks.iter_mut().enumerate() {
            let constants = of(self.constants, i);
            let v = block.order(constants, self.activation, self.k, self.unit);
            for l in 0..LANES {
                sum[l] += v[l];
            }
        }
        sum.iter().sum()
    }
}

/// The largest of the last two coefficients over the first, of all strengths; that before the last of the slip rates too, which are known
/// to one order less, and of which slips are made.
pub(super) struct LastTerms<'a> {
    pub blocks: &'a [Block],
    pub order: usize,
}

impl NullaryFnOnce for LastTerms<'_> {
    type Output = [f64; 2];

    #[inline(always)]
    fn call(self) -> [f64; 2] {
        let mut most = [[0.0_f64; LANES]; 2];
        for block in self.blocks {
            let last = [&block.strength[self.order], &block.strength[0]];
            let before = [&block.strength[self.order - 1], &block.strength[0]];
            let rates = [&block.rate[self.order - 1], &block.rate[0]];
            for (i, [term, first]) in [(0, last), (1, before), (1, rates)] {
                for l in 0..LANES {
                    let ratio = (term[l] / first[l]).abs();
                    // What is not a number is to be seen; but nothing slides where there is no interface.
                    let unknown = ratio.is_nan() && first[l] != 0.0;
                    if ratio > most[i][l] || unknown {
                        most[i][l] = ratio;
                    }
                }
            }
        }
        most.map(|lanes| lanes.into_iter().fold(0.0, larger))
    }
}

/// The larger one, or what is not a number.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// Goes so many units on.
pub(super) struct Advance<'a> {
    pub blocks: &'a mut [Block],
    pub order: usize,
    pub by: f64,
}

impl NullaryFnOnce for Advance<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for block in self.blocks {
            block.strength[0] = block.strengths(self.order, self.by);
        }
    }
}

/// What is summed up of the states and slip rates at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Least and greatest psi.
    pub state: [f64; 2],
    /// The sum of all slip rates.
    pub slip_rate: f64,
    /// The greatest.
    pub slip_rate_max: f64,
    /// How many interfaces slide faster than a given rate.
    pub sliding: usize,
}

impl Extent {
    /// Of no interface.
    pub const NONE: Extent = Extent {
        state: [f64::INFINITY, f64::NEG_INFINITY],
        slip_rate: 0.0,
        slip_rate_max: 0.0,
        sliding: 0,
    };

    /// Of both.
    pub(super) fn and(self, other: Extent) -> Extent {
        Extent {
            state: [
                self.state[0].min(other.state[0]),
                self.state[1].max(other.state[1]),
            ],
            slip_rate: self.slip_rate + other.slip_rate,
            slip_rate_max: self.slip_rate_max.max(other.slip_rate_max),
            sliding: self.sliding + other.sliding,
        }
    }
}

/// What some blocks do so many units after the beginning of a step, at which time s(tau) is `activation`.
pub(super) struct Look<'a> {
    pub blocks: &'a [Block],
    pub constants: &'a [Constants],
    pub order: usize,
    pub later: f64,
    pub activation: f64,
    pub faster_than: f64,
}

impl NullaryFnOnce for Look<'_> {
    type Output = Extent;

    #[inline(always)]
    fn call(self) -> Extent {
        let mut extent = Extent::NONE;
        for (i, block) in self.blocks.iter().enumerate() {
            let of = of(self.constants, i);
            let strength = block.strengths(self.order, self.later);
            for l in (0..LANES).filter(|&l| of.factor[l] > 0.0) {
                let psi = (strength[l] - of.rest[l]) / of.slope[l];
                let v = self.activation * of.factor[l] * strength[l].powf(-of.beta[l]);
                extent = extent.and(Extent {
                    state: [psi; 2],
                    slip_rate: v,
                    slip_rate_max: v,
                    sliding: usize::from(v > self.faster_than),
                });
            }
        }
        extent
    }
}

/// The constants of the i-th block: one for all, or each its own.
#[inline(always)]
pub(super) fn of(all: &[Constants], i: usize) -> &Constants {
    match all {
        [only] => only,
        _ => &all[i],
    }
}

/// Runs something with the vectors that the processor has and the user allows. The operations, and so all digits, are the same.
pub(super) fn vectorised<F: NullaryFnOnce>(work: F) -> F::Output {
    #[cfg(target_arch = "x86_64")]
    {
        use crate::series::{Vectors, used_vectors};
        let used = used_vectors();
        if used == Vectors::Avx512
            && let Some(simd) = V4::try_new()
        {
            return simd.vectorize(work);
        }
        if used >= Vectors::Avx2
            && let Some(simd) = V3::try_new()
        {
            return simd.vectorize(work);
        }
    }
    work.call()
}
