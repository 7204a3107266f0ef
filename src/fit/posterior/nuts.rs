//! The No-U-Turn sampler with a dense metric.
//!
//! Hoffman, M. D. and Gelman, A. (2014). The No-U-Turn sampler. J. Machine Learning Research 15, 1593-1623. Points of a trajectory are chosen by
//! their weights and turns are looked for across subtrees as by Betancourt, M. (2017). A conceptual introduction to Hamiltonian Monte Carlo.
//! arXiv:1701.02434.
//!
//! Our own: `vendor-notes/sampler.md`.

use crate::random::Random;
use nalgebra::{DMatrix, DVector};

/// How often, on average, a point of a trajectory is to be accepted.
const ACCEPTED: f64 = 0.85;
/// Doublings of a trajectory, at most.
const DEEPEST: usize = 10;
/// An energy that is off by so much is that of a trajectory which went astray.
const ASTRAY: f64 = 1000.0;

/// A logarithm of a density, which sets its gradient; -infinity where there is none.
pub(super) type LogDensity<'a> = &'a mut dyn FnMut(&DVector<f64>, &mut DVector<f64>) -> f64;

/// A chain of draws.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chain {
    /// One after the other.
    pub draws: Vec<DVector<f64>>,
    /// Trajectories that went astray.
    pub divergences: usize,
    /// How many times the density was computed, warm-up included.
    pub evaluations: usize,
}

/// A point in phase space.
#[derive(Clone)]
struct Point {
    at: DVector<f64>,
    momentum: DVector<f64>,
    gradient: DVector<f64>,
    log_density: f64,
}

impl Point {
    fn energy(&self) -> f64 {
        0.5 * self.momentum.norm_squared() - self.log_density
    }
}

/// A part of a trajectory.
struct Tree {
    first: Point,
    last: Point,
    chosen: Point,
    /// The logarithm of the sum of weights.
    log_weight: f64,
    /// The sum of momenta.
    momenta: DVector<f64>,
    /// Whether it goes on straight enough.
    goes_on: bool,
    accepted: f64,
    steps: usize,
    is_astray: bool,
}

/// The step size, as dual averaging adapts it.
struct StepSize {
    now: f64,
    averaged: f64,
    target: f64,
    sum: f64,
    count: f64,
}

impl StepSize {
    fn new(first: f64) -> Self {
        StepSize {
            now: first,
            averaged: first,
            target: (10.0 * first).ln(),
            sum: 0.0,
            count: 0.0,
        }
    }

    /// Nesterov's dual averaging with the constants of Hoffman and Gelman.
    fn learn(&mut self, accepted: f64) {
        const SHRINKAGE: f64 = 0.05;
        const DELAY: f64 = 10.0;
        const FORGETS: f64 = 0.75;
        self.count += 1.0;
        let part = 1.0 / (self.count + DELAY);
        self.sum = (1.0 - part) * self.sum + part * (ACCEPTED - accepted);
        let log = self.target - self.count.sqrt() / SHRINKAGE * self.sum;
        let weight = self.count.powf(-FORGETS);
        let averaged = weight * log + (1.0 - weight) * self.averaged.ln();
        (self.now, self.averaged) = (log.exp(), averaged.exp());
    }
}

/// A sampler in coordinates in which the metric is the identity: x = centre + root q.
pub(super) struct Sampler {
    random: Random,
    centre: DVector<f64>,
    root: DMatrix<f64>,
    evaluations: usize,
}

impl Sampler {
    /// With a covariance like that of the density, by its lower triangular root.
    pub fn new(seed: u64, chain: usize, centre: DVector<f64>, root: DMatrix<f64>) -> Self {
        Sampler {
            random: Random::new(seed, chain),
            centre,
            root,
            evaluations: 0,
        }
    }

    /// Standard normal numbers.
    pub fn normal(&mut self, count: usize) -> DVector<f64> {
        DVector::from_fn(count, |_, _| self.random.normal())
    }

    fn outward(&self, q: &DVector<f64>) -> DVector<f64> {
        &self.centre + &self.root * q
    }

    fn look(&mut self, density: LogDensity<'_>, at: DVector<f64>, momentum: DVector<f64>) -> Point {
        self.evaluations += 1;
        let mut gradient = DVector::zeros(at.len());
        let x = self.outward(&at);
        let log_density = density(&x, &mut gradient);
        let is_there = log_density.is_finite() && gradient.iter().all(|x| x.is_finite());
        Point {
            log_density: if is_there {
                log_density
            } else {
                f64::NEG_INFINITY
            },
            gradient: self.root.tr_mul(&gradient),
            at,
            momentum,
        }
    }

    /// A step of the leapfrog method.
    fn leap(&mut self, density: LogDensity<'_>, from: &Point, step: f64) -> Point {
        let half = &from.momentum + &from.gradient * (0.5 * step);
        let at = &from.at + &half * step;
        let mut there = self.look(density, at, half);
        if there.log_density.is_finite() {
            there.momentum += &there.gradient * (0.5 * step);
        }
        there
    }

    /// Draws after a warm-up that finds the metric and the step size.
    ///
    /// `start` is where it begins; `progress` is asked after each draw whether to go on.
    pub fn run(
        mut self,
        density: LogDensity<'_>,
        start: &DVector<f64>,
        (warm_up, draws): (usize, usize),
        go_on: &dyn Fn() -> bool,
    ) -> Option<Chain> {
        let count = start.len();
        let begin = |sampler: &Sampler, x: &DVector<f64>| {
            let rest = x - &sampler.centre;
            sampler.root.solve_lower_triangular(&rest)
        };
        let at = begin(&self, start)?;
        let mut here = self.look(density, at, DVector::zeros(count));
        if !here.log_density.is_finite() {
            return None;
        }
        let mut step = StepSize::new(self.first_step(density, &here));
        // The metric is learned from the middle of the warm-up.
        let (from, until) = (warm_up / 4, 3 * warm_up / 4);
        let mut seen: Vec<DVector<f64>> = Vec::with_capacity(until - from);
        let mut kept = Vec::with_capacity(draws);
        let mut divergences = 0;
        for turn in 0..warm_up + draws {
            if !go_on() {
                return None;
            }
            let is_warm = turn >= warm_up;
            let size = if is_warm { step.averaged } else { step.now };
            let (next, accepted, is_astray) = self.draw(density, here, size);
            here = next;
            if is_warm {
                divergences += usize::from(is_astray);
                kept.push(self.outward(&here.at));
                continue;
            }
            step.learn(accepted);
            if (from..until).contains(&turn) {
                seen.push(self.outward(&here.at));
            }
            if turn + 1 == until {
                let x = self.outward(&here.at);
                self.learn(&seen);
                let at = begin(&self, &x)?;
                here = self.look(density, at, DVector::zeros(count));
                step = StepSize::new(self.first_step(density, &here));
            }
        }
        Some(Chain {
            draws: kept,
            divergences,
            evaluations: self.evaluations,
        })
    }

    /// The metric of draws: their covariance, drawn towards the one before where they are few.
    fn learn(&mut self, seen: &[DVector<f64>]) {
        /// So many draws does the metric before count as, for each variable.
        const BEFORE: f64 = 5.0;
        let n = seen.len() as f64;
        let size = self.centre.len();
        let mean = seen.iter().fold(DVector::zeros(size), |all, x| all + x) / n;
        let square = seen.iter().fold(DMatrix::zeros(size, size), |all, x| {
            let off = x - &mean;
            all + &off * off.transpose()
        });
        let weight = BEFORE * size as f64;
        let before = &self.root * self.root.transpose();
        let covariance = (square + before * weight) / (n + weight);
        if let Some(root) = covariance.cholesky() {
            self.centre = mean;
            self.root = root.unpack();
        }
    }

    /// A step that is accepted about half of the time.
    fn first_step(&mut self, density: LogDensity<'_>, here: &Point) -> f64 {
        let mut from = here.clone();
        from.momentum = self.normal(here.at.len());
        let energy = from.energy();
        let mut gains = |sampler: &mut Self, step: f64| {
            let there = sampler.leap(density, &from, step);
            let gain = energy - there.energy();
            if gain.is_nan() {
                f64::NEG_INFINITY
            } else {
                gain
            }
        };
        let half = 0.5_f64.ln();
        let mut step = 0.5;
        let grows = gains(self, step) > half;
        for _ in 0..50 {
            let next = if grows { 2.0 * step } else { 0.5 * step };
            let is_beyond = (gains(self, next) > half) != grows;
            if is_beyond && grows {
                break;
            }
            step = next;
            if is_beyond {
                break;
            }
        }
        step
    }

    /// The next point of the chain, how much of its trajectory was accepted, and whether that went astray.
    fn draw(&mut self, density: LogDensity<'_>, mut here: Point, step: f64) -> (Point, f64, bool) {
        here.momentum = self.normal(here.at.len());
        let energy = here.energy();
        let mut tree = Tree {
            first: here.clone(),
            last: here.clone(),
            momenta: here.momentum.clone(),
            chosen: here,
            log_weight: 0.0,
            goes_on: true,
            accepted: 0.0,
            steps: 0,
            is_astray: false,
        };
        for depth in 0..DEEPEST {
            let is_forward = self.random.uniform() < 0.5;
            let direction = if is_forward { step } else { -step };
            let end = if is_forward { &tree.last } else { &tree.first };
            let end = end.clone();
            let other = self.grow(density, &end, (direction, depth), energy);
            tree.steps += other.steps;
            tree.accepted += other.accepted;
            tree.is_astray |= other.is_astray;
            if !other.goes_on {
                break;
            }
            // Biased towards the new half (Betancourt 2017, A.3.2).
            if self.random.uniform().ln() < other.log_weight - tree.log_weight {
                tree.chosen = other.chosen.clone();
            }
            tree = join(tree, other, is_forward, None);
            if !tree.goes_on {
                break;
            }
        }
        let accepted = tree.accepted / (tree.steps as f64).max(1.0);
        (tree.chosen, accepted, tree.is_astray)
    }

    /// A tree of 2^depth steps from a point on.
    fn grow(
        &mut self,
        density: LogDensity<'_>,
        from: &Point,
        (step, depth): (f64, usize),
        energy: f64,
    ) -> Tree {
        if depth == 0 {
            let there = self.leap(density, from, step);
            let gain = energy - there.energy();
            let gain = if gain.is_nan() {
                f64::NEG_INFINITY
            } else {
                gain
            };
            return Tree {
                first: there.clone(),
                last: there.clone(),
                momenta: there.momentum.clone(),
                chosen: there,
                log_weight: gain,
                goes_on: gain > -ASTRAY,
                accepted: gain.min(0.0).exp(),
                steps: 1,
                is_astray: gain <= -ASTRAY,
            };
        }
        let mut near = self.grow(density, from, (step, depth - 1), energy);
        if !near.goes_on {
            return near;
        }
        let is_forward = step > 0.0;
        let end = if is_forward { &near.last } else { &near.first };
        let end = end.clone();
        let far = self.grow(density, &end, (step, depth - 1), energy);
        near.steps += far.steps;
        near.accepted += far.accepted;
        near.is_astray |= far.is_astray;
        if !far.goes_on {
            near.goes_on = false;
            return near;
        }
        let chance = self.random.uniform();
        join(near, far, is_forward, Some(chance))
    }
}

/// Two neighbouring trees as one; of the points that they have chosen the other's takes the place with its share of the weight, where `chance`
/// decides.
fn join(tree: Tree, other: Tree, is_forward: bool, chance: Option<f64>) -> Tree {
    let log_weight = log_sum(tree.log_weight, other.log_weight);
    let takes_other = chance.is_some_and(|chance| chance.ln() < other.log_weight - log_weight);
    let chosen = if takes_other {
        other.chosen
    } else {
        tree.chosen
    };
    let (left, right) = if is_forward {
        (
            (tree.first, tree.last, tree.momenta),
            (other.first, other.last, other.momenta),
        )
    } else {
        (
            (other.first, other.last, other.momenta),
            (tree.first, tree.last, tree.momenta),
        )
    };
    let momenta = &left.2 + &right.2;
    // Also from each half to the first point of the other one.
    let straight = |sum: &DVector<f64>, first: &Point, last: &Point| {
        sum.dot(&first.momentum) > 0.0 && sum.dot(&last.momentum) > 0.0
    };
    let to_right = &left.2 + &right.0.momentum;
    let to_left = &right.2 + &left.1.momentum;
    let goes_on = straight(&momenta, &left.0, &right.1)
        && straight(&to_right, &left.0, &right.0)
        && straight(&to_left, &left.1, &right.1);
    Tree {
        first: left.0,
        last: right.1,
        chosen,
        log_weight,
        momenta,
        goes_on,
        steps: tree.steps,
        accepted: tree.accepted,
        is_astray: tree.is_astray,
    }
}

fn log_sum(one: f64, other: f64) -> f64 {
    let most = one.max(other);
    if most == f64::NEG_INFINITY {
        return most;
    }
    most + ((one - most).exp() + (other - most).exp()).ln()
}
