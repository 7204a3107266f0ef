//! An orbit in a few numbers: what a diagram of a branch shows of it.

use super::arc::Tracer;
use super::interface_system::InterfaceSystem;
use super::shooting_nodes::ShootingNodes;
use crate::error::Result;
use crate::field::State;
use crate::integrate::Control;
use crate::number::polynomial::evaluate;
use crate::series::{Section, Zeros};

/// Along one cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
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

/// Of a cycle of a slab, in (tau, ln psi_1, ln psi_2) or (tau, ln psi), to some six digits.
///
/// # Errors
/// Those of the flow.
pub fn profile<const N: usize>(
    slab: &InterfaceSystem,
    shooting: &ShootingNodes<N>,
) -> Result<Profile> {
    /// Tolerance of the run.
    const ROUGH: f64 = 1e-7;
    const { assert!(N == 2 || N == 3, "a slab's variables") };
    let mut seen = Extent {
        top: (f64::NEG_INFINITY, [0.0; 2]),
        bottom: f64::INFINITY,
        integral: 0.0,
    };
    let field = slab.whole();
    if N == 3 {
        let whole = shooting
            .nodes
            .iter()
            .map(|x| State::<3>::new(x[0], x[1], x[N - 1]));
        seen.go(
            &*field,
            whole,
            &shooting.durations,
            &mut Tracer::taylor(ROUGH)?,
        )?;
    } else {
        let inner = slab.plane();
        let plane = shooting.nodes.iter().map(|x| State::<2>::new(x[0], x[1]));
        seen.go(
            &*inner,
            plane,
            &shooting.durations,
            &mut Tracer::taylor(ROUGH)?,
        )?;
    }
    let (top, w) = seen.top;
    Ok(Profile {
        mean_stress: seen.integral / shooting.period(),
        stress_range: (seen.bottom, top),
        state: w.map(f64::exp),
        slip_rate: field.slip_rates(&State::<3>::new(top, w[0], w[1])),
    })
}

struct Extent {
    /// tau and ln psi.
    top: (f64, [f64; 2]),
    bottom: f64,
    integral: f64,
}

impl Extent {
    fn see<const N: usize>(&mut self, y: &State<N>) {
        if y[0] > self.top.0 {
            self.top = (y[0], [y[1], y[N - 1]]);
        }
        self.bottom = self.bottom.min(y[0]);
    }

    fn go<const N: usize>(
        &mut self,
        field: &dyn crate::field::VectorField<N>,
        nodes: impl Iterator<Item = State<N>>,
        durations: &[f64],
        tracer: &mut Tracer<N>,
    ) -> Result<()> {
        let mut normal = [0.0; N];
        normal[0] = 1.0;
        let section = Section::Extremum { normal };
        let mut turns = Vec::new();
        for (x, &duration) in nodes.zip(durations) {
            let mut zeros = Zeros::default();
            self.see(&x);
            tracer.flow(
                field,
                &x,
                duration,
                Some(&mut |step| {
                    self.see(step.y1);
                    let Some(series) = step.series() else {
                        return Ok(Control::Continue);
                    };
                    turns.clear();
                    series.crossings(&section, None, &mut zeros, &mut turns);
                    turns
                        .iter()
                        .for_each(|turn| self.see(&State::from(turn.state)));
                    // tau stands first, in the variables as in the state.
                    let mut terms = series.variables[0];
                    for (j, c) in terms.iter_mut().enumerate() {
                        *c /= (j + 1) as f64;
                    }
                    let s = series.length / series.unit;
                    self.integral += evaluate(&terms[..=series.order], s) * series.length;
                    Ok(Control::Continue)
                }),
            )?;
        }
        Ok(())
    }
}
