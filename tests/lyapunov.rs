//! Lyapunov exponents: systems where they are known, periodic orbits whose multipliers are, and what checks them.

use crate::common as shared;
use crate::common::lorenz;
use lorenz::{Field, Lorenz, Quadratic, Rotation};
use twinslip::Error;
use twinslip::field::Vector;
use twinslip::friction::{AnyLaw, Parameters};
use twinslip::integrate::{AnyField, AnyIntegrator, Choice, Control, MAX_STEPS, Tolerances};
use twinslip::model::{Loading, two_interfaces};
use twinslip::number::polynomial::Crossing;
use twinslip::section::{
    Ended, LyapunovSpectrum, Regime, ReturnRecord, SeriesVariables, Surface, Watching,
    at_equilibrium, record, spectrum, verdict,
};

const ACCURACY: f64 = 1e-12;

fn returns(
    field: &AnyField<'_>,
    start: [f64; 3],
    surface: &Surface,
    (skip, returns): (usize, usize),
) -> ReturnRecord {
    let watching = Watching {
        skip,
        returns,
        patience: 1e4,
        accuracy: ACCURACY,
        max_step: f64::INFINITY,
        waypoints: true,
    };
    let tolerances = Tolerances::equal(ACCURACY).unwrap();
    let mut taylor = AnyIntegrator::new(Choice::Taylor, tolerances, MAX_STEPS).unwrap();
    let start = Vector::from_column_slice(&start);
    let see = &mut |_: usize, _: Option<&_>| Control::Continue;
    let record = record(&mut taylor, field, &start, surface, &watching, see);
    assert_eq!(record.ended, Ended::Complete);
    assert!(taylor.work().steps > returns);
    record
}

fn system<Q: Quadratic + 'static>(of: Q) -> AnyField<'static> {
    AnyField::new::<3>(Box::new(Field(of)))
}

/// A plane x_i = offset of a system whose state is the variables themselves.
fn plane(i: usize, offset: f64) -> Surface {
    let mut normal = Vector::zeros(3);
    normal[i] = 1.0;
    Surface {
        normal,
        offset,
        direction: Crossing::Upwards,
        chart: SeriesVariables::Plain,
        turn: None,
    }
}

#[track_caller]
fn holds<const N: usize>(found: &LyapunovSpectrum, exact: [f64; N], within: f64) {
    assert_eq!(found.exponents.len(), N);
    for (found, exact) in found.exponents.iter().zip(exact) {
        let apart = (found.value - exact).abs();
        assert!(
            apart <= found.uncertainty,
            "{found:?} does not hold {exact}"
        );
        assert!(
            found.uncertainty < within,
            "{found:?} is wider than {within}"
        );
    }
}

/// Sprott, J. C. (2003). Chaos and Time-Series Analysis, table A.3: 0.9056, 0, -14.5723; their sum is -(10 + 1 + 8/3).
#[test]
fn lorenz() {
    let section = plane(2, 27.0);
    let (field, start) = (system(Lorenz), [1.0, 1.0, 27.5]);
    let run = returns(&field, start, &section, (100, 8000));
    let found = spectrum(&field, &run).unwrap();
    assert!(found.converged, "{found:?}");
    // The published digits err by half of the last one.
    let [first, flow, last] = found.exponents[..] else {
        panic!("{found:?}");
    };
    assert!(
        (first.value - 0.9056).abs() < first.uncertainty + 5e-5,
        "{first:?}"
    );
    assert!(
        (last.value + 14.5723).abs() < last.uncertainty + 5e-5,
        "{last:?}"
    );
    assert!(
        first.uncertainty < 0.02 && flow.value.abs() <= flow.uncertainty,
        "{found:?}"
    );
    assert!(
        found.along_flow.abs() < 1e-3 && found.liouville_defect.abs() < 1e-8,
        "{found:?}"
    );
    let sum: f64 = found.exponents.iter().map(|x| x.value).sum();
    assert!((sum + 41.0 / 3.0).abs() < 1e-9, "{sum}");
    let regime = verdict(&field, &section, &run, Some(found.known())).unwrap();
    assert_eq!(regime.regime, Regime::Chaotic, "{regime:?}");
    // Without exponents nobody says so.
    let regime = verdict(&field, &section, &run, None).unwrap();
    assert_eq!(regime.regime, Regime::Undecided);
}

/// Between the blocks of a chaotic run the means scatter as their interval says: those of other stretches lie within it.
#[test]
fn intervals_hold_for_other_stretches_of_the_same_run() {
    let (field, section) = (system(Lorenz), plane(2, 27.0));
    let mut outside = 0;
    for k in 0..20 {
        let start = [1.0 + 0.3 * f64::from(k), 1.0, 27.5];
        let run = returns(&field, start, &section, (50, 600));
        let first = spectrum(&field, &run).unwrap().exponents[0];
        outside += usize::from((first.value - 0.9056).abs() > first.uncertainty);
    }
    // At 99 % two of twenty outside have a chance of one in fifty.
    assert!(
        outside <= 1,
        "{outside} of 20 intervals do not hold the exponent"
    );
}

#[test]
fn a_rotation_with_a_decaying_direction() {
    let system = system(Rotation {
        frequency: 3.0,
        decay: 0.25,
    });
    let run = returns(&system, [1.0, -0.5, 1e-3], &plane(1, 0.0), (0, 400));
    let found = spectrum(&system, &run).unwrap();
    holds(&found, [0.0, 0.0, -0.25], 1e-8);
    assert!(found.converged);
}

#[test]
fn at_rest_they_are_the_real_parts_of_the_eigenvalues() {
    let system = system(Rotation {
        frequency: 3.0,
        decay: 0.25,
    });
    let found = at_equilibrium(&system, &Vector::zeros(3));
    assert_eq!(found.len(), 3);
    for (found, exact) in found.iter().zip([0.0, 0.0, -0.25]) {
        assert!((found.value - exact).abs() <= found.uncertainty);
    }
}

/// Those of a periodic orbit are 0 and ln|mu|/T, by the multipliers of an independent computation. A period and a section
/// that are not ours: the reference has the section crossed upwards.
#[test]
fn periodic_orbits_have_the_logarithms_of_their_multipliers() {
    let data = shared::data("multipliers.json");
    let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
    let mut met = 0;
    for orbit in data["orbits"].as_array().unwrap() {
        let at = |name: &str| shared::number(&orbit[name]);
        let (k, v, period) = (at("K"), at("V_H"), at("period"));
        let field = AnyField::new::<3>(two_interfaces(law, Loading::new(v, k).unwrap()));
        let start = [at("section tau_s"), at("psi1").ln(), at("psi2").ln()];
        let surface = Surface::stress(3, start[0], Crossing::Upwards);
        let run = returns(&field, start, &surface, (400, 200));
        let found = spectrum(&field, &run).unwrap();
        let ln_abs = |i: usize| {
            let (re, im) = shared::complex(&orbit["mu"][i]);
            re.hypot(im).ln()
        };
        let complex = orbit["mu"][0].as_str().unwrap().contains('j');
        let name = format!("K = {k}, V_H = {v}");
        let mean = run.returns.last().unwrap().time - run.returns[0].time;
        let q = (mean / period).round() as usize;
        assert_eq!(
            q,
            run.returns.len() - 1,
            "{name}: not the orbit of the reference"
        );
        // The second of a complex pair comes only as fast as the mean of a rotation.
        let within = if complex {
            0.2 / period
        } else {
            1e-5 * at("int_trJ").abs() / period
        };
        println!("{name}: {:?}", found.exponents);
        holds(
            &found,
            [0.0, ln_abs(0) / period, ln_abs(1) / period],
            within,
        );
        let sum: f64 = found.exponents.iter().map(|x| x.value).sum();
        assert!(
            (sum * period / at("int_trJ") - 1.0).abs() < 1e-8,
            "{name}: {sum}"
        );
        met += 1;
    }
    assert!(met >= 8);
}

#[test]
fn too_few_returns_are_refused() {
    let field = system(Lorenz);
    let run = returns(&field, [1.0, 1.0, 27.5], &plane(2, 27.0), (0, 30));
    let refused = spectrum(&field, &run);
    assert!(
        matches!(refused, Err(Error::Parameter { .. })),
        "{refused:?}"
    );
}

#[test]
fn returns_of_another_dimension_are_refused() {
    let (field, section) = (system(Lorenz), plane(2, 27.0));
    let mut run = returns(&field, [1.0, 1.0, 27.5], &section, (0, 80));
    run.returns[70].state = Vector::zeros(2);
    let refused = spectrum(&field, &run);
    assert!(
        matches!(refused, Err(Error::Parameter { .. })),
        "{refused:?}"
    );
    let refused = verdict(&field, &section, &run, None);
    assert!(
        matches!(refused, Err(Error::Parameter { .. })),
        "{refused:?}"
    );
}
