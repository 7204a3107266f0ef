//! Eight interfaces side by side: their power series, coefficient by coefficient.

use super::constants::{Constants, Kind, LANES, Lanes, of};
use super::local::{Stress, balanced};
use super::vectors::Vectorised;
use pulp::NullaryFnOnce;

/// The highest order of the series.
pub(super) const MOST: usize = 20;

/// How many rows of numbers a block has: one for every coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    pub order: usize,
    pub kind: Kind,
}

impl Layout {
    /// Rows of a block.
    pub fn rows(self) -> usize {
        let own = if self.kind.own_stress { 2 } else { 0 };
        let logs = usize::from(self.kind.slip);
        1 + (3 + own + logs) * self.order
    }

    /// The rows of a block by what they are.
    #[inline(always)]
    fn of(self, rows: &mut [Lanes]) -> Series<'_> {
        let (strength, rows) = rows.split_at_mut(self.order + 1);
        let (compliance, rows) = rows.split_at_mut(self.order);
        let (rate, rows) = rows.split_at_mut(self.order);
        let own = if self.kind.own_stress { self.order } else { 0 };
        let (sinh, rows) = rows.split_at_mut(own);
        let (cosh, log) = rows.split_at_mut(own);
        Series {
            strength,
            compliance,
            rate,
            sinh,
            cosh,
            log,
        }
    }

    /// x, or ln psi where the slip law holds.
    #[inline(always)]
    pub fn strength(self, rows: &[Lanes]) -> &[Lanes] {
        &rows[..=self.order]
    }

    /// v
    #[inline(always)]
    pub fn rate(self, rows: &[Lanes]) -> &[Lanes] {
        &rows[2 * self.order + 1..][..self.order]
    }
}

/// The series of eight interfaces. The strength x stands for the state, which it is linear in; ln psi where the slip law holds.
struct Series<'a> {
    /// x
    strength: &'a mut [Lanes],
    /// f x^(-beta)
    compliance: &'a mut [Lanes],
    /// v
    rate: &'a mut [Lanes],
    /// sinh z, or e^z, of z = q (tau - eta v)
    sinh: &'a mut [Lanes],
    /// cosh z
    cosh: &'a mut [Lanes],
    /// ln(v psi / l)
    log: &'a mut [Lanes],
}

/// What all interfaces share: the series of tau, and of s(tau) where it is the same for all.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shared<'a> {
    pub stress: &'a [f64; MOST + 1],
    pub activation: &'a [f64; MOST],
    pub unit: f64,
}

impl Series<'_> {
    /// The k-th coefficients of the slip rates, and the next ones of the strengths, in this unit of time.
    #[inline(always)]
    fn order<const OWN: bool, const SLIP: bool>(
        &mut self,
        of: &Constants,
        shared: Shared<'_>,
        (exponential, k): (bool, usize),
    ) -> Lanes {
        let u = self.next_compliance::<SLIP>(of, k);
        self.compliance[k] = u;
        let v = if OWN {
            self.next_own_rate(of, shared, exponential, k)
        } else {
            let mut v = [0.0; LANES];
            let compliances = self.compliance[..=k].iter().rev();
            for (s, u) in shared.activation.iter().zip(compliances) {
                for l in 0..LANES {
                    v[l] += s * u[l];
                }
            }
            v
        };
        self.rate[k] = v;
        let by = shared.unit / (k + 1) as f64;
        if SLIP {
            self.next_log(of, k);
        }
        let mut product = [0.0; LANES];
        for j in 0..=k {
            let other = if SLIP {
                &self.log[k - j]
            } else {
                &self.strength[k - j]
            };
            for l in 0..LANES {
                product[l] += self.rate[j][l] * other[l];
            }
        }
        let constant = if k == 0 { 1.0 } else { 0.0 };
        let here = self.strength[k];
        let next = &mut self.strength[k + 1];
        for l in 0..LANES {
            next[l] = if SLIP {
                -by * of.per_length[l] * product[l]
            } else {
                let source = of.slope[l] * of.source[l] - of.relaxation[l] * of.rest[l];
                let worn = of.per_length[l] * (product[l] - of.rest[l] * v[l]);
                by * (constant * source + of.relaxation[l] * here[l] - worn)
            };
        }
        v
    }

    /// Of f x^(-beta): x u' = -beta x' u, or u' = -beta w' u.
    #[inline(always)]
    fn next_compliance<const SLIP: bool>(&self, of: &Constants, k: usize) -> Lanes {
        let first = self.strength[0];
        let mut u = [0.0; LANES];
        if k == 0 {
            for l in 0..LANES {
                let weakness = if SLIP {
                    (-of.beta[l] * first[l]).exp()
                } else {
                    first[l].powf(-of.beta[l])
                };
                u[l] = of.factor[l] * weakness;
            }
            return u;
        }
        for j in 1..=k {
            let (x, y) = (&self.strength[j], &self.compliance[k - j]);
            let (taken, left) = (j as f64, (k - j) as f64);
            for l in 0..LANES {
                let weight = if SLIP {
                    of.beta[l] * taken
                } else {
                    of.beta[l] * taken + left
                };
                u[l] += weight * x[l] * y[l];
            }
        }
        let by = -1.0 / k as f64;
        for l in 0..LANES {
            u[l] = if SLIP {
                u[l] * by
            } else {
                u[l] * by / first[l]
            };
        }
        u
    }

    /// Of v = u s(z), z = q (tau - eta v): an equation at order 0, and at each order after it a linear one in the newest coefficient.
    #[inline(always)]
    fn next_own_rate(
        &mut self,
        of: &Constants,
        shared: Shared<'_>,
        exponential: bool,
        k: usize,
    ) -> Lanes {
        let first = self.compliance[0];
        if k == 0 {
            let mut z = [0.0; LANES];
            for l in 0..LANES {
                let stress = of.stress_factor[l] * shared.stress[0];
                z[l] = balanced(exponential, of.damping[l] * first[l], stress);
            }
            let (mut s, mut c) = ([0.0; LANES], [0.0; LANES]);
            for l in 0..LANES {
                (s[l], c[l]) = match exponential {
                    true => (z[l].exp(), z[l].exp()),
                    false => (z[l].sinh(), z[l].cosh()),
                };
            }
            (self.sinh[0], self.cosh[0]) = (s, c);
            let mut v = [0.0; LANES];
            for l in 0..LANES {
                v[l] = first[l] * s[l];
            }
            return v;
        }
        // j z_j of what is known
        let ramp = |rate: &[Lanes], j: usize, l: usize| {
            j as f64 * (of.stress_factor[l] * shared.stress[j] - of.damping[l] * rate[j][l])
        };
        let (mut known, mut slope, mut sum) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for j in 1..k {
            let (s, c) = (&self.sinh[k - j], &self.cosh[k - j]);
            let u = &self.compliance[j];
            for l in 0..LANES {
                let z = ramp(self.rate, j, l);
                known[l] += z * c[l];
                slope[l] += z * s[l];
                sum[l] += s[l] * u[l];
            }
        }
        let (s, c, u) = (self.sinh[0], self.cosh[0], self.compliance[k]);
        let by = 1.0 / k as f64;
        let (mut v, mut sinh, mut cosh) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for l in 0..LANES {
            let driven = of.stress_factor[l] * shared.stress[k];
            let rest = sum[l] + s[l] * u[l];
            let stiff = first[l] * c[l];
            v[l] =
                (rest + first[l] * by * known[l] + stiff * driven) / (1.0 + stiff * of.damping[l]);
            let z = driven - of.damping[l] * v[l];
            sinh[l] = by * known[l] + c[l] * z;
            cosh[l] = by * slope[l] + s[l] * z;
        }
        self.sinh[k] = sinh;
        self.cosh[k] = if exponential { sinh } else { cosh };
        v
    }

    /// Of ln(v psi / l): v (ln v)' = v'.
    #[inline(always)]
    fn next_log(&mut self, of: &Constants, k: usize) {
        let (v, w) = (self.rate[k], self.strength[k]);
        let first = self.rate[0];
        let mut log = [0.0; LANES];
        if k == 0 {
            for l in 0..LANES {
                log[l] = (v[l] * of.per_length[l]).ln() + w[l];
            }
        } else {
            let mut sum = [0.0; LANES];
            for j in 1..k {
                let (rate, strength, log) = (&self.rate[k - j], &self.strength[j], &self.log[j]);
                for l in 0..LANES {
                    sum[l] += j as f64 * (log[l] - strength[l]) * rate[l];
                }
            }
            for l in 0..LANES {
                log[l] = (v[l] - sum[l] / k as f64) / first[l] + w[l];
            }
        }
        for (log, factor) in log.iter_mut().zip(of.factor) {
            // nothing slides where there is no interface
            *log = if factor == 0.0 { 0.0 } else { *log };
        }
        self.log[k] = log;
    }
}

/// The strengths so many units later.
#[inline(always)]
fn strengths(series: &[Lanes], later: f64) -> Lanes {
    let (last, before) = series.split_last().expect("one coefficient");
    let mut sum = *last;
    for term in before.iter().rev() {
        for l in 0..LANES {
            sum[l] = sum[l] * later + term[l];
        }
    }
    sum
}

/// The k-th coefficients of the slip rates of some blocks, added up.
pub(super) struct NextOrder<'a> {
    pub blocks: &'a mut [Lanes],
    pub layout: Layout,
    pub constants: &'a [Constants],
    pub shared: Shared<'a>,
    pub k: usize,
}

impl NextOrder<'_> {
    #[inline(always)]
    fn sum<const OWN: bool, const SLIP: bool>(self) -> f64 {
        let mut sum = [0.0; LANES];
        let layout = self.layout;
        let at = (layout.kind.exponential, self.k);
        for (i, rows) in self.blocks.chunks_exact_mut(layout.rows()).enumerate() {
            let constants = of(self.constants, i);
            let v = layout
                .of(rows)
                .order::<OWN, SLIP>(constants, self.shared, at);
            for l in 0..LANES {
                sum[l] += v[l];
            }
        }
        sum.iter().sum()
    }
}

impl Vectorised for NextOrder<'_> {}

impl NullaryFnOnce for NextOrder<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        match (self.layout.kind.own_stress, self.layout.kind.slip) {
            (false, false) => self.sum::<false, false>(),
            (true, false) => self.sum::<true, false>(),
            (false, true) => self.sum::<false, true>(),
            (true, true) => self.sum::<true, true>(),
        }
    }
}

/// The largest of the last two coefficients over the first, of all strengths; that before the last of the slip rates too, which are known
/// to one order less, and of which slips are made. Of ln psi it is the coefficients themselves.
pub(super) struct LastTerms<'a> {
    pub blocks: &'a [Lanes],
    pub layout: Layout,
}

impl Vectorised for LastTerms<'_> {}

impl NullaryFnOnce for LastTerms<'_> {
    type Output = [f64; 2];

    #[inline(always)]
    fn call(self) -> [f64; 2] {
        let mut most = [[0.0_f64; LANES]; 2];
        let order = self.layout.order;
        let one = [1.0; LANES];
        for rows in self.blocks.chunks_exact(self.layout.rows()) {
            let (strength, rate) = (self.layout.strength(rows), self.layout.rate(rows));
            let size = if self.layout.kind.slip {
                &one
            } else {
                &strength[0]
            };
            let last = [&strength[order], size];
            let before = [&strength[order - 1], size];
            let rates = [&rate[order - 1], &rate[0]];
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
    pub blocks: &'a mut [Lanes],
    pub layout: Layout,
    pub by: f64,
}

impl Vectorised for Advance<'_> {}

impl NullaryFnOnce for Advance<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for rows in self.blocks.chunks_exact_mut(self.layout.rows()) {
            rows[0] = strengths(self.layout.strength(rows), self.by);
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

    /// Of one interface.
    pub(super) fn of_one(psi: f64, v: f64, faster_than: f64) -> Self {
        Extent {
            state: [psi; 2],
            slip_rate: v,
            slip_rate_max: v,
            sliding: usize::from(v > faster_than),
        }
    }

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

/// What some blocks do so many units after the beginning of a step, at which time there is this stress.
pub(super) struct Look<'a> {
    pub blocks: &'a [Lanes],
    pub layout: Layout,
    pub constants: &'a [Constants],
    pub later: f64,
    pub stress: f64,
    pub faster_than: f64,
}

impl Vectorised for Look<'_> {}

impl NullaryFnOnce for Look<'_> {
    type Output = Extent;

    #[inline(always)]
    fn call(self) -> Extent {
        let mut extent = Extent::NONE;
        let Layout { kind, .. } = self.layout;
        let stress = Stress::new(kind, self.stress);
        for (i, rows) in self.blocks.chunks_exact(self.layout.rows()).enumerate() {
            let of = of(self.constants, i);
            let strength = strengths(self.layout.strength(rows), self.later);
            for l in (0..LANES).filter(|&l| of.factor[l] > 0.0) {
                let psi = of.state(kind, strength[l], l);
                let v = of.slip_rate(kind, l, (stress, strength[l]));
                extent = extent.and(Extent::of_one(psi, v, self.faster_than));
            }
        }
        extent
    }
}

/// psi and v of one lane of a block, so many units after the beginning of a step.
pub(super) fn look_at(
    (rows, layout): (&[Lanes], Layout),
    (of, lane): (&Constants, usize),
    (later, stress): (f64, f64),
) -> [f64; 2] {
    let terms = layout.strength(rows).iter().rev();
    let strength = terms.fold(0.0, |sum, term| sum * later + term[lane]);
    let kind = layout.kind;
    let v = of.slip_rate(kind, lane, (Stress::new(kind, stress), strength));
    [of.state(kind, strength, lane), v]
}
