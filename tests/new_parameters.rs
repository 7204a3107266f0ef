//! Solutions that go over to other values of the parameters are those that are made at these values, bit by bit: whatever a value decides,
//! such as that a product is 0, that a power is a product, or that two interfaces are alike.

use crate::kernels::{Random, drawn};
use rayon::prelude::*;
use std::ops::Range;
use twinslip::expression::{Binary, Builder, Expressions};
use twinslip::field::VectorField;
use twinslip::model::TextSystem;
use twinslip::number::DoubleDouble;
use twinslip::series::{Accuracy, Expansion, REFERENCE_ORDER, Solution};

const VARIABLES: usize = 4;
const PARAMETERS: usize = 3;
/// Values that formulas are followed at one after the other.
const VALUES: usize = 12;
const ORDER: usize = 12;
/// So many make more steps than after which a formula is compiled.
const MANY: usize = 200;

/// Two parts with one formula, each in a variable of its own and in one that both share, and each with one more parameter of its own: they are alike
/// where these two are the same.
fn twins(random: &mut Random) -> Expressions {
    let part = drawn(random, 2);
    let mut builder = Builder::default();
    let x = [0, 1, 2].map(|i| builder.variable(i).expect("few"));
    let p = [0, 1, 2].map(|q| builder.parameter(q).expect("few"));
    let mut rates = Vec::new();
    for own in [1, 2] {
        let made = builder.insert(&part, &[x[own], x[0]], &[p[0], p[own], p[own]]);
        rates.push(made.expect("few")[0]);
    }
    let shared = builder.binary(Binary::Sum, rates[0], rates[1]);
    builder.complete(vec![shared.expect("few"), rates[0], rates[1]])
}

/// Values of the parameters, most of them like any others.
fn values(random: &mut Random) -> Vec<f64> {
    let mut all: Vec<f64> = (0..PARAMETERS)
        .map(|_| {
            let special = [0.0, 1.0, -1.0, 2.0, 3.0, 0.5, 1.5, -2.0];
            match random.below(3) {
                0 => random.of(&special),
                _ => 2.0 * random.number() - 0.5,
            }
        })
        .collect();
    if random.below(3) == 0 {
        all[2] = all[1];
    }
    all
}

fn put(into: &mut Vec<u64>, numbers: impl IntoIterator<Item = f64>) {
    // All that are no numbers are the same.
    let bits = |x: f64| if x.is_nan() { f64::NAN } else { x }.to_bits();
    into.extend(numbers.into_iter().map(bits));
}

/// Some steps, and all that is known of them.
fn follow<const N: usize>(
    solution: &mut dyn Solution<N>,
    (start, order): (&[f64; N], usize),
    into: &mut Vec<u64>,
) {
    let accuracy = Accuracy {
        order,
        tolerances: (1e-9, 1e-9),
    };
    solution.start(start);
    let mut expansion = Expansion::new();
    for _ in 0..3 {
        let taken = solution.advance(&accuracy, DoubleDouble::from(0.3));
        solution.expansion(order, &mut expansion);
        put(into, [taken.hi(), taken.lo(), expansion.unit]);
        put(into, solution.state());
        put(into, expansion.variables.into_iter().flatten());
        put(into, [solution.rejected() as f64]);
        if !taken.is_finite() {
            break;
        }
    }
}

/// All solutions of a system from a start, after so many others of it.
fn solutions(system: &TextSystem, start: &[f64; VARIABLES], others: usize) -> Vec<u64> {
    let field = system.field::<VARIABLES>().expect("few variables");
    let analytic = field.analytic().expect("formulas");
    let free: &[usize] = match system.parameters() {
        [_, _, _] => &[0, 2],
        _ => &[0],
    };
    let mut all = Vec::new();
    let mut solution = analytic.solution();
    let mut tangent = analytic.tangent(free);
    for _ in 0..others {
        follow(&mut *solution, (start, ORDER), &mut Vec::new());
        follow(&mut *tangent, (start, ORDER), &mut Vec::new());
    }
    follow(&mut *solution, (start, ORDER), &mut all);
    follow(&mut *tangent, (start, ORDER), &mut all);
    let derivatives = tangent.derivatives();
    put(&mut all, derivatives.start.into_iter().flatten());
    put(&mut all, derivatives.parameters.into_iter().flatten());
    put(&mut all, [derivatives.log_determinant]);
    for i in 0..system.variables() {
        let mut series = Vec::new();
        assert!(tangent.derivative_series(i, ORDER, &mut series));
        put(&mut all, series);
    }
    let mut reference = analytic.reference();
    follow(&mut *reference, (start, REFERENCE_ORDER), &mut all);
    all
}

/// What a new thread makes, which has not made a solution before.
fn anew<X: Send>(make: impl FnOnce() -> X + Send) -> X {
    std::thread::scope(|scope| scope.spawn(make).join().expect("it ends"))
}

/// How many of the solutions differ from those at the values before.
fn check(seeds: Range<u64>, formulas: impl Fn(&mut Random) -> Expressions + Sync) -> usize {
    let differ = |seed: u64| {
        let mut random = Random(seed);
        let rates = formulas(&mut random);
        let states = &["u", "v", "w", "x"][..rates.count()];
        let parameters = ["a", "b", "c"].map(|name| (name, 0.0));
        let system = TextSystem::new(rates.clone(), states, &parameters).expect("few states");
        let all: Vec<Vec<f64>> = (0..VALUES).map(|_| values(&mut random)).collect();
        let start = [0.0; VARIABLES].map(|_| 2.0 * random.number() - 0.5);
        let at = |values: &[f64]| {
            let mut system = system.clone();
            for (place, &value) in values.iter().enumerate() {
                system.put(place, value);
            }
            system
        };
        // Some are compiled.
        let others = if seed.is_multiple_of(8) { MANY } else { 0 };
        let in_turn: Vec<_> = anew(|| {
            let solved = |values: &Vec<f64>| solutions(&at(values), &start, others);
            all.iter().map(solved).collect()
        });
        for (values, solved) in all.iter().zip(&in_turn) {
            let made = anew(|| solutions(&at(values), &start, 0));
            assert!(
                *solved == made,
                "formula {seed} at {values:?} of {all:?}: {rates:?}"
            );
        }
        in_turn.windows(2).filter(|both| both[0] != both[1]).count()
    };
    seeds.into_par_iter().map(differ).sum()
}

#[test]
fn random_formulas_have_the_solutions_that_are_made_at_the_values() {
    let variables = |random: &mut Random| 1 + random.below(VARIABLES);
    let differ = check(0..300, |random| {
        let count = variables(random);
        drawn(random, count)
    });
    assert!(differ > 1500, "{differ}");
}

#[test]
fn parts_that_are_alike_at_some_values_do_too() {
    let differ = check(0..150, twins);
    assert!(differ > 700, "{differ}");
}

#[test]
fn whether_a_variable_is_a_factor_of_its_rate_may_depend_on_the_value() {
    let mut builder = Builder::default();
    let x = builder.variable(0).expect("few");
    let p = builder.parameter(0).expect("few");
    let power = builder.binary(Binary::Power, x, p).expect("few");
    let fall = builder.negative(power).expect("few");
    let rates = builder.complete(vec![fall]);
    let at = |p: f64| TextSystem::new(rates.clone(), &["x"], &[("p", p)]).expect("one state");
    // What it may err is then counted in itself, which is small.
    assert_eq!([0.7, 1.3].map(|p| at(p).own_factors()), [[false], [true]]);
    let start = [1e-10, 0.0, 0.0, 0.0];
    let values = [1.3, 0.7, 1.3];
    let in_turn = anew(|| values.map(|p| solutions(&at(p), &start, 0)));
    for (p, solved) in values.into_iter().zip(&in_turn) {
        assert!(*solved == anew(|| solutions(&at(p), &start, 0)), "{p}");
    }
    // A parameter that is not in the formula changes nothing.
    let all = [("p", 1.3), ("q", 0.1)];
    let more = TextSystem::new(rates.clone(), &["x"], &all).expect("one state");
    let both = [&more, &at(0.7), &more];
    let in_turn_again = anew(|| both.map(|system| solutions(system, &start, 0)));
    assert!(in_turn == in_turn_again);
}
