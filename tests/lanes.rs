//! The functions of whole registers: against 31 digits, against the library where numbers are not ordinary, and all widths
//! against each other. Plain numbers, which are all that a processor without AVX2 has, are held to the same on every one; which
//! registers are held to it stands in what [`the_registers_of_this_processor`] prints and, where `TWINSLIP_REGISTERS` names those
//! that must be there, is asserted.

use proptest::prelude::*;
use pulp::x86::{V3, V4};
use twinslip::internals::{Eight, Element, Four, Pair};
use twinslip::number::{DoubleDouble, Real};

/// What a function makes of eight numbers, in registers of every width that this processor has.
fn in_all_widths(x: [f64; 8], f: Function) -> Vec<[f64; 8]> {
    let mut all = Vec::new();
    if let Some(simd) = V3::try_new() {
        let mut y = [0.0; 8];
        for (y, x) in y.chunks_mut(2).zip(x.chunks(2)) {
            y.copy_from_slice(&f.of(Pair::new(simd, x.try_into().unwrap())).lanes());
        }
        all.push(y);
        for (y, x) in y.chunks_mut(4).zip(x.chunks(4)) {
            y.copy_from_slice(&f.of(Four::new(simd, x.try_into().unwrap())).lanes());
        }
        all.push(y);
    }
    if let Some(simd) = V4::try_new() {
        all.push(f.of(Eight::new(simd, x)).lanes());
    }
    all
}

/// The registers that the other tests are about here. A machine that is to test them says so: there it is a failure if it has none.
#[test]
fn the_registers_of_this_processor() {
    let there = match (V3::try_new(), V4::try_new()) {
        (_, Some(_)) => "avx512",
        (Some(_), None) => "avx2",
        (None, None) => "none",
    };
    println!("registers that are tested here: {there}; plain numbers are everywhere");
    if let Ok(wanted) = std::env::var("TWINSLIP_REGISTERS") {
        assert_eq!(there, wanted, "TWINSLIP_REGISTERS asks for others");
    }
}

#[derive(Debug, Clone, Copy)]
enum Function {
    Exp,
    Ln,
    Sinh,
    Cosh,
    Power(f64),
}

use Function::{Cosh, Exp, Ln, Power, Sinh};

impl Function {
    fn of<E: Element>(self, x: E) -> E {
        match self {
            Exp => Element::exp(x),
            Ln => Element::ln(x),
            Sinh => x.sinh_cosh().0,
            Cosh => x.sinh_cosh().1,
            Power(p) => Element::powf(x, p),
        }
    }

    fn of_library(self, x: f64) -> f64 {
        match self {
            Exp => x.exp(),
            Ln => x.ln(),
            Sinh => x.sinh(),
            Cosh => x.cosh(),
            Power(p) => x.powf(p),
        }
    }

    fn exactly(self, x: f64) -> DoubleDouble {
        let x = DoubleDouble::from(x);
        match self {
            Exp => Real::exp(x),
            Ln => Real::ln(x),
            Sinh => Real::sinh(x),
            Cosh => Real::cosh(x),
            // p as a number of 31 digits: powf of whole numbers might take another way.
            Power(p) => Real::exp(Real::ln(x) * p),
        }
    }

    /// Units in the last place by which a result may differ from the exact one.
    fn bound(self, exact: DoubleDouble) -> f64 {
        match self {
            Exp => 1.0,
            Ln => 0.75,
            Sinh => 3.0,
            Cosh => 2.0,
            Power(p) => {
                1.0 + 3e-18 * p.abs() / (0.5 * f64::EPSILON) + 1e-14 * exact.hi().ln().abs()
            }
        }
    }

    /// The largest error at these arguments, in units in the last place, after all widths agreed in every bit.
    fn error(self, x: [f64; 8]) -> f64 {
        let all = in_all_widths(x, self);
        let mut largest = 0.0;
        for y in &all {
            for i in 0..8 {
                assert_eq!(
                    y[i].to_bits(),
                    all[0][i].to_bits(),
                    "{self:?} of {:e}",
                    x[i]
                );
            }
        }
        let plain = x.map(|x| self.of(x));
        for y in all.first().into_iter().chain([&plain]) {
            for i in 0..8 {
                let exact = self.exactly(x[i]);
                let unit = exact.hi().abs().next_up() - exact.hi().abs();
                let error = ((exact - y[i]).hi() / unit).abs();
                assert!(
                    error <= self.bound(exact),
                    "{self:?} of {:e} is {:e}, off by {error} units",
                    x[i],
                    y[i]
                );
                largest = f64::max(largest, error);
            }
        }
        largest
    }
}

/// n arguments in groups of eight, between the ends.
fn between(ends: (f64, f64), n: usize) -> impl Iterator<Item = [f64; 8]> {
    let at = move |i: usize| ends.0 + (ends.1 - ends.0) * (i as f64 + 0.37) / n as f64;
    (0..n)
        .step_by(8)
        .map(move |i| std::array::from_fn(|j| at(i + j)))
}

#[test]
fn dense_arguments_stay_within_their_bounds() {
    let largest = |f: Function, ends: (f64, f64)| {
        between(ends, 40_000)
            .map(|x| f.error(x))
            .fold(0.0, f64::max)
    };
    let exp = largest(Exp, (-707.9, 707.9)).max(largest(Exp, (-2.0, 2.0)));
    let ln = largest(Ln, (1e-3, 3.0)).max(largest(Ln, (0.99, 1.01)));
    let sinh = largest(Sinh, (-3.0, 3.0)).max(largest(Sinh, (-700.0, 700.0)));
    let cosh = largest(Cosh, (-3.0, 3.0)).max(largest(Cosh, (-700.0, 700.0)));
    let power = largest(Power(-1.4), (1e-3, 1e2)).max(largest(Power(1.4011), (0.5, 2.0)));
    let high = largest(Power(140.0), (0.7, 1.4)).max(largest(Power(-2000.0), (0.75, 1.4)));
    println!(
        "exp {exp:.2}, ln {ln:.2}, sinh {sinh:.2}, cosh {cosh:.2}, power {power:.2}, high {high:.2}"
    );
}

proptest! {
    #[test]
    fn random_arguments_stay_within_their_bounds(
        x in prop::array::uniform8(-700.0..700.0),
        small in prop::array::uniform8(-1.2..1.2),
        p in -2.0..2.0,
        q in -300.0..300.0,
    ) {
        Exp.error(x);
        Sinh.error(x);
        Cosh.error(x);
        Sinh.error(small);
        // Down to where sinh x is x.
        Sinh.error(small.map(|x| (x / 1.2).powi(41)));
        let positive = x.map(f64::exp);
        Ln.error(positive);
        Power(p).error(positive.map(|x| x.powf(0.45)));
        Power(q).error(small.map(f64::exp));
    }
}

/// Where a result is no ordinary number it is the library's, also beside lanes that are.
#[test]
fn special_values_are_those_of_the_library() {
    let (tiny, least, infinity) = (f64::from_bits(1), f64::MIN_POSITIVE, f64::INFINITY);
    let special = [
        0.0,
        -0.0,
        infinity,
        -infinity,
        f64::NAN,
        tiny,
        -tiny,
        least / 4.0,
        -1.0,
        -least,
        f64::MAX,
        f64::MIN,
        709.0,
        709.9,
        710.2,
        711.0,
        -709.0,
        -720.0,
        -745.0,
        -746.0,
        1e4,
        -1e4,
    ];
    for f in [
        Exp,
        Ln,
        Sinh,
        Cosh,
        Power(-1.4),
        Power(1.4),
        Power(0.0),
        Power(2.0),
        Power(-3.0),
        Power(f64::NAN),
    ] {
        for x in special {
            let (plain, library) = (f.of(x), f.of_library(x));
            let near = (plain - library).abs() <= 4.0 * f64::EPSILON * library.abs();
            let same = plain == library || (plain.is_nan() && library.is_nan()) || near;
            assert!(same, "{f:?} of {x:e} is {plain:e} and not {library:e}");
            for place in 0..8 {
                let mut beside: [f64; 8] = std::array::from_fn(|i| 0.3 + i as f64);
                let without = in_all_widths(beside, f);
                beside[place] = x;
                for (y, without) in in_all_widths(beside, f).iter().zip(&without) {
                    let library = f.of_library(x);
                    let near = (y[place] - library).abs() <= 4.0 * f64::EPSILON * library.abs();
                    let same =
                        y[place] == library || (y[place].is_nan() && library.is_nan()) || near;
                    assert!(same, "{f:?} of {x:e} is {:e} and not {library:e}", y[place]);
                    assert_eq!(
                        y[place].is_sign_negative(),
                        library.is_sign_negative()
                            || y[place].is_nan() && y[place].is_sign_negative()
                    );
                    for i in (0..8).filter(|i| *i != place) {
                        let (with, without) = (y[i].to_bits(), without[i].to_bits());
                        assert_eq!(with, without, "{f:?} of {} beside {x:e}", beside[i]);
                    }
                }
            }
        }
    }
}

/// The difference of two exponentials has lost all digits here.
#[test]
fn sinh_does_not_cancel_near_zero() {
    for x in [
        1e-300, 1e-30, 1e-9, 1e-3, 0.1, 0.5, 0.999_999, 1.0, 1.000_001,
    ] {
        for sign in [1.0, -1.0] {
            let x = sign * x;
            let all = in_all_widths([x; 8], Sinh).into_iter().map(|y| y[0]);
            for y in all.chain([Sinh.of(x)]) {
                let exact = Sinh.exactly(x);
                let relative = ((exact - y) / exact).hi().abs();
                assert!(relative < 4e-16, "sinh {x:e} errs by {relative:e}");
            }
        }
    }
}

/// Choices and bits: what the step sizes are made of.
#[test]
fn the_small_operations_do_what_they_say() {
    let four = [-2.0, 0.0, f64::INFINITY, f64::NAN];
    for (x, sign) in four.into_iter().zip([-1.0, 1.0, 1.0]) {
        assert_eq!(x.if_positive(1.0, 2.0), 2.0, "{x}");
        assert_eq!(x.if_negative(1.0, 2.0), if x < 0.0 { 1.0 } else { 2.0 });
        assert_eq!(Element::sign(x), sign);
    }
    assert!(!four.into_iter().any(Element::all_positive));
    assert_eq!(four.map(Element::all_finite), [true, true, false, false]);
    for y in [1e-300, 3.0, 1e300, 0.7] {
        assert_eq!(y.if_positive(1.0, 2.0), 1.0);
        assert!((y.rough_log2() - y.log2()).abs() < 0.01);
        assert!((y.rough_log2().rough_exp2() / y - 1.0).abs() < 0.02);
    }
    let Some(v3) = V3::try_new() else { return };
    let x = Four::new(v3, four);
    let chosen = x.if_positive(x.like(1.0), x.like(2.0)).lanes();
    assert_eq!(chosen, [2.0; 4]);
    assert_eq!(
        x.if_negative(x.like(1.0), x.like(2.0)).lanes(),
        [1.0, 2.0, 2.0, 2.0]
    );
    assert_eq!(x.sign().lanes()[..3], [-1.0, 1.0, 1.0]);
    assert_eq!(x.abs().lanes()[..3], [2.0, 0.0, f64::INFINITY]);
    assert!(!x.all_finite() && !x.all_positive() && !x.none_negative());
    let y = Four::new(v3, [1e-300, 3.0, 1e300, 0.7]);
    assert_eq!(y.if_positive(x, y).lanes()[..2], four[..2]);
    assert!(y.all_finite() && y.all_positive());
    for (rough, y) in y.rough_log2().lanes().iter().zip(y.lanes()) {
        assert!((rough - y.log2()).abs() < 0.01);
    }
    for (rough, y) in y.rough_log2().rough_exp2().lanes().iter().zip(y.lanes()) {
        assert!((rough / y - 1.0).abs() < 0.02);
    }
    // The interfaces of a pair belong together.
    let pair = Pair::new(v3, [1.0, -1.0]);
    assert_eq!(
        pair.if_positive(pair.like(1.0), pair.like(2.0)).lanes(),
        [2.0; 2]
    );
}
