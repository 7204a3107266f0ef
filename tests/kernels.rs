//! Formulas compiled while the program runs give what the loops over their operations give, bit by bit.

use crate::command::twinslip;
use crate::common::data;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;
use twinslip::expression::{Binary, Builder, Expressions, Function};
use twinslip::integrate::used_vectors;
use twinslip::internals::{both_ways, columns_both_ways};

/// Random numbers (splitmix64).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// From 0 to 1.
    pub fn number(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }
}

const FUNCTIONS: [Function; 16] = [
    Function::Exp,
    Function::Expm1,
    Function::Exprel,
    Function::Ln,
    Function::Log1p,
    Function::Log10,
    Function::Sqrt,
    Function::Sin,
    Function::Cos,
    Function::Tan,
    Function::Sinh,
    Function::Cosh,
    Function::Tanh,
    Function::Asinh,
    Function::Atan,
    Function::Abs,
];
const PARAMETERS: usize = 3;

/// Right-hand sides in so many variables.
pub fn drawn(random: &mut Random, variables: usize) -> Expressions {
    let mut builder = Builder::default();
    let mut all = Vec::new();
    all.extend((0..variables).map(|i| builder.variable(i)));
    all.extend((0..PARAMETERS).map(|q| builder.parameter(q)));
    all.extend([1.0, 0.7, 2.0].map(|x| builder.number(x)));
    let mut all: Vec<_> = all.into_iter().map(|place| place.expect("few")).collect();
    for _ in 0..random.below(25) + 3 {
        let [x, y] = [0, 1].map(|_| {
            let recent = if random.below(2) == 0 { 4 } else { all.len() };
            all[all.len() - 1 - random.below(recent.min(all.len()))]
        });
        let binary = match random.below(12) {
            0 | 1 => Some(Binary::Sum),
            2 => Some(Binary::Difference),
            3 | 4 => Some(Binary::Product),
            5 => Some(Binary::Quotient),
            6 => Some(Binary::Power),
            7 => Some(Binary::Greater),
            _ => None,
        };
        let made = match binary {
            Some(binary) => builder.binary(binary, x, y),
            None => builder.call(random.of(&FUNCTIONS), &[x]),
        };
        // Some whole powers are refused.
        all.extend(made.ok());
    }
    let last = all.len();
    let rates = (0..variables).map(|_| all[last - 1 - random.below(8.min(last))]);
    let rates = rates.collect();
    builder.complete(rates)
}

/// The same bits, or no numbers both.
fn assert_same(loops: &[f64], compiled: &[f64], what: &str) {
    assert_eq!(loops.len(), compiled.len(), "{what}");
    for (i, (a, b)) in loops.iter().zip(compiled).enumerate() {
        let same = a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
        assert!(same, "{what}, at {i}: {a:e} is {b:e}");
    }
}

/// Whether this machine compiles.
fn compiles() -> bool {
    let compiles = used_vectors().name() != "none" && cfg!(unix);
    if !compiles {
        eprintln!("not checked: nothing is compiled on this machine");
    }
    compiles
}

#[test]
fn random_formulas_have_the_same_series_compiled() {
    if !compiles() {
        return;
    }
    let (mut compiled, mut finite, mut columns) = (0, 0, 0);
    for seed in 0..1500 {
        let mut random = Random(seed);
        let variables = 1 + random.below(4);
        let rates = Arc::new(drawn(&mut random, variables));
        let state: Vec<f64> = (0..variables)
            .map(|_| 2.0 * random.number() - 0.5)
            .collect();
        let parameter = |_| {
            let near = random.number() + 0.2;
            random.of(&[1.0, -1.0, 2.0, near])
        };
        let parameters: Vec<f64> = (0..PARAMETERS).map(parameter).collect();
        let order = random.of(&[2, 5, 12, 16, 20, 24]);
        let free = random.of(&[None, Some([0, 2])]);
        let free = free.as_ref().map(|free| &free[..]);
        let what = format!("formula {seed} to order {order}: {rates:?}");
        for mut formula in both_ways(&rates, &parameters, (&state, free)) {
            formula.expand(false, order, 0.25);
            let loops = formula.coefficients();
            compiled += usize::from(formula.expand(true, order, 0.25));
            assert_same(&loops, &formula.coefficients(), &what);
            finite += usize::from(loops.iter().all(|x| x.is_finite()));
        }
        let of = (&state[..], free.unwrap_or(&[]));
        if let Some([loops, kernel]) = columns_both_ways(&rates, &parameters, of, (order, 0.25)) {
            columns += 1;
            assert_same(&loops, &kernel, &format!("columns of {what}"));
        }
    }
    assert!(
        compiled > 1300 && finite > 1000 && columns == 1500,
        "{compiled} {finite} {columns}"
    );
}

/// A run of the program, compiled from the first step on, not at all, or as it is by default: the end of the run is the same.
fn assert_same_outputs(arguments: &str) {
    let of = |compile: &str| {
        let output = crate::command::program()
            .args(arguments.split_whitespace())
            .args(["-q", "--format", "csv"])
            .env("TWINSLIP_COMPILE", compile)
            .output()
            .expect("the program starts");
        (
            output.status.code(),
            String::from_utf8(output.stdout).expect("UTF-8"),
        )
    };
    let off = of("off");
    assert!(matches!(off.0, Some(0 | 3)), "{arguments}");
    for compile in ["always", "on"] {
        assert_eq!(of(compile), off, "{compile}: {arguments}");
    }
}

#[test]
fn every_model_runs_to_the_same_digits_compiled() {
    let all = data("models.json");
    let models: BTreeMap<String, serde_json::Value> =
        serde_json::from_value(all["models"].clone()).expect("models");
    assert_eq!(models.len(), 50);
    // Every other one, others each time.
    let half = crate::common::random() as usize % 2;
    let all: Vec<_> = models.iter().skip(half).step_by(2).collect();
    all.par_iter().for_each(|(name, model)| {
        let until = model["until"].as_f64().expect("a time");
        let system = format!("integrate --system tests/data/models/{name}.toml");
        assert_same_outputs(&format!("{system} --until {until:?} --method taylor"));
    });
}

#[test]
fn orbits_and_branches_are_the_same_to_the_last_digit_compiled() {
    for arguments in [
        "orbit --system tests/data/models/selkov.toml",
        "orbit --system tests/data/models/wien-bridge.toml",
        "branch orbits --system tests/data/models/selkov.toml --along b --from 0.3 --to 0.8",
    ] {
        assert_same_outputs(arguments);
    }
}

#[test]
fn what_is_compiled_when_is_one_of_three_words() {
    let output = crate::command::program()
        .args("integrate --system lorenz --until 1".split_whitespace())
        .env("TWINSLIP_COMPILE", "never")
        .output()
        .expect("the program starts");
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(output.stdout, b"");
    assert_eq!(
        String::from_utf8_lossy(&output.stderr),
        "error: TWINSLIP_COMPILE is never, but must be on, off or always\n"
    );
    assert_eq!(twinslip("integrate --system lorenz --until 1").code, 0);
}
