//! Equilibria of a user-defined system: the one near a start, or all in a box.

use super::model::{TextModel, number};
use crate::scene::options::EquilibriaOptions;
use crate::scene::system::Described;
use twinslip::equilibrium::{Enclosed, Stability, spectrum_within, zero_near, zeros_in_box};
use twinslip::error::{Error, Result};
use twinslip::field::Vector;
use twinslip::integrate::MotionUnits;
use twinslip::number::{Interval, Uncertain};

/// Equilibria that are asked for, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct TextEquilibriaPlan {
    /// The system.
    pub model: TextModel,
    /// Where they are looked for.
    pub place: SearchPlace,
}

/// Where equilibria are looked for.
#[derive(Debug, Clone, PartialEq)]
pub enum SearchPlace {
    /// Near a point.
    Near(Vector),
    /// In a box.
    Within(Vec<Interval>),
}

impl SearchPlace {
    /// In a box that a text gives: a range for every state.
    ///
    /// # Errors
    /// [`Error::Input`] and [`Error::Parameter`] for a text that gives none.
    pub fn within(text: &str, model: &TextModel) -> Result<Self> {
        Ok(SearchPlace::Within(ranges(text, model)?))
    }
}

/// An equilibrium.
#[derive(Debug, Clone, PartialEq)]
pub struct TextEquilibrium {
    /// The values of all states; their uncertainties are infinite where no box certainly holds exactly one equilibrium.
    pub state: Vec<Uncertain>,
    /// The slip rates of interfaces; none where nothing slides.
    pub slip_rate: Vec<f64>,
    /// Eigenvalues and verdict.
    pub stability: Stability,
    /// The largest rate there.
    pub residual: f64,
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct TextEquilibria {
    /// By the first state.
    pub equilibria: Vec<TextEquilibrium>,
    /// Boxes of which it is not known whether they have any.
    pub undecided: Vec<Vec<Interval>>,
}

impl TextEquilibriaPlan {
    /// Checks the options for this system.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(options: &EquilibriaOptions, model: TextModel) -> Result<Self> {
        if options.solver.is_some() {
            return Err(Error::Input(
                "`solver` is for built-in laws; steady states of a `system` or a `law` from a file are found in boxes".into(),
            ));
        }
        model.may_rest()?;
        let place = match &options.within {
            Some(text) => SearchPlace::within(text, &model)?,
            None if options.start.is_none() && model.slab.is_some() => {
                SearchPlace::Within(model.steady_box()?)
            }
            None => SearchPlace::Near(model.start(options.start.as_deref())?),
        };
        Ok(TextEquilibriaPlan { model, place })
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let search = match &self.place {
            SearchPlace::Near(_) => {
                "Newton's method from the start, then a box with exactly one zero"
            }
            SearchPlace::Within(_) => {
                "all in the box: bisection and Krawczyk's operator in interval arithmetic"
            }
        };
        format!(
            "plan of this command
  dimension         {}
  search            {search}
  stability         eigenvalues in discs by interval arithmetic",
            self.model.system.states().len()
        )
    }

    /// Finds them.
    ///
    /// # Errors
    /// [`Error::NotConverged`] where Newton's method finds none near the start.
    pub fn solve(&self) -> Result<TextEquilibria> {
        let system = &self.model.system;
        match &self.place {
            SearchPlace::Near(start) => {
                let at = self.newton(start)?;
                let found = match zero_near(system, at.as_slice()) {
                    Some(zero) => self.classified(&zero.at, Some(&zero.within)),
                    None => self.classified(at.as_slice(), None),
                };
                Ok(TextEquilibria {
                    equilibria: vec![found],
                    undecided: Vec::new(),
                })
            }
            SearchPlace::Within(all) => {
                let found = zeros_in_box(system, all);
                let zeros = found.zeros.iter();
                Ok(TextEquilibria {
                    equilibria: zeros
                        .map(|zero| self.classified(&zero.at, Some(&zero.within)))
                        .collect(),
                    undecided: found.undecided,
                })
            }
        }
    }

    fn newton(&self, start: &Vector) -> Result<Vector> {
        const ITERATIONS: usize = 200;
        /// Relative to |x| and to how far a state moves, a step that is the last; or where steps no longer shrink.
        const DONE: f64 = 1e-15;
        const NOISE: f64 = 1e-9;
        let field = self.model.field()?;
        let units = match self.model.slab {
            Some(_) => MotionUnits::given(start.len()),
            None => MotionUnits::at_start(&self.model.system, start)?,
        };
        let (mut at, mut last) = (start.clone(), f64::INFINITY);
        for _ in 0..ITERATIONS {
            let Some(step) = field.newton_step(at.as_slice()) else {
                break;
            };
            at -= &step;
            let parts = step.iter().zip(&at).zip(&units.sizes);
            let parts = parts.map(|((dx, x), size)| dx.abs() / (size + x.abs()));
            let size = parts.fold(0.0, f64::max);
            if size < DONE || (size < NOISE && size >= 0.5 * last) {
                return Ok(at);
            }
            last = size;
        }
        Err(Error::NotConverged {
            what: "Newton's method for an equilibrium near `start`",
            iterations: ITERATIONS,
            residual: last,
            tolerance: DONE,
        })
    }

    fn classified(&self, at: &[f64], within: Option<&Vec<Interval>>) -> TextEquilibrium {
        let system = &self.model.system;
        let here: Vec<Interval> = at.iter().map(|&x| Interval::new(x, x)).collect();
        let error = |i: usize, x: f64| within.map_or(f64::INFINITY, |all| all[i].distance_from(x));
        let state = at.iter().enumerate();
        let mut stability = spectrum_within(&Enclosed::jacobian(system, within.unwrap_or(&here)));
        if within.is_none() {
            stability.verdict = twinslip::equilibrium::Verdict::Undecided;
            stability.uncertainty.fill(f64::INFINITY);
        }
        TextEquilibrium {
            slip_rate: system.slip_rates(at),
            state: state
                .map(|(i, &x)| Uncertain::new(x, error(i, x)))
                .collect(),
            stability,
            residual: system
                .rates(at)
                .iter()
                .fold(0.0, |most, f| f.abs().max(most)),
        }
    }
}

/// A range for every state.
fn ranges(text: &str, model: &TextModel) -> Result<Vec<Interval>> {
    let states = model.system.states();
    let mut all: Vec<Option<Interval>> = vec![None; states.len()];
    for part in text.split(',') {
        let read = part.split_once('=').and_then(|(name, range)| {
            let (low, high) = range.split_once(':')?;
            Some((name.trim(), number(low)?, number(high)?))
        });
        let Some((name, low, high)) = read else {
            return Err(Error::Input(format!(
                "`box` {text:?}: {part:?} must be STATE=LOW:HIGH"
            )));
        };
        if low >= high {
            return Err(Error::Input(format!(
                "`box` {text:?}: the range of {name} must increase, but goes from {low} to {high}"
            )));
        }
        let i = model.state("a state in `box`", name)?;
        let inward = |x| model.units().inward(model.quantity(i), x);
        all[i] = Some(Interval::new(inward(low), inward(high)));
    }
    let of = |(state, range): (&&str, Option<Interval>)| {
        range.ok_or_else(|| Error::Input(format!("`box` {text:?} has no range of {state}")))
    };
    states.iter().zip(all).map(of).collect()
}
