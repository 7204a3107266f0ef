//! The recurrences of [`super::ageing_series`] for trajectories side by side, one in every lane.
//!
//! Here no coefficient waits for its neighbours: the sums are those of the formulas as they stand, by interface, those of several
//! orders at once.

use super::ageing_series::NEAR;
use super::in_states::{InStates, PSI, SLIP_RATES, TAU, Trajectories};
use crate::friction::AgeingForm;
use crate::series::{Element, LaneFormula, ONE_OVER, ROOM, Recurrences};
use std::cell::Cell;

pub(super) struct AgeingLanes<E: Element> {
    /// The series that the sums are made of, of each interface.
    factors: [Factors<E>; 2],
    /// The formula, once it was needed.
    recorded: Option<Box<LaneFormula<E>>>,
}

/// Those of one interface.
struct Factors<E> {
    left: [Left<E>; ROOM],
    right: [Right<E>; ROOM],
}

/// e+_j, e-_j and b_(j+1)
type Left<E> = [E; 3];
/// q+_j, q-_j, -|v|_j in the unit of time, and -P_j; and sums of e+ q+, e- q-, -b |v| and -b P.
type Right<E> = [E; 4];

/// The terms of one order.
type Terms<E> = (Left<E>, Right<E>);

/// What all orders take.
struct Level<E> {
    pull: E,
    growth: E,
    sliding: E,
    beta: E,
}

/// The same of an interface.
#[derive(Clone, Copy)]
struct Interface<E> {
    power: E,
    per_psi: E,
    psi_per_b: E,
    b: E,
}

impl<E: Element> AgeingLanes<E> {
    pub fn new(zero: E) -> Self {
        let nothing = || Factors {
            left: [[zero; 3]; ROOM],
            right: [[zero; 4]; ROOM],
        };
        AgeingLanes {
            factors: [nothing(), nothing()],
            recorded: None,
        }
    }
}

impl<E: Element> Recurrences<E, Trajectories<E>, 3> for AgeingLanes<E> {
    #[inline(always)]
    fn make(&mut self, formula: &Trajectories<E>, memory: &[Cell<E>], order: usize, unit: E) {
        let tau = memory[TAU * ROOM].get();
        let far = tau.abs() - tau.like(NEAR);
        self.expand(formula, memory, order, unit);
        if !far.none_negative() {
            self.expand_near(far, formula, memory, (order, unit));
        }
    }
}

impl<E: Element> AgeingLanes<E> {
    /// The series in the lanes where this is negative by the recorded formula. Every lane by itself: what it holds does not depend on the
    /// others.
    #[cold]
    #[inline(never)]
    fn expand_near(
        &mut self,
        far: E,
        formula: &Trajectories<E>,
        memory: &[Cell<E>],
        (order, unit): (usize, E),
    ) {
        let record = || Box::new(LaneFormula::new(&InStates(formula.law), false, unit));
        let recorded = self.recorded.get_or_insert_with(record);
        formula.expand_where(far, recorded, memory, (order, unit));
    }
}

impl<E: Element> Factors<E> {
    /// sum + the products of left_j and right_r
    #[inline(always)]
    fn add(&self, sums: &mut Right<E>, j: usize, r: usize) {
        add(sums, &self.left[j], &self.right[r]);
    }

    /// The sums of order k, which is even, and those of the next one without its newest terms. From the middle outward: what was made
    /// last is multiplied last, and nobody waits for it.
    #[inline(always)]
    fn sums(&self, zero: E, k: usize) -> (Right<E>, Right<E>) {
        let (mut this, mut next) = ([zero; 4], [zero; 4]);
        let half = k / 2;
        self.add(&mut this, half, half - 1);
        self.add(&mut next, half, half);
        let near = self.left[1..half].iter().rev();
        let near = near.zip(self.right[half..k].windows(2));
        let far = self.left[half + 1..k].iter();
        let far = far.zip(self.right[..half].windows(2).rev());
        // With registers for them, what windows share is read but once.
        let kept = E::LANES == 8;
        let (mut shared, mut mirror) = (self.right[half], self.right[half - 1]);
        for ((left, window), (other, mirrored)) in near.zip(far) {
            let before = if kept { shared } else { window[0] };
            add(&mut this, left, &before);
            shared = window[1];
            add(&mut next, left, &shared);
            let after = if kept { mirror } else { mirrored[1] };
            add(&mut next, other, &after);
            mirror = mirrored[0];
            add(&mut this, other, &mirror);
        }
        self.add(&mut this, 0, k - 1);
        (this, next)
    }
}

/// sum + the products
#[inline(always)]
fn add<E: Element>(sums: &mut Right<E>, [rising, falling, b]: &Left<E>, right: &Right<E>) {
    sums[0] = rising.mul_add(right[0], sums[0]);
    sums[1] = falling.mul_add(right[1], sums[1]);
    sums[2] = b.mul_add(right[2], sums[2]);
    sums[3] = b.mul_add(right[3], sums[3]);
}

impl<E: Element> Interface<E> {
    #[inline(always)]
    fn new(form: &AgeingForm, psi: E) -> Self {
        let linear = psi.like(form.strength[1]);
        let a = psi.mul_add(linear, psi.like(form.strength[0]));
        let per_psi = linear / a;
        Interface {
            power: a.powf(-form.beta),
            per_psi,
            psi_per_b: a / linear,
            b: per_psi * psi,
        }
    }

    /// What stands for the sums of the first order.
    #[inline(always)]
    fn begun(&self, (rising, falling, healing): (E, E, E)) -> Right<E> {
        let none = healing.like(0.0);
        [
            rising * self.power,
            falling * self.power,
            healing * self.per_psi,
            none,
        ]
    }

    /// The terms of an order, from its sums and the b before.
    #[inline(always)]
    fn terms(
        &self,
        level: &Level<E>,
        (e, v, stress): ([E; 2], E, E),
        [_, _, slipped, weakened]: Right<E>,
        b: E,
        over_next: E,
    ) -> Terms<E> {
        let slid = level.sliding * v;
        let rate = b.mul_add(level.growth, slid.mul_add(self.b, slipped));
        let weakening = (-rate).mul_add(level.beta, -weakened);
        let left = [e[0], e[1], rate * over_next];
        (
            left,
            [stress + weakening, weakening - stress, slid, weakening],
        )
    }
}

impl<E: Element> AgeingLanes<E> {
    /// The series to this order, which is even, as all are.
    #[inline(always)]
    fn expand(&mut self, formula: &Trajectories<E>, memory: &[Cell<E>], order: usize, unit: E) {
        let form = &formula.law.ageing;
        let tau = memory[TAU * ROOM].get();
        let zero = tau.like(0.0);
        let exp = tau.exp();
        let half = tau.like(0.5 * form.gamma0);
        let rising = exp * half;
        let falling = if form.exponential { zero } else { half / exp };
        let first = Interface::new(form, memory[PSI[0] * ROOM].get());
        let second = Interface::new(form, memory[PSI[1] * ROOM].get());
        let healing = tau.like(form.healing[0]) * unit;
        let known = (
            Level {
                pull: -(formula.stiffness * unit),
                growth: tau.like(form.healing[1]) * unit,
                sliding: -(tau.sign() * unit),
                beta: tau.like(form.beta),
            },
            [first, second],
        );
        let begun = (rising, falling, healing);
        let sums = [first.begun(begun), second.begun(begun)];
        let b = [first.b, second.b];
        let mut last = self.next(&known, memory, 0, sums, b, -formula.driving);
        let mut k = 1;
        let mut sums = [[zero; 4]; 2];
        loop {
            // With the newest terms.
            let [first, second] = &self.factors;
            first.add(&mut sums[0], 0, k - 1);
            second.add(&mut sums[1], 0, k - 1);
            if k > 1 {
                first.add(&mut sums[0], k - 1, 0);
                second.add(&mut sums[1], k - 1, 0);
            }
            last = self.next(&known, memory, k, sums, newest_b(&last), zero);
            k += 1;
            if k >= order {
                break;
            }
            let [first, second] = &self.factors;
            let (one, next_one) = first.sums(zero, k);
            let (two, next_two) = second.sums(zero, k);
            last = self.next(&known, memory, k, [one, two], newest_b(&last), zero);
            sums = [next_one, next_two];
            k += 1;
        }
    }

    /// The coefficients of order k from the sums of those before and the newest b. `driving` is what is added to the slip rates.
    #[inline(always)]
    fn next(
        &mut self,
        (level, each): &(Level<E>, [Interface<E>; 2]),
        memory: &[Cell<E>],
        k: usize,
        [one, two]: [Right<E>; 2],
        b: [E; 2],
        driving: E,
    ) -> [Terms<E>; 2] {
        let over = level.pull.like(if k == 0 { 1.0 } else { ONE_OVER[k] });
        let over_next = level.pull.like(ONE_OVER[k + 1]);
        let (e_one, e_two) = (
            [one[0] * over, one[1] * over],
            [two[0] * over, two[1] * over],
        );
        let (v_one, v_two) = (e_one[0] - e_one[1], e_two[0] - e_two[1]);
        let stress = level.pull * (v_one + v_two + driving);
        let first = each[0].terms(level, (e_one, v_one, stress), one, b[0], over_next);
        let second = each[1].terms(level, (e_two, v_two, stress), two, b[1], over_next);
        memory[SLIP_RATES[0] * ROOM + k].set(v_one);
        memory[SLIP_RATES[1] * ROOM + k].set(v_two);
        memory[TAU * ROOM + k + 1].set(stress * over_next);
        memory[PSI[0] * ROOM + k + 1].set(first.0[2] * each[0].psi_per_b);
        memory[PSI[1] * ROOM + k + 1].set(second.0[2] * each[1].psi_per_b);
        let [of_first, of_second] = &mut self.factors;
        (of_first.left[k], of_first.right[k]) = first;
        (of_second.left[k], of_second.right[k]) = second;
        [first, second]
    }
}

/// The newest b of both interfaces.
#[inline(always)]
fn newest_b<E: Copy>([(first, _), (second, _)]: &[Terms<E>; 2]) -> [E; 2] {
    [first[2], second[2]]
}
