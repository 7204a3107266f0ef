//! Searches for chaos: a map of regimes between the torus and the period-doubling curves, with the largest Lyapunov
//! exponents across the flow, as CSV on standard output. What `twinslip section --lyapunov` says at each point; some minutes.
//!
//! ```sh
//! cargo run --release --example chaos_search > docs/chaos.csv
//! ```
//!
//! With pairs K,V_H as arguments, the rows of these points alone.

use clap::Parser;
use twinslip::Result;
use twinslip::friction::{AnyLaw, Formulas, Parameters};
use twinslip::integrate::Control;
use twinslip::section::half_driving_stress;
use twinslip_tasks::scene::{SectionOptions, SectionPlan, Sink, run_section};

/// Returns let pass and recorded at every point, and the tolerance of the runs.
const NUMERICS: &str = "--lyapunov --skip 1000 --returns 1200 --rtol 1e-9";

#[derive(Parser)]
struct Line {
    #[command(flatten)]
    options: SectionOptions,
}

/// The returns themselves are not wanted.
struct Nobody;

impl Sink for Nobody {
    fn row(&mut self, _: &[f64]) -> Control {
        Control::Continue
    }

    fn reached(&mut self, _: f64) -> Control {
        Control::Continue
    }
}

/// The row of a law, K and V_H, from interfaces whose psi is off the steady state by the exponential of this, the last of them.
fn row(law: &str, interfaces: usize, (k, v): (f64, f64), off: f64) -> Result<()> {
    let of = AnyLaw::named(law, Parameters::heslot_1994())?;
    let tau = half_driving_stress(&of, v, interfaces);
    let psi = of.steady_state(v / interfaces as f64);
    let last = (psi.ln() + off).exp();
    let start = match interfaces {
        1 => format!("{tau:?},{last:?}"),
        _ => format!("{tau:?},{psi:?},{last:?}"),
    };
    let words = format!(
        "section --law {law} --interfaces {interfaces} --driving {v} --stiffness {k} --start {start} {NUMERICS}"
    );
    let plan = SectionPlan::new(&Line::parse_from(words.split(' ')).options)?;
    let found = run_section(&plan, &mut Nobody)?;
    if let Some(error) = found.failure {
        let text = error.to_string();
        let what = text.split([';', ',']).next().unwrap_or_default();
        println!("{law},{interfaces},{k},{v},none,,,,{what}");
        return Ok(());
    }
    let q = found
        .period_of_orbit
        .map_or(String::new(), |q| q.to_string());
    let largest = found.lyapunov.and_then(|found| found.across_flow);
    let largest = largest.map_or(",".to_owned(), |x| {
        format!("{:.3e},{:.1e}", x.value, x.uncertainty)
    });
    let regime = found.regime.name();
    println!("{law},{interfaces},{k},{v},{regime},{q},{largest},");
    Ok(())
}

fn main() -> Result<()> {
    println!(
        "law,interfaces,stiffness,driving,regime,period_of_orbit,lyapunov_max,lyapunov_max_uncertainty,error"
    );
    let pairs: Vec<String> = std::env::args().skip(1).collect();
    for pair in &pairs {
        let numbers: Vec<f64> = pair.split(',').filter_map(|x| x.parse().ok()).collect();
        if let [k, v] = numbers[..] {
            row("spinodal", 2, (k, v), 0.3)?;
        }
    }
    if !pairs.is_empty() {
        return Ok(());
    }
    for k in 0..=16 {
        let stiffness = 0.12 + 0.005 * f64::from(k);
        for i in 0..=22 {
            let driving = 0.07 + 0.002 * f64::from(i);
            let round = |x: f64| (x * 1e6).round() / 1e6;
            row("spinodal", 2, (round(stiffness), round(driving)), 0.3)?;
        }
    }
    // Two Dieterich-Ruina interfaces oscillate only below K_c = 0.401 (Fig. 3), one only below its critical stiffness.
    for k in [0.36, 0.37, 0.38, 0.39, 0.395, 0.399] {
        row("dieterich-ruina", 2, (k, 1.0), 0.01)?;
    }
    for (name, k, v) in [
        ("dieterich-ruina", 0.39, 1.0),
        ("spinodal", 0.2, 0.1),
        ("spinodal", 0.1, 1.0),
        ("bounded", 0.1, 1.0),
        ("regularised-ageing", 0.39, 1.0),
    ] {
        row(name, 1, (k, v), 0.01)?;
    }
    Ok(())
}
