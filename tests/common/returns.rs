//! The return map of an orbit, iterated: nothing of the crate's normal forms is in it.

use nalgebra::Vector2;
use twinslip::bifurcation::Special;
use twinslip::field::{Jacobian, State, VectorField};
use twinslip::integrate::{Integrator, MAX_STEPS, Taylor, Tolerances};

fn precise() -> Taylor {
    let tolerances = Tolerances::equal(1e-16).expect("tolerances");
    Taylor::new(tolerances, MAX_STEPS).expect("a method")
}

/// The return map to the plane across the flow at a point of an orbit, in orthonormal coordinates there.
struct ReturnMap<'a> {
    field: &'a dyn VectorField<3>,
    taylor: Taylor,
    origin: State<3>,
    frame: Jacobian<3>,
    period: f64,
}

impl<'a> ReturnMap<'a> {
    fn new(field: &'a dyn VectorField<3>, origin: State<3>, period: f64) -> Self {
        let along = field.f(&origin).normalize();
        // The axis least along the flow, made orthogonal to it.
        let least = along.iamin();
        let axis = State::<3>::from_fn(|i, _| f64::from(i == least));
        let second = (axis - along * along.dot(&axis)).normalize();
        ReturnMap {
            field,
            taylor: precise(),
            origin,
            frame: Jacobian::<3>::from_columns(&[along, second, along.cross(&second)]),
            period,
        }
    }

    /// Where a point of the plane comes back to it; `None` where it does not after about a period.
    fn at(&mut self, x: Vector2<f64>) -> Option<Vector2<f64>> {
        const LANDINGS: usize = 6;
        const FAR: f64 = 0.1;
        let normal = self.frame.column(0).into_owned();
        let start = self.origin + self.frame.column(1) * x[0] + self.frame.column(2) * x[1];
        let mut flow = |y: &State<3>, t: f64| self.taylor.flow(self.field, (0.0, t), y, None).ok();
        let mut y = flow(&start, self.period)?;
        for _ in 0..LANDINGS {
            let dt = -normal.dot(&(y - self.origin)) / normal.dot(&self.field.f(&y));
            if dt.is_nan() || dt.abs() > FAR * self.period {
                return None;
            }
            if dt.abs() < 1e-15 * self.period {
                break;
            }
            y = flow(&y, dt)?;
        }
        let off = y - self.origin;
        Some(Vector2::new(
            self.frame.column(1).dot(&off),
            self.frame.column(2).dot(&off),
        ))
    }
}

/// The greatest distance from a special orbit among the first returns and among the last of some thousands, from a start this
/// far beside it. In a plane where the orbit is not about to jump.
pub fn returns(field: &dyn VectorField<3>, special: &Special, beside: f64) -> (f64, f64) {
    const RETURNS: usize = 4000;
    const WINDOW: usize = 500;
    const PLANES_PER_ARC: usize = 8;
    let (nodes, durations) = special.orbit.as_ref().expect("an orbit").nodes();
    let mut taylor = precise();
    let mut origins = Vec::new();
    for (node, duration) in nodes.iter().zip(durations) {
        let mut y = State::<3>::from_fn(|i, _| node[i]);
        for _ in 0..PLANES_PER_ARC {
            origins.push(y);
            let span = (0.0, duration / PLANES_PER_ARC as f64);
            y = taylor.flow(field, span, &y, None).expect("an arc");
        }
    }
    let run = |&origin: &State<3>| {
        let mut map = ReturnMap::new(field, origin, durations.iter().sum());
        let mut x = Vector2::new(beside, 0.0);
        let mut distances = Vec::with_capacity(RETURNS);
        for _ in 0..RETURNS {
            x = map.at(x).filter(|x| x.norm() < 20.0 * beside)?;
            distances.push(x.norm());
        }
        let largest = |all: &[f64]| all.iter().copied().fold(0.0, f64::max);
        Some((
            largest(&distances[..WINDOW]),
            largest(&distances[RETURNS - WINDOW..]),
        ))
    };
    origins.iter().find_map(run).expect("a plane")
}
