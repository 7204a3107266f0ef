//! An orbit in a few numbers: what a diagram of a branch shows of it.

use super::arc::Tracer;
use super::interface_system::InterfaceSystem;
use super::settle::axis;
use super::shooting_nodes::ShootingNodes;
use crate::error::{Error, Result};
use crate::field::State;
use crate::integrate::{AnyField, Control};
use crate::number::polynomial::evaluate;
use crate::series::{Section, Zeros};

/// To how many digits what is told of an orbit is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Digits {
    /// Some six, as for pictures.
    Six,
    /// All that the orbit has.
    All,
}

impl Digits {
    /// The tolerance of the run: of an explicit method, and of an implicit one, which rounds more.
    pub(super) fn tolerances(self) -> [f64; 2] {
        match self {
            Digits::Six => [1e-7, 1e-8],
            Digits::All => [1e-15, 1e-13],
        }
    }
}

/// Along one cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    /// The mean of tau over time.
    pub mean_stress: f64,
    /// The least and the greatest tau.
    pub stress_range: (f64, f64),
    /// psi of both interfaces where tau is greatest.
    pub state: [f64; 2],
    /// Their slip rates there.
    pub slip_rate: [f64; 2],
}

/// Of a cycle of a slab, in (tau, ln psi_1, ln psi_2) or (tau, ln psi).
///
/// # Errors
/// [`Error::Dimension`] for nodes of other dimensions; those of the flow.
pub fn profile(
    slab: &InterfaceSystem,
    shooting: &ShootingNodes,
    digits: Digits,
) -> Result<Profile> {
    let whole = slab.whole();
    let field = if shooting.dimension() == 3 {
        AnyField::of::<3>(&*whole)
    } else {
        AnyField::new::<2>(slab.plane())
    };
    profile_of(&field, &|y| whole.slip_rates(y), shooting, digits)
}

/// The same of any interfaces: by their field, and their slip rates in (tau, ln psi_1, ln psi_2).
///
/// # Errors
/// As of [`profile`].
pub fn profile_of(
    field: &AnyField<'_>,
    slip_rates: &dyn Fn(&State<3>) -> [f64; 2],
    shooting: &ShootingNodes,
    digits: Digits,
) -> Result<Profile> {
    let [tolerance, _] = digits.tolerances();
    let dimension = shooting.dimension();
    let known = matches!(dimension, 2 | 3);
    Error::dimension_unless(known, "a cycle of a slab", "2 or 3", dimension)?;
    shooting.checked(field.dimension())?;
    let mut seen = Extent {
        top: (f64::NEG_INFINITY, [0.0; 2]),
        bottom: f64::INFINITY,
        integral: 0.0,
    };
    seen.go(field, shooting, &mut Tracer::taylor(tolerance)?)?;
    let (top, w) = seen.top;
    Ok(Profile {
        mean_stress: seen.integral / shooting.period(),
        stress_range: (seen.bottom, top),
        state: w.map(f64::exp),
        slip_rate: slip_rates(&State::<3>::new(top, w[0], w[1])),
    })
}

struct Extent {
    /// tau and ln psi.
    top: (f64, [f64; 2]),
    bottom: f64,
    integral: f64,
}

impl Extent {
    fn see(&mut self, y: &[f64]) {
        if y[0] > self.top.0 {
            self.top = (y[0], [y[1], y[y.len() - 1]]);
        }
        self.bottom = self.bottom.min(y[0]);
    }

    fn go(
        &mut self,
        field: &AnyField<'_>,
        shooting: &ShootingNodes,
        tracer: &mut Tracer,
    ) -> Result<()> {
        let stress = axis(field.dimension(), 0);
        let section = Section::Extremum {
            normal: stress.as_slice(),
        };
        let (mut turns, mut terms) = (Vec::new(), Vec::new());
        for (x, &duration) in shooting.nodes.iter().zip(&shooting.durations) {
            let mut zeros = Zeros::default();
            self.see(x.as_slice());
            tracer.flow(
                field,
                x,
                duration,
                Some(&mut |step| {
                    self.see(step.y1);
                    let Some(series) = step.series() else {
                        return Ok(Control::Continue);
                    };
                    turns.clear();
                    series.crossings(section, None, &mut zeros, &mut turns);
                    turns.iter().for_each(|turn| self.see(&turn.state));
                    // tau stands first, in the variables as in the state.
                    let stress = series.variable(0).iter().enumerate();
                    terms.clear();
                    terms.extend(stress.map(|(j, c)| c / (j + 1) as f64));
                    let s = series.length() / series.unit();
                    self.integral += evaluate(&terms, s) * series.length();
                    Ok(Control::Continue)
                }),
            )?;
        }
        Ok(())
    }
}
