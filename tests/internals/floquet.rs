//! Multipliers of products of maps.

use nalgebra::{Matrix2, Vector2};
use twinslip::field::Matrix;
use twinslip::internals::pair;
use twinslip::number::Uncertain;
use twinslip::orbit::{Kind, Multiplier};
/// Maps between planes in turning frames, each of which multiplies one direction by e^a and the other by e^b.
fn maps(of: &[(f64, f64)]) -> Vec<Matrix> {
    let frame = |k: usize| {
        let (sin, cos) = (0.4 + 0.7 * (k % of.len()) as f64).sin_cos();
        // Not at right angles.
        Matrix2::new(cos, -0.6 * sin, sin, 0.8 * cos + 0.3)
    };
    let each = of.iter().enumerate().map(|(k, &(a, b))| {
        let inner = Matrix2::from_diagonal(&Vector2::new(a.exp(), b.exp()));
        let map = frame(k + 1) * inner * frame(k).try_inverse().unwrap();
        Matrix::from_column_slice(2, 2, map.as_slice())
    });
    each.collect()
}

fn multipliers(of: &[(f64, f64)]) -> Vec<Multiplier> {
    let volume = of.iter().map(|(a, b)| a + b).sum();
    pair(
        &maps(of),
        &vec![1e-15; of.len()],
        Uncertain::new(volume, 1e-12),
    )
}

fn assert_within(multiplier: &Multiplier, ln_abs: f64) {
    let off = (multiplier.ln_abs.value - ln_abs).abs();
    assert!(
        off <= multiplier.ln_abs.uncertainty,
        "{multiplier:?}, {ln_abs}"
    );
    assert!(multiplier.ln_abs.uncertainty < 1e-6, "{multiplier:?}");
    assert_eq!(multiplier.kind, Kind::Real);
}

#[test]
fn multipliers_a_hundred_decades_apart_are_both_known() {
    let found = multipliers(&[(-0.1, -7.0); 32]);
    assert_within(&found[0], -3.2);
    assert_within(&found[1], -224.0);
}

#[test]
fn what_grows_by_thirty_decades_and_shrinks_again_is_still_known() {
    // Of the trace of the product nothing would be left.
    let mut of = vec![(4.0, -1.0); 16];
    of.extend([(-4.1, -1.0); 16]);
    let found = multipliers(&of);
    assert_within(&found[0], -1.6);
    assert_within(&found[1], -32.0);
}

#[test]
fn noise_is_not_taken_for_a_pair() {
    // The direction that grows is not the one that dominates at last: neither can be told.
    let mut of = vec![(20.0, -20.0); 8];
    of.extend([(-20.5, 19.6); 8]);
    for multiplier in multipliers(&of) {
        let known = multiplier.ln_abs.uncertainty < 1e-3;
        let right = [-4.0, -3.2]
            .iter()
            .any(|x| (multiplier.ln_abs.value - x).abs() < 1e-3);
        assert!(
            multiplier.kind == Kind::BelowFloor || (known && right),
            "{multiplier:?}"
        );
    }
}
