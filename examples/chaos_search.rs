//! Searches for chaos: a map of regimes between the torus and the period-doubling curves, with the largest Lyapunov
//! exponents across the flow, as CSV on standard output. A minute or two.
//!
//! ```sh
//! cargo run --release --example chaos_search > docs/chaos.csv
//! ```

use twinslip::Result;
use twinslip::field::State;
use twinslip::friction::{AnyLaw, Law, Parameters};
use twinslip::integrate::{Choice, Control, MAX_STEPS, Tolerances};
use twinslip::model::{Driven, Loading, single_interface, two_interfaces};
use twinslip::number::polynomial::Crossing;
use twinslip::section::{
    Ended, FEWEST_FOR_EXPONENTS, Surface, Watching, half_driving_stress, record, spectrum, verdict,
};

/// Returns let pass and recorded at every point.
const SKIP: usize = 1000;
const RETURNS: usize = 1200;
/// The tolerance of the runs.
const RTOL: f64 = 1e-9;

/// A case by its law's name, (K, V_H) and the asymmetry of the start.
type Case<'a> = (&'a str, f64, f64, f64);

fn row<const N: usize>(
    case: Case<'_>,
    interfaces: usize,
    field: &dyn Driven<N>,
    start: State<N>,
    tau: f64,
) -> Result<()> {
    let (law, k, v, _) = case;
    let surface = Surface::<N>::stress(tau, Crossing::Downwards);
    let watching = Watching {
        skip: SKIP,
        returns: RETURNS,
        patience: 1e4 + 1e3 / (k * v),
        accuracy: RTOL,
        waypoints: true,
    };
    let mut auto = Choice::Auto.integrator::<N>(Tolerances::equal(RTOL)?, MAX_STEPS)?;
    let see = &mut |_: usize, _: Option<&_>| Control::Continue;
    let record = record(&mut *auto, field, &start, &surface, &watching, see);
    if let Ended::Failed(error) = &record.ended {
        let text = error.to_string();
        let what = text.split([';', ',']).next().unwrap_or_default();
        println!("{law},{interfaces},{k},{v},none,,,,{what}");
        return Ok(());
    }
    let found = if record.returns.len() >= FEWEST_FOR_EXPONENTS {
        Some(spectrum(field, &record)?)
    } else {
        None
    };
    let known = found.as_ref().map(|found| found.known());
    let made = verdict(field, &surface, &record, known)?;
    let q = made
        .periodic
        .map_or(String::new(), |p| p.returns.to_string());
    let largest = found.map_or(",".to_owned(), |found| {
        let x = found.exponents[0];
        format!("{:.3e},{:.1e}", x.value, x.uncertainty)
    });
    println!(
        "{law},{interfaces},{k},{v},{},{q},{largest},",
        made.regime.name()
    );
    Ok(())
}

fn two(case: Case<'_>) -> Result<()> {
    let (name, k, v, asymmetry) = case;
    let law = AnyLaw::named(name, Parameters::heslot_1994())?;
    let field = two_interfaces(law, Loading::new(v, k)?);
    let tau = half_driving_stress(&law, v, 2);
    let w = law.steady_state(0.5 * v).ln();
    row::<3>(
        case,
        2,
        &*field,
        State::<3>::new(tau, w, w + asymmetry),
        tau,
    )
}

fn one(case: Case<'_>) -> Result<()> {
    let (name, k, v, asymmetry) = case;
    let law = AnyLaw::named(name, Parameters::heslot_1994())?;
    let field = single_interface(law, Loading::new(v, k)?);
    let tau = half_driving_stress(&law, v, 1);
    let w = law.steady_state(v).ln();
    row::<2>(case, 1, &*field, State::<2>::new(tau, w + asymmetry), tau)
}

fn main() -> Result<()> {
    println!(
        "law,interfaces,stiffness,driving,regime,period_of_orbit,lyapunov_max,lyapunov_max_uncertainty,error"
    );
    for k in 0..=16 {
        let stiffness = 0.12 + 0.005 * f64::from(k);
        for i in 0..=22 {
            let driving = 0.07 + 0.002 * f64::from(i);
            let round = |x: f64| (x * 1e6).round() / 1e6;
            two(("spinodal", round(stiffness), round(driving), 0.3))?;
        }
    }
    // Two Dieterich-Ruina interfaces oscillate only below K_c = 0.401 (Fig. 3), one only below its critical stiffness.
    for k in [0.36, 0.37, 0.38, 0.39, 0.395, 0.399] {
        two(("dieterich-ruina", k, 1.0, 0.01))?;
    }
    for (name, k, v) in [
        ("dieterich-ruina", 0.39, 1.0),
        ("spinodal", 0.2, 0.1),
        ("spinodal", 0.1, 1.0),
        ("bounded", 0.1, 1.0),
        ("regularised-ageing", 0.39, 1.0),
    ] {
        one((name, k, v, 0.01))?;
    }
    Ok(())
}
