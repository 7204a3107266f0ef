//! What the friction laws alone decide: sections 2 and 4.1.

use super::exact::{self, Strength};
use super::{Answer, Entry, holds, missing, of_rounded_parameters};
use crate::Pieces;
use twinslip::error::Result;
use twinslip::friction::{Extremum, Parameters};
use twinslip::number::{DoubleDouble, Uncertain};

/// V* in m/s; a; a_v; b; R, of Heslot et al. (1994).
const REFERENCE_RATE: f64 = 1e-6;
const A: f64 = 0.0349;
const A_V: f64 = 0.369;
const B: f64 = 0.0489;
const R: f64 = 100.0;
/// The words of every second computation here.
const DIGITS_31: &str = "Newton's method in 31 digits, decimal parameters";

fn scaled(x: Uncertain, factor: f64) -> Uncertain {
    of_rounded_parameters(Uncertain::new(x.value * factor, x.uncertainty * factor))
}

fn exactly(x: DoubleDouble) -> Answer {
    // The double next to it.
    let value = x.to_f64();
    Answer::Number(Uncertain::new(value, f64::EPSILON * value.abs()))
}

/// V_M and mu_ss(V_M) of law (6), and the bounds after (7).
pub fn of_section_2(_: &Pieces<'_>) -> Result<Vec<Entry>> {
    let law = Parameters::heslot_1994().bounded();
    let maximum = Extremum::all(&law).into_iter().next();
    let maximum = maximum.ok_or_else(|| missing("law (6) has no maximum"))?;
    let again = Strength::None.extremum(maximum.slip_rate.value);
    let mu = scaled(maximum.stress, A);
    let mu_again = Strength::None.steady_stress(again) * exact::direct_effect();
    let upper = A_V - (B - A) * (B / (B - A) / R).ln();
    let between = A_V < mu.value - mu.uncertainty && mu.value + mu.uncertainty < upper;
    Ok(vec![
        Entry::number(
            ("V_M-of-law-6", "Fig. 1, caption; (7)"),
            "V_M of law (6), t** = 100 t*",
            "m/s",
            "2.49e-8",
            scaled(maximum.slip_rate, REFERENCE_RATE),
        )
        .beside(DIGITS_31, exactly(again / 1e6)),
        Entry::number(
            ("mu-maximum-of-law-6", "Fig. 1, caption"),
            "mu_ss(V_M) of law (6)",
            "",
            "0.405",
            mu,
        )
        .beside(DIGITS_31, exactly(mu_again)),
        Entry::claim(
            ("bounds-of-the-maximum", "section 2, after (7)"),
            "a_v < tau_ss(V_M)/sigma < a_v - (b-a) ln[b/(b-a) L/(V* t**)]",
            "holds",
            holds(between),
        )
        .noted(format!("{A_V} < {:.5} < {upper:.5}", mu.value)),
    ])
}

/// Where the approximations are printed.
const PLACE: &str = "section 4.1, after (36)";

/// The extrema of the spinodal law.
pub fn of_section_4(pieces: &Pieces<'_>) -> Result<Vec<Entry>> {
    let [maximum, minimum] = Extremum::all(&pieces.law())[..] else {
        return Err(missing("the spinodal law has no two extrema"));
    };
    let near = |e: Extremum| Strength::Residual.extremum(e.slip_rate.value);
    let peak = near(maximum);
    let mu = Strength::Residual.steady_stress(peak) * exact::direct_effect();
    let approximate = 1.0 / (R * (B / A - 1.0));
    let entry = |id, quantity, printed, x| Entry::number((id, PLACE), quantity, "V*", printed, x);
    let rates = [maximum, minimum].map(|e| of_rounded_parameters(e.slip_rate));
    let of_mu = ("mu-maximum", "section 4.1; Fig. 4");
    let mu_words = "mu_ss(V_M) of law (35)";
    Ok(vec![
        entry("V_M", "V_M of law (35)", "0.025", rates[0])
            .beside(DIGITS_31, exactly(peak))
            .noted(format!(
                "the approximation 1/(R (beta-1)) gives {approximate:.7}"
            )),
        entry("V_m", "V_m of law (35)", "405.16", rates[1])
            .beside(DIGITS_31, exactly(near(minimum)))
            .noted("the printed number is that of the approximation"),
        approximate_minimum(),
        Entry::number(of_mu, mu_words, "", "0.405", scaled(maximum.stress, A))
            .beside(DIGITS_31, exactly(mu)),
    ])
}

/// V_m ~ (1+R)(beta-1)/(R c)
fn approximate_minimum() -> Entry {
    let near = (1.0 + R) * (B / A - 1.0) / (R * 1e-3);
    let less_one = exact::beta::<DoubleDouble>() - 1.0;
    Entry::number(
        ("V_m-approximate", PLACE),
        "(1+R)(beta-1)/(R c), to which V_m comes near",
        "V*",
        "405.16",
        of_rounded_parameters(Uncertain::new(near, 0.0)),
    )
    .beside("31 digits, decimal parameters", exactly(less_one * 1.01e3))
    .noted(
        "the formula is garbled in the text at hand, 1 + R beta - 1/(R c); this one is the limit \
         of the larger root for small c",
    )
}
