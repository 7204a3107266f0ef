//! Real roots on an interval: against polynomials made from known roots, in clusters, multiple, at the ends, at any scale.

use proptest::prelude::*;
use twinslip::number::DoubleDouble;
use twinslip::number::polynomial::Crossing::{Downwards, Touching, Upwards};
use twinslip::number::polynomial::{
    Crossing, MAX_DEGREE, Root, evaluate, evaluate_derivative, roots,
};

fn found(coefficients: &[f64], length: f64) -> Vec<Root> {
    let mut found = Vec::new();
    roots(coefficients, length, &mut found);
    for root in &found {
        assert!(
            root.at / length > 0.0 && root.at / length <= 1.0,
            "{root:?}"
        );
    }
    assert!(found.is_sorted_by(|a, b| a.at / length <= b.at / length));
    found
}

fn crossings(coefficients: &[f64], length: f64) -> Vec<Crossing> {
    let found = found(coefficients, length).into_iter();
    found.map(|root| root.crossing).collect()
}

/// Coefficients, rounded once, of the product of (t - root) and a factor.
fn with_roots(roots: &[f64], factor: f64) -> Vec<f64> {
    let mut product = vec![DoubleDouble::from(factor)];
    for r in roots {
        product.insert(0, DoubleDouble::ZERO);
        for k in 0..product.len() - 1 {
            product[k] = product[k] - product[k + 1] * *r;
        }
    }
    product.into_iter().map(DoubleDouble::to_f64).collect()
}

/// E of the documentation of `roots`, for thirty halvings.
fn rounding(coefficients: &[f64], t: f64) -> f64 {
    let n = coefficients.len() as f64;
    let magnitudes: Vec<f64> = coefficients.iter().map(|c| c.abs()).collect();
    (6.0 * n + 3.0 * n * 30.0) * 0.5 * f64::EPSILON * evaluate(&magnitudes, t.abs())
}

fn near(found: &[Root], expected: &[(f64, Crossing)], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{found:?}, not {expected:?}");
    for (root, (at, crossing)) in found.iter().zip(expected) {
        assert!(
            (root.at - at).abs() <= tolerance && root.crossing == *crossing,
            "{found:?}, not {expected:?}"
        );
    }
}

#[test]
fn nothing_comes_from_nothing() {
    let (inf, nan) = (f64::INFINITY, f64::NAN);
    for coefficients in [
        &[][..],
        &[0.0],
        &[0.0; 30],
        &[1.0],
        &[1.0, 0.5, 0.25],
        &[nan, -1.0],
        &[0.5, nan],
        &[0.5, -1.0, inf],
        &[inf, -1.0],
        &[0.5, -1.0, nan, 0.0],
        &[1.0, 1e300, 1e308, -1e308],
    ] {
        assert_eq!(found(coefficients, 1.0 - 1e-3), [], "{coefficients:?}");
    }
    for length in [0.0, -0.0, nan, inf, -inf] {
        assert_eq!(found(&[0.5, -1.0], length), []);
    }
    assert_eq!(found(&[0.5, -1.0, 1e300], 1e9), [], "overflow");
    // no more than a finite one of these
    assert_eq!(found(&[0.5, -1.0], 1e300).len(), 1);
}

#[test]
fn simple_roots_are_exact_and_in_order() {
    near(&found(&[0.5, -1.0], 1.0), &[(0.5, Downwards)], 0.0);
    near(&found(&[-0.75, 1.0], 1.0), &[(0.75, Upwards)], 0.0);
    assert_eq!(found(&[-0.75, 1.0], 0.5), []);
    let two = with_roots(&[0.25, 0.75], 3.0);
    near(
        &found(&two, 1.0),
        &[(0.25, Downwards), (0.75, Upwards)],
        1e-16,
    );
    assert_eq!(found(&two, -1.0), []);
    let sides = with_roots(&[-0.5, 0.5, 0.75, -0.25], -1.0);
    near(
        &found(&sides, 1.0),
        &[(0.5, Upwards), (0.75, Downwards)],
        1e-15,
    );
    near(
        &found(&sides, -1.0),
        &[(-0.25, Downwards), (-0.5, Upwards)],
        1e-15,
    );
    // appended to what is there
    let mut both = found(&two, 0.5);
    roots(&[-0.75, 1.0], 1.0, &mut both);
    assert_eq!(both.len(), 2);
}

#[test]
fn tiny_roots_are_found_to_all_digits() {
    near(
        &found(&[1e-20, -1.0, 0.5], 1.0),
        &[(1e-20, Downwards)],
        1e-35,
    );
    let pair = [2e-24, -3e-12, 1.0];
    near(
        &found(&pair, 1.0),
        &[(1e-12, Downwards), (2e-12, Upwards)],
        1e-26,
    );
}

#[test]
fn the_interval_is_half_open() {
    // a root at 0 belongs to the step before, of whatever multiplicity
    near(&found(&[0.0, -0.5, 1.0], 1.0), &[(0.5, Upwards)], 0.0);
    near(&found(&[0.0, -0.5, -1.0], -1.0), &[(-0.5, Upwards)], 0.0);
    near(&found(&[0.0, 0.0, 0.5, 1.0], -1.0), &[(-0.5, Upwards)], 0.0);
    assert_eq!(found(&[0.0, 0.0, 1.0], 1.0), []);
    // one at the end to this
    near(&found(&[0.5, -1.0], 0.5), &[(0.5, Downwards)], 0.0);
    near(&found(&[0.5, 1.0], -0.5), &[(-0.5, Upwards)], 0.0);
    let inside = with_roots(&[0.25, 0.5, -1.0], 1.0);
    near(
        &found(&inside, 0.5),
        &[(0.25, Downwards), (0.5, Upwards)],
        1e-16,
    );
    for (multiplicity, crossing) in [(2, Touching), (3, Upwards), (4, Touching), (5, Upwards)] {
        let multiple = with_roots(&vec![1.0; multiplicity], 1.0);
        near(&found(&multiple, 1.0), &[(1.0, crossing)], 0.0);
        let with_another = with_roots(&[vec![1.0; multiplicity], vec![0.5]].concat(), -1.0);
        let opposite = if crossing == Touching {
            Touching
        } else {
            Downwards
        };
        let first = if crossing == Touching {
            Downwards
        } else {
            Upwards
        };
        near(
            &found(&with_another, 1.0),
            &[(0.5, first), (1.0, opposite)],
            1e-14,
        );
    }
    // an extremum that touches belongs to the step in whose half-open interval it is
    let touching = with_roots(&[0.5, 0.5], 1.0);
    assert_eq!(found(&touching, 0.5_f64.next_down()), []);
    assert_eq!(crossings(&touching, 0.5_f64.next_up()), [Touching]);
}

#[test]
fn multiple_roots_cross_or_touch() {
    for companions in [&[][..], &[-1.0, -1.5, -3.0], &[1.25, 2.0, 3.0, -0.5]] {
        for root in [0.5, 0.375, 0.8125, 0.333] {
            for (multiplicity, tolerance) in [(2, 1e-12), (3, 1e-9), (4, 1e-3)] {
                let all = [vec![root; multiplicity], companions.to_vec()].concat();
                let coefficients = with_roots(&all, 2.0);
                let found = found(&coefficients, 1.0);
                assert_eq!(found.len(), 1, "{all:?} {found:?}");
                assert!((found[0].at - root).abs() < tolerance, "{all:?} {found:?}");
                assert_eq!(
                    found[0].crossing == Touching,
                    multiplicity % 2 == 0,
                    "{all:?}"
                );
            }
        }
    }
}

/// Beside a root the polynomial stays small for long: that is no second root.
#[test]
fn a_multiple_root_is_one() {
    let (first, second) = (0.10799836613582948, 0.3142192540308226);
    let mut all = vec![
        -2.2075090866577542,
        -2.6254901393146066,
        -1.7228165503955277,
    ];
    all.extend([first, first, first, second, second, second]);
    near(
        &found(&with_roots(&all, 1.0), 1.0),
        &[(first, Downwards), (second, Upwards)],
        1e-9,
    );
}

#[test]
fn pairs_part_where_rounding_lets_them() {
    for exponent in 3..=12 {
        for companions in [
            &[][..],
            &[-1.0, -2.0, 1.5],
            &[-1.0, 1.25, 3.0, -0.3, 2.0, 1.75],
        ] {
            for root in [0.3, 0.5, 0.62] {
                let gap = 10f64.powi(-exponent);
                let all = [&[root, root + gap][..], companions].concat();
                let coefficients = with_roots(&all, 1.0);
                let found = found(&coefficients, 1.0);
                let apart = found.len() == 2 && found[0].crossing != found[1].crossing;
                let touching = found.len() == 1 && found[0].crossing == Touching;
                assert!(apart || touching, "{all:?} {found:?}");
                assert!(apart || exponent > 5, "{all:?} {found:?}");
                assert!(touching || exponent < 9, "{all:?} {found:?}");
                let off = 0.01 * gap + 1e-13 / gap;
                assert!(!apart || (found[1].at - found[0].at - gap).abs() < off);
                assert!((found[0].at - root).abs() < 3e-6 + gap);
            }
        }
    }
}

#[test]
fn triples_part_or_cross_as_one() {
    for exponent in 2..=12 {
        let gap = 10f64.powi(-exponent);
        let coefficients = with_roots(&[0.4, 0.4 + gap, 0.4 + 2.0 * gap, -2.0], 1.0);
        let crossings = crossings(&coefficients, 1.0);
        match exponent {
            2 | 3 => assert_eq!(crossings, [Upwards, Downwards, Upwards]),
            4..7 => assert!(!crossings.is_empty() && crossings.len() <= 3),
            _ => assert_eq!(crossings, [Upwards]),
        }
        let known = crossings.iter().filter(|c| **c != Touching).count();
        assert_eq!(known % 2, 1);
    }
}

#[test]
fn no_root_is_invented_above_the_axis() {
    for exponent in 0..12 {
        let above = 10f64.powi(-exponent);
        let coefficients = [0.25 + above, -1.0, 1.0]; // (t - 1/2)^2 + above
        assert_eq!(found(&coefficients, 1.0), []);
        let below = [0.25 - above, -1.0, 1.0];
        let both = [Downwards, Upwards];
        let left = if above < 0.25 { &both[..] } else { &both[1..] };
        let expected = if above > 0.25 { &[][..] } else { left };
        assert_eq!(crossings(&below, 1.0), expected, "{above}");
    }
}

#[test]
fn wilkinson_like_polynomials() {
    for n in [5, 8, 10, 12] {
        let expected: Vec<f64> = (1..=n).map(f64::from).collect();
        let found = found(&with_roots(&expected, 1.0), f64::from(n) + 0.5);
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (i, (root, at)) in found.iter().zip(&expected).enumerate() {
            assert!((root.at - at).abs() < 1e-4, "{root:?}");
            let first = if n % 2 == 0 { Downwards } else { Upwards };
            assert_eq!(root.crossing == first, i % 2 == 0);
        }
    }
}

/// Coefficients of a Taylor series from the numerators' cycle: c_k = cycle_k / k!.
fn series(cycle: &[f64]) -> Vec<f64> {
    let mut factorial = 1.0;
    let mut coefficients = Vec::new();
    for k in 0..=MAX_DEGREE {
        factorial *= k.max(1) as f64;
        coefficients.push(cycle[k % cycle.len()] / factorial);
    }
    coefficients
}

#[test]
fn taylor_series_of_degree_forty() {
    let half_pi = std::f64::consts::FRAC_PI_2;
    let cosine = series(&[1.0, 0.0, -1.0, 0.0]);
    let zeros: Vec<(f64, Crossing)> = (0..3)
        .map(|i| {
            (
                (2.0 * f64::from(i) + 1.0) * half_pi,
                [Downwards, Upwards][i as usize % 2],
            )
        })
        .collect();
    near(&found(&cosine, 10.0), &zeros, 1e-12);
    // on the way back cos rises to the left of -pi/2 ... as t grows it rises through -pi/2
    let mirrored: Vec<(f64, Crossing)> = zeros
        .iter()
        .map(|(at, c)| (-at, if *c == Upwards { Downwards } else { Upwards }))
        .collect();
    near(&found(&cosine, -10.0), &mirrored, 1e-12);
    // cos t - 1 touches at 2 pi, and at 0, which is not of this step
    let mut touching = cosine.clone();
    touching[0] = 0.0;
    near(&found(&touching, 10.0), &[(4.0 * half_pi, Touching)], 1e-11);
    let exponential = series(&[1.0]);
    assert_eq!(found(&exponential, 3.0), []);
    assert_eq!(found(&exponential, -3.0), []);
    let mut shifted = exponential.clone();
    shifted[0] -= 2.0;
    near(
        &found(&shifted, 3.0),
        &[(std::f64::consts::LN_2, Upwards)],
        1e-15,
    );
}

#[test]
fn derivatives_are_those_of_the_polynomial() {
    let p = [5.0, -3.0, 2.0, 7.0]; // 5 - 3 t + 2 t^2 + 7 t^3
    assert_eq!(evaluate(&p, 2.0), 63.0);
    assert_eq!(evaluate_derivative(&p, 0, 2.0), (63.0, 89.0));
    assert_eq!(evaluate_derivative(&p, 1, 2.0), (89.0, 88.0));
    assert_eq!(evaluate_derivative(&p, 3, 2.0), (42.0, 0.0));
    assert_eq!(evaluate_derivative(&p, 4, 2.0), (0.0, 0.0));
    assert_eq!(evaluate(&[], 2.0), 0.0);
}

#[test]
#[should_panic(expected = "degree 41 is above 40")]
fn higher_degrees_are_refused() {
    found(&[[1.0, -2.0].as_slice(), &[0.0; 39], &[1.0]].concat(), 1.0);
}

#[test]
fn zeros_above_the_degree_cost_nothing() {
    let long = [[0.5, -1.0].as_slice(), &[0.0; 60]].concat();
    near(&found(&long, 1.0), &[(0.5, Downwards)], 0.0);
}

#[test]
fn nothing_is_allocated() {
    let coefficients = with_roots(&[0.2, 0.5, 0.5, 0.7, 0.71, 2.0], 1.0);
    let mut found = Vec::with_capacity(8);
    let allocated = allocation_counter::measure(|| roots(&coefficients, 1.0, &mut found));
    assert_eq!(allocated.count_total, 0);
    assert_eq!(found.len(), 4);
}

/// Real roots in (0, 1), others outside, pairs a +- i b, and a factor.
type Construction = (Vec<f64>, Vec<f64>, Vec<(f64, f64)>, f64);

/// Polynomials of degree up to 24, some with close neighbours among the roots in (0, 1).
fn construction() -> impl Strategy<Value = Construction> {
    let inside = (
        0.001..0.9_f64,
        prop_oneof![Just(None), (-6.0..-1.1_f64).prop_map(Some)],
    );
    let inside = prop::collection::vec(inside, 0..5).prop_map(|chosen| {
        let mut all = Vec::new();
        for (root, gap) in chosen {
            all.push(root);
            all.extend(gap.map(|e| root + 10f64.powf(e)));
        }
        all.sort_by(f64::total_cmp);
        all
    });
    (
        inside,
        prop::collection::vec(prop_oneof![-3.0..-0.1_f64, 1.1..4.0_f64], 0..6),
        prop::collection::vec((-1.0..2.0_f64, 0.05..1.0_f64), 0..5),
        prop_oneof![-10.0..-0.1_f64, 0.1..10.0_f64],
    )
}

/// The product of with_roots and (t - a)^2 + b^2.
fn times_pairs(coefficients: &[f64], pairs: &[(f64, f64)]) -> Vec<f64> {
    let mut product: Vec<DoubleDouble> = coefficients.iter().map(|c| (*c).into()).collect();
    for (a, b) in pairs {
        let last = [DoubleDouble::ZERO; 2];
        let square = DoubleDouble::from(*a) * *a + DoubleDouble::from(*b) * *b;
        let old = [&last[..], &product, &last].concat();
        product = (0..product.len() + 2)
            .map(|k| old[k] - old[k + 1] * (2.0 * a) + old[k + 2] * square)
            .collect();
    }
    product.into_iter().map(DoubleDouble::to_f64).collect()
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 2000,
        max_global_rejects: 20_000,
        ..ProptestConfig::default()
    })]

    #[test]
    fn no_root_is_lost_or_doubled((inside, outside, pairs, factor) in construction()) {
        let real = [&inside[..], &outside].concat();
        let coefficients = times_pairs(&with_roots(&real, factor), &pairs);
        // roots are apart where |p| rises well above E between them, and between them and the ends
        let p = |t: f64| evaluate(&coefficients, t);
        let points: Vec<f64> = [&[0.0][..], &inside, &[1.0]].concat();
        let apart = points.windows(2).all(|w| p(0.5 * (w[0] + w[1])).abs() > 16.0 * rounding(&coefficients, w[1]));
        let ends = [0.0, 1.0].iter().all(|t| p(*t).abs() > 16.0 * rounding(&coefficients, *t));
        prop_assume!(apart && ends);
        let found = found(&coefficients, 1.0);
        prop_assert_eq!(found.len(), inside.len(), "{:?}", found);
        let mut sign = p(0.0).signum();
        for (root, at) in found.iter().zip(&inside) {
            let expected = if sign < 0.0 { Upwards } else { Downwards };
            prop_assert_eq!(root.crossing, expected);
            let slope = evaluate_derivative(&coefficients, 1, *at).0.abs();
            let off = (root.at - at).abs();
            prop_assert!(off <= 2.0 * rounding(&coefficients, *at) / slope, "{off:e}");
            sign = -sign;
        }
    }

    #[test]
    fn multiplicities_are_told(multiplicities in prop::collection::vec(1..4_usize, 1..4), gaps in prop::array::uniform3(0.1..0.33_f64), outside in prop::collection::vec(-3.0..-0.1_f64, 0..4)) {
        let mut at = 0.0;
        let (mut real, mut places) = (outside, Vec::new());
        for (multiplicity, gap) in multiplicities.iter().zip(gaps) {
            at += gap;
            places.push(at);
            real.extend(vec![at; *multiplicity]);
        }
        let coefficients = with_roots(&real, 1.0);
        let p = |t: f64| evaluate(&coefficients, t);
        let points: Vec<f64> = [&[0.0][..], &places, &[1.0]].concat();
        prop_assume!(points.windows(2).all(|w| p(0.5 * (w[0] + w[1])).abs() > 1e3 * rounding(&coefficients, w[1])));
        let found = found(&coefficients, 1.0);
        prop_assert_eq!(found.len(), places.len(), "{:?} {:?}", real, found);
        for ((root, at), multiplicity) in found.iter().zip(&places).zip(&multiplicities) {
            prop_assert_eq!(root.crossing == Touching, multiplicity % 2 == 0, "{:?} {:?}", real, found);
            prop_assert!((root.at - at).abs() < 1e-6, "{:?} {:?}", real, found);
        }
    }

    #[test]
    fn lengths_and_values_scale_away((inside, outside, pairs, factor) in construction(), shift in -26..27, value in -200..200) {
        let real = [&inside[..], &outside].concat();
        let coefficients = times_pairs(&with_roots(&real, factor), &pairs);
        let unit = found(&coefficients, 1.0);
        // exactly by powers of two
        let (length, size) = (2f64.powi(shift), 2f64.powi(value));
        let scaled: Vec<f64> = coefficients.iter().enumerate().map(|(k, c)| c * size * length.powi(-(k as i32))).collect();
        let expected: Vec<Root> = unit.iter().map(|r| Root { at: r.at * length, ..*r }).collect();
        prop_assert_eq!(found(&scaled, length), expected);
        // and by reflection
        let mirrored: Vec<f64> = coefficients.iter().enumerate().map(|(k, c)| if k % 2 == 0 { *c } else { -c }).collect();
        let turned = |c| match c { Upwards => Downwards, Downwards => Upwards, Touching => Touching };
        let expected: Vec<Root> = unit.iter().map(|r| Root { at: -r.at, crossing: turned(r.crossing) }).collect();
        prop_assert_eq!(found(&mirrored, -1.0), expected);
    }

    #[test]
    fn consecutive_steps_share_no_crossing((inside, outside, pairs, factor) in construction(), cut in 0.1..0.9_f64, at_root in any::<bool>(), ulps in -2..3) {
        let real = [&inside[..], &outside].concat();
        let coefficients = times_pairs(&with_roots(&real, factor), &pairs);
        // the cut is anywhere, or within rounding of a root
        let first = found(&coefficients, 1.0);
        let mut cut = first.first().filter(|_| at_root).map_or(cut, |r| r.at);
        for _ in 0..ulps { cut = cut.next_up(); }
        for _ in ulps..0 { cut = cut.next_down(); }
        let mut next = coefficients.clone();
        for j in 0..next.len() {
            for k in (j..next.len() - 1).rev() { next[k] += cut * next[k + 1]; }
        }
        // as the step before ended
        next[0] = evaluate(&coefficients, cut);
        if let Some(slope) = next.get_mut(1) { *slope = evaluate_derivative(&coefficients, 1, cut).0; }
        let (before, after) = (found(&coefficients, cut), found(&next, 1.0 - cut));
        let mut sign = coefficients[0].signum();
        for root in before.iter().chain(&after).filter(|r| r.crossing != Touching) {
            prop_assert_eq!(root.crossing, if sign < 0.0 { Upwards } else { Downwards }, "{:?} {:?}", before, after);
            sign = -sign;
        }
        let end = evaluate(&next, 1.0 - cut);
        prop_assert!(end == 0.0 || sign == end.signum());
    }

    #[test]
    fn anything_gives_finite_roots_in_order(coefficients in prop::collection::vec(any::<f64>(), 0..41), length in any::<f64>()) {
        let found = found(&coefficients, length);
        prop_assert!(found.iter().all(|root| root.at.is_finite()));
        prop_assert!(found.len() <= 40);
    }

    #[test]
    fn long_sums_of_any_signs_alternate(coefficients in prop::collection::vec(-1.0..1.0_f64, 1..41), length in 0.5..1.5_f64) {
        let found = found(&coefficients, length);
        let mut sign = coefficients[0].signum();
        for root in found.iter().filter(|r| r.crossing != Touching) {
            prop_assert_eq!(root.crossing, if sign < 0.0 { Upwards } else { Downwards });
            sign = -sign;
        }
        prop_assert!(sign == evaluate(&coefficients, length).signum());
        // as many changes of sign as a fine grid shows
        let values: Vec<f64> = (0..=2000).map(|i| evaluate(&coefficients, length * f64::from(i) / 2000.0)).collect();
        let seen = values.windows(2).filter(|w| w[0] * w[1] < 0.0).count();
        let crossings = found.iter().filter(|r| r.crossing != Touching).count();
        prop_assert!(crossings >= seen, "{seen} {found:?}");
    }
}
