//! All zeros in a box, and eigenvalues within bounds: what is claimed holds, and what cannot be told is not.

use twinslip::equilibrium::{Enclosed, Verdict, spectrum_within, zero_near, zeros_in_box};
use twinslip::number::{Interval, Real};

fn exact(x: f64) -> Interval {
    Interval::new(x, x)
}

/// (x - 1)(x - 2)(x + 3) = 0, y^2 = x^2
struct Lines;

impl Enclosed for Lines {
    fn values(&self, x: &[Interval]) -> Vec<Interval> {
        let [x, y] = [x[0], x[1]];
        vec![(x - 1.0) * (x - 2.0) * (x + 3.0), y * y - x * x]
    }

    fn jacobian(&self, x: &[Interval]) -> Vec<Interval> {
        let [x, y] = [x[0], x[1]];
        let slope = (x - 2.0) * (x + 3.0) + (x - 1.0) * (x + 3.0) + (x - 1.0) * (x - 2.0);
        vec![slope, exact(0.0), -(x * 2.0), y * 2.0]
    }
}

#[test]
fn every_zero_is_found_once_also_on_edges() {
    // With zeros in corners and on edges of the box, and of boxes that it may be cut into.
    for (low, high) in [(-4.0, 4.0), (-3.0, 2.0), (-3.0, 3.0), (-100.0, 7.0)] {
        let found = zeros_in_box(&Lines, &[Interval::new(low, high); 2]);
        assert!(found.undecided.is_empty(), "{:?}", found.undecided);
        let inside = |x: f64| (low..=high).contains(&x);
        let all = [-3.0, 1.0, 2.0]
            .into_iter()
            .flat_map(|x| [-x, x].map(|y: f64| [x, y]));
        let expected: Vec<[f64; 2]> = all.filter(|[x, y]| inside(*x) && inside(*y)).collect();
        assert_eq!(
            found.zeros.len(),
            expected.len(),
            "{low}..{high}: {:?}",
            found.zeros
        );
        for zero in expected {
            let holds = |within: &[Interval]| {
                let pairs = within.iter().zip(zero);
                pairs
                    .into_iter()
                    .all(|(ends, x)| ends.lo() <= x && x <= ends.hi())
            };
            assert!(found.zeros.iter().any(|one| holds(&one.within)), "{zero:?}");
        }
        for one in &found.zeros {
            assert!(one.within.iter().all(|x| x.hi() - x.lo() < 1e-13));
        }
    }
    let near = zero_near(&Lines, &[2.0 + 1e-13, -2.0]).expect("a zero");
    assert!(near.within[0].lo() <= 2.0 && near.within[0].hi() >= 2.0);
    assert!(zero_near(&Lines, &[1.5, 1.5]).is_none());
}

/// (x - a)^2 = e
struct Fold(f64);

impl Enclosed for Fold {
    fn values(&self, x: &[Interval]) -> Vec<Interval> {
        vec![(x[0] - 0.3) * (x[0] - 0.3) - self.0]
    }

    fn jacobian(&self, x: &[Interval]) -> Vec<Interval> {
        vec![(x[0] - 0.3) * 2.0]
    }
}

#[test]
fn near_a_double_zero_nothing_is_claimed() {
    let count = |e: f64| {
        let found = zeros_in_box(&Fold(e), &[Interval::new(-1.0, 1.0)]);
        (found.zeros.len(), found.undecided.len())
    };
    assert_eq!(count(1e-8), (2, 0));
    assert_eq!(count(-1e-8), (0, 0));
    let found = zeros_in_box(&Fold(0.0), &[Interval::new(-1.0, 1.0)]);
    assert!(found.zeros.is_empty() && found.undecided.len() == 1);
    let part = found.undecided[0][0];
    assert!(part.lo() <= 0.3 && part.hi() >= 0.3 && part.hi() - part.lo() < 1e-6);
}

/// A matrix with these eigenvalues, by similarity with whole numbers.
fn with_eigenvalues(pairs: &[(f64, f64)], real: &[f64]) -> Vec<Interval> {
    let n = 2 * pairs.len() + real.len();
    let mut a = vec![vec![0.0; n]; n];
    for (k, &(re, im)) in pairs.iter().enumerate() {
        let i = 2 * k;
        (a[i][i], a[i][i + 1], a[i + 1][i], a[i + 1][i + 1]) = (re, im, -im, re);
    }
    for (k, &x) in real.iter().enumerate() {
        let i = 2 * pairs.len() + k;
        a[i][i] = x;
    }
    // Rows and columns added and taken away: exact where all are small dyadic numbers.
    for i in 0..n {
        for j in 0..n {
            if i != j && (i + 2 * j) % 3 == 0 {
                let added = a[j].clone();
                for (x, more) in a[i].iter_mut().zip(added) {
                    *x += more;
                }
                for row in &mut a {
                    let x = row[i];
                    row[j] -= x;
                }
            }
        }
    }
    a.concat().into_iter().map(exact).collect()
}

#[test]
fn eigenvalues_lie_in_their_discs() {
    type Eigenvalues = (&'static [(f64, f64)], &'static [f64]);
    let cases: [Eigenvalues; 5] = [
        (&[(0.25, 3.0)], &[-2.0]),
        (&[(-0.5, 1.0), (-0.25, 4.0)], &[-8.0]),
        (&[], &[-1.0, -2.0, -4.0, -0.125]),
        (&[(-1.0, 0.5), (0.0625, 2.0)], &[-3.0, -64.0]),
        (&[], &[1e-9]),
    ];
    for (pairs, real) in cases {
        let found = spectrum_within(&with_eigenvalues(pairs, real));
        let conjugates = pairs.iter().flat_map(|&(re, im)| [(re, im), (re, -im)]);
        let all: Vec<(f64, f64)> = conjugates.chain(real.iter().map(|&x| (x, 0.0))).collect();
        assert_eq!(found.eigenvalues.len(), all.len());
        for (re, im) in &all {
            let near = found.eigenvalues.iter().zip(&found.uncertainty);
            let mut off = near.map(|(z, radius)| ((z.re - re).hypot(z.im - im), *radius));
            let held = off.find(|(off, radius)| off <= radius);
            assert!(
                held.is_some_and(|(_, radius)| radius < 1e-8),
                "{re} {im}: {found:?}"
            );
        }
        let stable = all.iter().all(|(re, _)| *re < 0.0);
        let expected = if stable {
            Verdict::Stable
        } else {
            Verdict::Unstable
        };
        assert_eq!(found.verdict, expected, "{all:?}");
    }
}

#[test]
fn what_is_not_known_of_eigenvalues_is_not_told() {
    // A centre; a matrix whose bounds hold stable and unstable ones; one without a basis of eigenvectors; no numbers.
    let centre = [0.0, 1.0, -1.0, 0.0].map(exact);
    assert_eq!(spectrum_within(&centre).verdict, Verdict::Undecided);
    let wide = [
        Interval::new(-0.1, 0.1),
        exact(1.0),
        exact(-1.0),
        exact(0.0),
    ];
    let found = spectrum_within(&wide);
    assert_eq!(found.verdict, Verdict::Undecided);
    // With 0.1 the eigenvalues are 0.05 +- i 0.99875.
    let reaches =
        |z: &nalgebra::Complex<f64>, r: &f64| (z.re - 0.05).hypot(z.im.abs() - 0.99875) < r + 1e-5;
    assert!(
        found
            .eigenvalues
            .iter()
            .zip(&found.uncertainty)
            .all(|(z, r)| reaches(z, r))
    );
    let block = [-1.0, 1.0, 0.0, -1.0].map(exact);
    assert_eq!(spectrum_within(&block).verdict, Verdict::Undecided);
    let none = [f64::NAN, 0.0, 0.0, 1.0].map(exact);
    assert_eq!(spectrum_within(&none).verdict, Verdict::Undecided);
}

#[test]
fn intervals_hold_what_is_partly_undefined() {
    let all = |x: Interval| x.lo() == f64::NEG_INFINITY && x.hi() == f64::INFINITY;
    let across = Interval::new(-1.0, 2.0);
    assert!(all(across.ln()) && all(across.sqrt()) && all(across.powf(0.5)));
    // Of |ln x| between -1 and 2 nothing is known above.
    assert_eq!(across.ln().abs().hi(), f64::INFINITY);
    assert_eq!(across.ln().cosh().hi(), f64::INFINITY);
    assert!(all(
        Interval::new(f64::NEG_INFINITY, 0.0) + Interval::new(0.0, f64::INFINITY)
    ));
    let (a, b) = (Interval::new(0.0, 3.0), Interval::new(1.0, 2.0));
    assert_eq!((a.lesser(b).lo(), a.lesser(b).hi()), (0.0, 2.0));
    assert_eq!((a.greater(b).lo(), a.greater(b).hi()), (1.0, 3.0));
    let sign = Real::sign(across);
    assert_eq!((sign.lo(), sign.hi()), (-1.0, 1.0));
}

/// Boxes around the pole of a rate, n = -1, are never decided, and there are more of them than can be looked at.
#[test]
fn equilibria_are_found_beside_a_pole() {
    let text = "name = \"pole\"
states = [\"n\", \"p\"]
[parameters]
k = 2.0
[rates]
n = \"n*(1 - n/k) - n*p/(1 + n)\"
p = \"p*(n/(1 + n) - 0.4)\"
[start]
n = 1.0
p = 1.0
";
    let file = crate::common::text::file("beside-a-pole", text);
    let ended = crate::command::twinslip(&format!(
        "equilibria --system {file} --box n=-1:8,p=-1:8 --format json"
    ));
    assert_eq!(ended.code, 3, "{}", ended.err);
    assert!(ended.err.contains("near n = -0.99"), "{}", ended.err);
    let made: serde_json::Value = serde_json::from_str(&ended.out).expect("JSON");
    let found = made["result"]["equilibria"].as_array().expect("equilibria");
    assert_eq!(found.len(), 3, "{found:?}");
}
