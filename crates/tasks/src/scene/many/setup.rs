//! Many interfaces from options: what they are, which constants are drawn, and where they start.

use super::draw::{Draw, Drawn, InUnits};
use crate::scene::options::{DrawOptions, ModelOptions, SlabOptions};
use crate::scene::plan::{NEAR_SYMMETRIC, USUAL_START};
use crate::scene::system::HEALING_TIME;
use crate::scene::text::SPREAD;
use serde_json::{Map, Value, json};
use std::ops::Range;
use twinslip::error::{Error, Result};
use twinslip::friction::{AnyLaw, Formulas, Parameters, beside, positive};
use twinslip::many::{ManyInterfaces, OneOfMany, Processes, Share};
use twinslip::model::Loading;
use twinslip::random::Random;

/// What is asked for.
pub(super) struct Asked<'a> {
    /// What slides, by its final names.
    pub model: &'a ModelOptions,
    /// V_H and K.
    pub loading: Loading,
    /// The constants that are drawn, and the seed.
    pub draws: &'a DrawOptions,
    /// Where the interfaces start.
    pub start: Option<&'a str>,
    /// Who holds them.
    pub processes: Processes,
}

/// What slides, and where it starts.
pub(super) struct Setup {
    /// All, or the share of this process.
    pub interfaces: ManyInterfaces,
    /// tau, and psi of each held here.
    pub start: (f64, Vec<f64>),
    /// The constants that are drawn, of each held here.
    pub drawn: Vec<Drawn>,
    /// All options of the model.
    pub echo: Map<String, Value>,
}

impl Setup {
    /// Checks what is asked for.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(asked: &Asked<'_>) -> Result<Self> {
        let Asked {
            model,
            loading,
            draws: DrawOptions { draw, seed },
            ..
        } = *asked;
        refused(&model.slab)?;
        let count = model.slab.count() as usize;
        if count == 0 {
            return Err(Error::parameter("interfaces", count, "at least 1"));
        }
        let draws = draw.iter().map(|text| Draw::read(text));
        let draws = draws.collect::<Result<Vec<Draw>>>()?;
        for draw in &draws {
            draw.is_not_given(model)?;
        }
        let share = Share::new(count, asked.processes);
        let mut drawn: Vec<Drawn> = draws.iter().map(Draw::none_drawn).collect();
        let by = (&draws[..], *seed);
        let first = interfaces(&model.slab, by, 0..1, &mut drawn.clone())?[0];
        let all = interfaces(&model.slab, by, share.held(), &mut drawn)?;
        let interfaces = if draws.is_empty() {
            ManyInterfaces::alike_in(share, &first, loading)?
        } else {
            ManyInterfaces::new_in(share, all.iter().copied().map(Ok), loading)?
        };
        let driving = loading.driving;
        let start = start(asked.start, (&first, &all), (interfaces.share(), driving))?;
        Ok(Setup {
            interfaces,
            start,
            drawn,
            echo: echo(&model.slab, (count, driving, model.stiffness), by),
        })
    }
}

/// A positive number that has no default.
pub(super) fn needed(name: &str, value: Option<f64>) -> Result<f64> {
    match value {
        Some(value) => positive(name, value),
        None => Err(Error::Input(format!(
            "`{name}` is missing, and has no default"
        ))),
    }
}

/// What many interfaces do not have.
fn refused(slab: &SlabOptions) -> Result<()> {
    let numbered = |set: &String| {
        let name = set.split('=').next().unwrap_or_default();
        let index = name.rsplit('_').next().unwrap_or_default();
        !index.is_empty() && index.bytes().all(|c| c.is_ascii_digit())
    };
    let asked: [(&str, bool, &str); 4] = [
        (
            "law",
            slab.law_file().is_some(),
            "from a file can have at most 7 interfaces that move on their own",
        ),
        ("si", slab.si, "many interfaces are computed without units"),
        (
            "second_evolution_effect`, `second_slip_length`, `mass` and `modulate",
            slab.needs_formulas(&[])?,
            "many interfaces have one state variable, no mass and a constant normal stress; up to 7 may have these",
        ),
        (
            "set",
            slab.text.set.iter().any(numbered),
            "numbers of one interface are drawn, by `draw`, where there are many",
        ),
    ];
    match asked.into_iter().find(|(_, asked, _)| *asked) {
        Some((name, _, why)) => Err(Error::Input(format!("`{name}`: {why}"))),
        None => Ok(()),
    }
}

/// Each interface of a range; one alone where all are equal. What is drawn is told too.
fn interfaces(
    slab: &SlabOptions,
    (draws, seed): (&[Draw], u64),
    range: Range<usize>,
    drawn: &mut [Drawn],
) -> Result<Vec<OneOfMany>> {
    let damping = slab.damping.unwrap_or(0.0);
    let one = |own: &SlabOptions, units: InUnits| {
        let healing_time = own.healing_time.unwrap_or(HEALING_TIME);
        let parameters = Parameters::new(own.a(), own.b(), own.a_v(), healing_time, own.c())?;
        Ok(OneOfMany {
            law: AnyLaw::of_slip_length(&own.law, parameters, units.slip_length)?,
            damping,
            slip_length: units.slip_length,
            // both in units of the nominal a sigma
            stress_factor: slab.a() / (own.a() * units.normal_stress),
        })
    };
    if draws.is_empty() {
        return Ok(vec![one(slab, InUnits::default())?]);
    }
    // A stream for each constant: what one draws does not depend on the others.
    let mut streams: Vec<Random> = (1..=draws.len())
        .map(|stream| Random::new(seed, stream).after(range.start))
        .collect();
    let mut next = |_| {
        let (mut own, mut units) = (slab.clone(), InUnits::default());
        for ((draw, random), drawn) in draws.iter().zip(&mut streams).zip(&mut *drawn) {
            let value = draw.put(random, &mut own, &mut units);
            drawn.values.push(value);
        }
        one(&own, units)
    };
    range.map(&mut next).collect()
}

/// tau and psi of each, as `--start` gives them.
fn start(
    text: Option<&str>,
    (first, all): (&OneOfMany, &[OneOfMany]),
    (share, driving): (&Share, f64),
) -> Result<(f64, Vec<f64>)> {
    let (count, held) = (share.count(), share.held());
    let text = text.unwrap_or(SPREAD);
    let unreadable = || {
        Error::Input(format!(
            "`start` {text:?} must be TAU,PSI1,...,PSI{count}, {USUAL_START}[:EPS] or {SPREAD}[:EPS[:SEED]]"
        ))
    };
    let number = |part: &str| {
        let number = part.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        number.ok_or_else(unreadable)
    };
    let rate = driving / count as f64;
    let near = |moved: &mut dyn FnMut(usize) -> f64| {
        let state = |i: usize| {
            let one = &all[(i - held.start).min(all.len() - 1)];
            let steady = one.law.steady_state(rate / one.slip_length).ln();
            beside(&one.law, steady, moved(i)).exp()
        };
        let states = held.clone().map(state).collect();
        let steady = first.law.steady_state(rate / first.slip_length);
        let friction = first.law.stress(rate, steady) / first.stress_factor;
        (friction + first.damping * rate, states)
    };
    if let Some(rest) = text.strip_prefix(USUAL_START) {
        let by = match rest.strip_prefix(':') {
            Some(part) => number(part)?,
            None if rest.is_empty() => NEAR_SYMMETRIC,
            None => return Err(unreadable()),
        };
        return Ok(near(&mut |i| if i + 1 == count { by } else { 0.0 }));
    }
    if let Some(rest) = text.strip_prefix(SPREAD) {
        let parts: Vec<&str> = rest.split(':').collect();
        let (by, seed) = match parts[..] {
            [""] => (NEAR_SYMMETRIC, 1),
            ["", by] => (number(by)?, 1),
            ["", by, seed] => (number(by)?, seed.parse().map_err(|_| unreadable())?),
            _ => return Err(unreadable()),
        };
        let mut random = Random::new(seed, 0).after(held.start);
        return Ok(near(&mut |_| by * random.between((-1.0, 1.0))));
    }
    let numbers = text.split(',').map(number).collect::<Result<Vec<f64>>>()?;
    match numbers.split_first() {
        Some((&tau, states)) if states.len() == count => {
            for &psi in states {
                positive("psi in `start`", psi)?;
            }
            Ok((positive("tau in `start`", tau)?, states[held].to_vec()))
        }
        _ => Err(unreadable()),
    }
}

fn echo(
    slab: &SlabOptions,
    (count, driving, stiffness): (usize, f64, Option<f64>),
    (draws, seed): (&[Draw], u64),
) -> Map<String, Value> {
    let mut pairs = vec![
        ("law", json!(slab.law)),
        ("interfaces", json!(count)),
        ("driving", json!(driving)),
        ("stiffness", json!(stiffness)),
        (
            "healing_time",
            json!(slab.healing_time.unwrap_or(HEALING_TIME)),
        ),
        ("residual_strength", json!(slab.c())),
        ("direct_effect", json!(slab.a())),
        ("evolution_effect", json!(slab.b())),
        ("reference_friction", json!(slab.a_v())),
        ("damping", json!(slab.damping.unwrap_or(0.0))),
        ("si", json!(false)),
    ];
    if !draws.is_empty() {
        let told: Vec<String> = draws.iter().map(Draw::told).collect();
        pairs.extend([("draw", json!(told)), ("seed", json!(seed))]);
    }
    let pairs = pairs.into_iter();
    pairs
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}
