//! Pictures of steady states: the states with their stability, and the eigenvalues.

use super::diagram::{axis_label, parameters, value};
use super::many::nominal;
use super::text::with_parameters;
use crate::scene::{
    ClassifiedEquilibrium, Described, EquilibriaPlan, FoundManyEquilibrium, ManyEquilibriumPlan,
    Quantity, TextEquilibrium, TextModel,
};
use nalgebra::Complex;
use twinslip::equilibrium::Verdict;
use twinslip_output::plot::{Axis, Drawing, Key, Mark, Panel, PlotSeries, Symbol};

/// Symbols and colours of the first, second and further state variables.
const SYMBOLS: [Symbol; 4] = [
    Symbol::Circle,
    Symbol::Diamond,
    Symbol::Square,
    Symbol::Triangle,
];
/// Of state variables that are equal.
const ALIKE: (Symbol, usize) = (Symbol::Star, 7);
/// Grey, of what is undecided.
const GREY: usize = 6;

/// A steady state as a picture shows it.
struct Shown {
    /// Where it stands on the horizontal axis.
    at: f64,
    /// What is drawn of it on the vertical one.
    values: Vec<f64>,
    eigenvalues: Vec<Complex<f64>>,
    /// Where it is known.
    verdict: Option<Verdict>,
}

/// The states of equal interfaces, or of two that differ, against the stress. None where there is no steady state.
pub fn picture_of_equilibria(
    plan: &EquilibriaPlan,
    found: &[ClassifiedEquilibrium],
) -> Option<Drawing> {
    let (system, units) = (&plan.system, &plan.system.units);
    let growth = |z: Complex<f64>| {
        Complex::new(
            units.outward(Quantity::Growth, z.re),
            units.outward(Quantity::Growth, z.im),
        )
    };
    let shown = |one: &ClassifiedEquilibrium| {
        let states = one.equilibrium.state().into_iter();
        let known = one.stability.iter();
        let eigenvalues = known.flat_map(|known| &known.eigenvalues);
        Shown {
            at: units.outward(Quantity::Stress, one.equilibrium.stress.value),
            values: states.map(|x| units.outward(Quantity::State, x)).collect(),
            eigenvalues: eigenvalues.map(|one| growth(one.value)).collect(),
            verdict: one.stability.as_ref().map(|stability| stability.verdict),
        }
    };
    let kind = if system.interfaces > 2 {
        "cluster"
    } else {
        "interface"
    };
    let title = match system.stiffness {
        Some(stiffness) => parameters(plan.driving, stiffness, units),
        None => value("V_H", Quantity::SlipRate, plan.driving, units),
    };
    let shown: Vec<Shown> = found.iter().map(shown).collect();
    drawing(
        &shown,
        format!("steady states at {title}"),
        Axis::linear(axis_label("stress τ", Quantity::Stress, units)),
        Axis::log(axis_label("state ψ", Quantity::State, units)),
        &|i| format!("{kind} {}", i + 1),
        &axis_label("|Re λ|", Quantity::Growth, units),
    )
}

/// Those of a system from a file: of interfaces as of built-in ones, else the second state against the first.
pub fn picture_of_text_equilibria(model: &TextModel, found: &[TextEquilibrium]) -> Option<Drawing> {
    let states = model.system.states();
    let (slides, units) = (model.slab.is_some(), model.units());
    let shown = |(i, one): (usize, &TextEquilibrium)| {
        let state = |i: usize| one.state[i].value;
        let (at, values) = match (slides, states.len()) {
            (true, _) => {
                let psi = (1..=one.slip_rate.len()).map(|i| {
                    let w = units.outward(Quantity::LogState, state(i));
                    w.exp()
                });
                (units.outward(Quantity::Stress, state(0)), psi.collect())
            }
            (false, 1) => ((i + 1) as f64, vec![state(0)]),
            (false, _) => (state(0), vec![state(1)]),
        };
        Shown {
            at,
            values,
            eigenvalues: {
                let all = one.stability.eigenvalues.iter();
                all.map(|z| z * units.factor(Quantity::Growth)).collect()
            },
            verdict: Some(one.stability.verdict),
        }
    };
    let shown: Vec<Shown> = found.iter().enumerate().map(shown).collect();
    let (x, y) = match (slides, states) {
        (true, _) => (
            Axis::linear(axis_label("stress τ", Quantity::Stress, units)),
            Axis::log(axis_label("state ψ", Quantity::State, units)),
        ),
        (false, [first, second, ..]) => (Axis::linear(*first), Axis::linear(*second)),
        (false, rest) => (
            Axis::linear("number of the equilibrium"),
            Axis::linear(rest.first().copied().unwrap_or_default()),
        ),
    };
    let title = format!("equilibria of {}", with_parameters(model));
    let name = |i: usize| format!("interface {}", i + 1);
    drawing(
        &shown,
        title,
        x,
        y,
        &name,
        &axis_label("|Re λ|", Quantity::Growth, units),
    )
}

/// An entry of the legend: shape, whether it is filled, colour and words.
fn key((symbol, filled, colour): (Symbol, bool, usize), label: &str) -> Key {
    Key {
        symbol,
        filled,
        colour: Some(colour),
        label: label.to_owned(),
    }
}

/// The state variables with their stability above, the eigenvalues below, where there are any.
fn drawing(
    shown: &[Shown],
    title: String,
    x: Axis,
    y: Axis,
    name: &dyn Fn(usize) -> String,
    growth: &str,
) -> Option<Drawing> {
    let variables = shown.iter().map(|one| one.values.len()).max()?;
    let look = |i: usize| (SYMBOLS[i % SYMBOLS.len()], i);
    let mut states = Panel::new(title, x.clone(), y);
    for (number, one) in shown.iter().enumerate() {
        let equal = variables > 1 && one.values.windows(2).all(|pair| pair[0] == pair[1]);
        // Of equal ones one is seen: the others would hide it.
        let all = one.values.iter().take(if equal { 1 } else { variables });
        for (i, &y) in all.enumerate() {
            let (symbol, colour) = match equal {
                true => ALIKE,
                false => look(i),
            };
            let label = match shown.len() {
                1 => String::new(),
                _ => (number + 1).to_string(),
            };
            let mark = Mark::new(one.at, y, label).symbol(symbol);
            states.marks.push(match one.verdict {
                Some(Verdict::Stable) | None => mark.colour(colour),
                Some(Verdict::Unstable) => mark.colour(colour).open(),
                Some(Verdict::Undecided) => mark.colour(GREY).open(),
            });
        }
    }
    if variables > 1 {
        let names = (0..variables).map(|i| {
            let (symbol, colour) = look(i);
            key((symbol, true, colour), &name(i))
        });
        states.keys.extend(names);
        let alike = states.marks.iter().any(|mark| mark.symbol == ALIKE.0);
        let name = key((ALIKE.0, true, ALIKE.1), "all alike");
        states.keys.extend(alike.then_some(name));
    }
    let verdicts = [
        (Verdict::Stable, true, 7, "stable"),
        (Verdict::Unstable, false, 7, "unstable"),
        (Verdict::Undecided, false, GREY, "undecided"),
    ];
    for (verdict, filled, colour, words) in verdicts {
        if shown.iter().any(|one| one.verdict == Some(verdict)) {
            let look = (Symbol::Circle, filled, colour);
            states.keys.push(key(look, words));
        }
    }
    let second = eigenvalues(shown, x, growth);
    let panels = [Some(states), second].into_iter().flatten().collect();
    Some(Drawing::columns(vec![panels]))
}

/// How fast each disturbance grows or decays: over many orders of magnitude, so that the sign is a matter of the symbol.
fn eigenvalues(shown: &[Shown], x: Axis, growth: &str) -> Option<Panel> {
    let mut panel = Panel::new("eigenvalues λ", x, Axis::log(growth));
    let mut kinds: Vec<(Symbol, bool)> = Vec::new();
    for (number, one) in shown.iter().enumerate() {
        // Of a complex pair one.
        for z in one
            .eigenvalues
            .iter()
            .filter(|z| z.im >= 0.0 && z.re != 0.0)
        {
            let symbol = match z.im > 0.0 {
                true => Symbol::Diamond,
                false => Symbol::Circle,
            };
            let (decays, label) = (z.re < 0.0, (number + 1).to_string());
            let label = if shown.len() == 1 {
                String::new()
            } else {
                label
            };
            let mark = Mark::new(one.at, z.re.abs(), label)
                .symbol(symbol)
                .colour(0);
            panel.marks.push(if decays { mark } else { mark.open() });
            if !kinds.contains(&(symbol, decays)) {
                kinds.push((symbol, decays));
            }
        }
    }
    let all = [
        (Symbol::Circle, true, "real, decays"),
        (Symbol::Circle, false, "real, grows"),
        (Symbol::Diamond, true, "complex pair, decays"),
        (Symbol::Diamond, false, "complex pair, grows"),
    ];
    let named = all
        .into_iter()
        .filter(|(symbol, decays, _)| kinds.contains(&(*symbol, *decays)));
    panel.keys = named
        .map(|(symbol, decays, words)| key((symbol, decays, 0), words))
        .collect();
    (!panel.marks.is_empty()).then_some(panel)
}

/// The slip rate and the state of each of many interfaces that differ, against the constants that are drawn.
pub fn picture_of_many_equilibrium(
    plan: &ManyEquilibriumPlan,
    found: &FoundManyEquilibrium,
) -> Drawing {
    /// Constants that have room beside each other.
    const MOST: usize = 3;
    let (units, equilibrium) = (&nominal(), &found.equilibrium);
    let stability = found.stability.map(|stability| stability.verdict.name());
    let title = format!(
        "{}{} interfaces at {}",
        stability.map_or(String::new(), |verdict| format!("{verdict}: ")),
        equilibrium.slip_rate.len(),
        value("τ", Quantity::Stress, equilibrium.stress.value, units)
    );
    let states: Vec<f64> = equilibrium.log_state.iter().map(|w| w.exp()).collect();
    let column = |(i, drawn): (usize, &crate::scene::Drawn)| {
        let panel = |title: String, y: Axis, values: &[f64]| Panel {
            series: vec![PlotSeries::dots("", drawn.values.clone(), values.to_vec()).colour(0)],
            ..Panel::new(title, Axis::linear(drawn.name), y)
        };
        let first = if i == 0 { title.clone() } else { String::new() };
        vec![
            panel(
                first,
                Axis::log(axis_label("slip rate v", Quantity::SlipRate, units)),
                &equilibrium.slip_rate,
            ),
            panel(
                String::new(),
                Axis::log(axis_label("state ψ", Quantity::State, units)),
                &states,
            ),
        ]
    };
    let drawn = plan.drawn.iter().take(MOST).enumerate();
    Drawing::columns(drawn.map(column).collect())
}
