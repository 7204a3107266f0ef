//! What is known of a number by the members of an ensemble.

use nalgebra::DMatrix;
use twinslip_cli::internals::{DEVIATIONS, Item, Measured, Sample, Sides, bands, matched, normal};

fn items(all: &[(&str, f64)]) -> Vec<Item> {
    let item = |&(class, place): &(&str, f64)| Item {
        class: class.into(),
        place: vec![place],
        numbers: vec![],
        holds: false,
    };
    all.iter().map(item).collect()
}

#[test]
fn equally_many_are_the_same_in_their_order() {
    let these = items(&[("HB", 2.0), ("BP", 5.0), ("HB", 1.0)]);
    let others = items(&[("HB", 7.0), ("HB", 9.0), ("LP", 5.0)]);
    assert_eq!(matched(&these, &others), [Some(1), None, Some(0)]);
}

#[test]
fn else_those_are_the_same_that_are_nearest_to_each_other() {
    let these = items(&[("HB", 1.0), ("HB", 2.0)]);
    assert_eq!(matched(&these, &items(&[("HB", 2.2)])), [None, Some(0)]);
    let more = items(&[("HB", 0.9), ("HB", 1.8), ("HB", 40.0)]);
    assert_eq!(matched(&these, &more), [Some(0), Some(1)]);
    assert_eq!(matched(&these, &[]), [None, None]);
}

fn item(value: f64, log: bool) -> Item {
    Item {
        class: "one".into(),
        place: vec![],
        numbers: vec![Measured {
            name: "x".into(),
            value,
            log,
        }],
        holds: true,
    }
}

#[test]
fn a_linear_number_has_the_band_of_its_covariance() {
    // x = 2 + 3 z_1 - z_2 with a correlation of 1/2: a variance of 9 + 1 - 3.
    let value = |z: [f64; 2]| 2.0 + 3.0 * z[0] - z[1];
    let estimate = [item(value([0.0; 2]), false)];
    let sample = |z| Some(Sample::of(&estimate, &[item(value(z), false)]));
    let sides = [
        Sides {
            samples: [sample([-0.1, 0.0]), sample([0.1, 0.0])],
            step: 0.1,
        },
        Sides {
            samples: [sample([0.0, -0.1]), sample([0.0, 0.1])],
            step: 0.1,
        },
    ];
    let correlation = DMatrix::from_row_slice(2, 2, &[1.0, 0.5, 0.5, 1.0]);
    let (found, check) = bands(&estimate, (&sides, &correlation), &[]);
    let [low, high] = found[0].bands[0].linear.expect("a band");
    let half = DEVIATIONS * 7_f64.sqrt();
    assert!((low - (2.0 - half)).abs() < 1e-12 && (high - (2.0 + half)).abs() < 1e-12);
    assert_eq!((found[0].probability, check.at), (None, None));
}

#[test]
fn what_some_draws_do_not_have_spoils_no_band() {
    let estimate = [item(1.0, true)];
    let with = |i: usize| Sample::of(&estimate, &[item((i as f64).exp(), true)]);
    let draws: Vec<Sample> = (0..=100)
        .flat_map(|i| [with(i), Sample::of(&estimate, &[])])
        .collect();
    let (found, _) = bands(&estimate, (&[], &DMatrix::zeros(0, 0)), &draws);
    let [low, high] = found[0].bands[0].draws.expect("enough draws");
    assert!((low.ln() - 2.5).abs() < 1e-12 && (high.ln() - 97.5).abs() < 1e-12);
    assert_eq!(
        (found[0].probability, found[0].holds),
        (Some(0.5), Some(0.5))
    );
}

#[test]
fn they_have_the_moments_of_a_normal_distribution() {
    let all: Vec<f64> = (0..20_000).map(|draw| normal(draw, 2)[1]).collect();
    let mean = |power: i32| all.iter().map(|x| x.powi(power)).sum::<f64>() / all.len() as f64;
    // Five standard errors of each: of x, x^2, x^3 and x^4, whose variances are 1, 2, 15 and 96.
    let bound = |variance: f64| 5.0 * (variance / all.len() as f64).sqrt();
    assert!(mean(1).abs() < bound(1.0));
    assert!((mean(2) - 1.0).abs() < bound(2.0));
    assert!(mean(3).abs() < bound(15.0));
    assert!((mean(4) - 3.0).abs() < bound(96.0));
}
