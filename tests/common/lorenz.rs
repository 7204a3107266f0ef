//! Systems with known Lyapunov exponents, as power series with hand-written recurrences.

use twinslip::field::{Analytic, Jacobian, State, VectorField};
use twinslip::number::DoubleDouble;
use twinslip::series::{Accuracy, Derivatives, Expansion, Solution, Tangent};

const ORDER: usize = 18;

/// A polynomial system: its coefficients at order k from those of lower orders, and the same for perturbations.
pub trait Quadratic: Send + Sync + Copy {
    /// The k-th coefficients of f(x), with `product(i, j)` those of x_i x_j.
    fn rates(&self, x: [f64; 3], product: &dyn Fn(usize, usize) -> f64) -> [f64; 3];
    /// The Jacobian.
    fn jacobian(&self, x: &[f64; 3]) -> [[f64; 3]; 3];
    /// D2f[u, v], constant.
    fn second(&self, u: &[f64; 3], v: &[f64; 3]) -> [f64; 3];
}

/// Lorenz (1963): sigma = 10, rho = 28, beta = 8/3.
#[derive(Debug, Clone, Copy)]
pub struct Lorenz;

impl Quadratic for Lorenz {
    fn rates(&self, [x, y, z]: [f64; 3], product: &dyn Fn(usize, usize) -> f64) -> [f64; 3] {
        [
            10.0 * (y - x),
            28.0 * x - y - product(0, 2),
            product(0, 1) - 8.0 / 3.0 * z,
        ]
    }
    fn jacobian(&self, [x, y, z]: &[f64; 3]) -> [[f64; 3]; 3] {
        [
            [-10.0, 10.0, 0.0],
            [28.0 - z, -1.0, -x],
            [*y, *x, -8.0 / 3.0],
        ]
    }
    fn second(&self, u: &[f64; 3], v: &[f64; 3]) -> [f64; 3] {
        [0.0, -(u[0] * v[2] + u[2] * v[0]), u[0] * v[1] + u[1] * v[0]]
    }
}

/// A rotation x' = -w y, y' = w x beside a decay z' = -r z: exponents 0, 0 and -r.
#[derive(Debug, Clone, Copy)]
pub struct Rotation {
    pub frequency: f64,
    pub decay: f64,
}

impl Quadratic for Rotation {
    fn rates(&self, [x, y, z]: [f64; 3], _: &dyn Fn(usize, usize) -> f64) -> [f64; 3] {
        [-self.frequency * y, self.frequency * x, -self.decay * z]
    }
    fn jacobian(&self, _: &[f64; 3]) -> [[f64; 3]; 3] {
        let w = self.frequency;
        [[0.0, -w, 0.0], [w, 0.0, 0.0], [0.0, 0.0, -self.decay]]
    }
    fn second(&self, _: &[f64; 3], _: &[f64; 3]) -> [f64; 3] {
        [0.0; 3]
    }
}

/// A quadratic system as a field.
#[derive(Debug, Clone, Copy)]
pub struct Field<Q>(pub Q);

impl<Q: Quadratic> VectorField<3> for Field<Q> {
    fn f(&self, y: &State<3>) -> State<3> {
        let x = y.data.0[0];
        State::from(self.0.rates(x, &|i, j| x[i] * x[j]))
    }
    fn jacobian(&self, y: &State<3>) -> Jacobian<3> {
        let rows = self.0.jacobian(&y.data.0[0]);
        Jacobian::from_fn(|i, j| rows[i][j])
    }
    fn second_derivative(&self, _: &State<3>, u: &State<3>, v: &State<3>) -> State<3> {
        State::from(self.0.second(&u.data.0[0], &v.data.0[0]))
    }
    fn analytic(&self) -> Option<&dyn Analytic<3>> {
        Some(self)
    }
}

impl<Q: Quadratic> Analytic<3> for Field<Q> {
    fn solution(&self) -> Box<dyn Solution<3> + '_> {
        Box::new(Track::new(self.0, false))
    }
    fn reference(&self) -> Box<dyn Solution<3> + '_> {
        unreachable!("no test asks for 31 digits")
    }
    fn tangent(&self, _: &[usize]) -> Box<dyn Tangent<3> + '_> {
        Box::new(Track::new(self.0, true))
    }
    fn reference_tangent(&self, _: &[usize]) -> Box<dyn Tangent<3> + '_> {
        unreachable!("no test asks for 31 digits")
    }
}

/// The solution and its derivatives in the start, column by column.
struct Track<Q> {
    system: Q,
    with_columns: bool,
    x: [f64; 3],
    columns: [[f64; 3]; 3],
    series: [[f64; ORDER + 1]; 3],
    log_determinant: f64,
}

impl<Q: Quadratic> Track<Q> {
    fn new(system: Q, with_columns: bool) -> Self {
        Track {
            system,
            with_columns,
            x: [0.0; 3],
            columns: [[0.0; 3]; 3],
            series: [[0.0; ORDER + 1]; 3],
            log_determinant: 0.0,
        }
    }
}

/// The series of a solution.
fn solve<Q: Quadratic>(system: &Q, x: [f64; 3]) -> [[f64; ORDER + 1]; 3] {
    let mut s = [[0.0; ORDER + 1]; 3];
    for i in 0..3 {
        s[i][0] = x[i];
    }
    for k in 0..ORDER {
        let product = |i: usize, j: usize| (0..=k).map(|l| s[i][l] * s[j][k - l]).sum::<f64>();
        let rates = system.rates([s[0][k], s[1][k], s[2][k]], &product);
        for i in 0..3 {
            s[i][k + 1] = rates[i] / (k + 1) as f64;
        }
    }
    s
}

/// The series of a perturbation along it: du/dt = J(x) u, where J is linear in x.
fn linearised<Q: Quadratic>(
    system: &Q,
    along: &[[f64; ORDER + 1]; 3],
    u: [f64; 3],
) -> [[f64; ORDER + 1]; 3] {
    let constant = system.jacobian(&[0.0; 3]);
    let mut s = [[0.0; ORDER + 1]; 3];
    for i in 0..3 {
        s[i][0] = u[i];
    }
    for k in 0..ORDER {
        let at = |s: &[[f64; ORDER + 1]; 3], k: usize| [s[0][k], s[1][k], s[2][k]];
        let now = at(&s, k);
        let mut sum = [0, 1, 2].map(|i| (0..3).map(|j| constant[i][j] * now[j]).sum::<f64>());
        for l in 0..=k {
            let bent = system.second(&at(along, l), &at(&s, k - l));
            for i in 0..3 {
                sum[i] += bent[i];
            }
        }
        for i in 0..3 {
            s[i][k + 1] = sum[i] / (k + 1) as f64;
        }
    }
    s
}

fn sum(series: &[[f64; ORDER + 1]; 3], h: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| series[i].iter().rev().fold(0.0, |sum, c| sum * h + c))
}

impl<Q: Quadratic> Solution<3> for Track<Q> {
    fn start(&mut self, y: &[f64; 3]) {
        self.x = *y;
        // Columns that nobody asks for would grow beyond all bounds.
        let one = f64::from(u8::from(self.with_columns));
        self.columns = [[one, 0.0, 0.0], [0.0, one, 0.0], [0.0, 0.0, one]];
        self.log_determinant = 0.0;
    }

    fn advance(&mut self, accuracy: &Accuracy, limit: DoubleDouble) -> DoubleDouble {
        let x = solve(&self.system, self.x);
        let columns = self.columns.map(|u| linearised(&self.system, &x, u));
        // The step at which the last terms are below the tolerance, of the solution and of all columns.
        let longest = |s: &[[f64; ORDER + 1]; 3]| {
            let size = |k: usize| (0..3).map(|i| s[i][k].abs()).fold(0.0, f64::max);
            let tolerable = accuracy.tolerances.0 * size(0).max(1e-280);
            let at = |k: usize| (tolerable / size(k).max(1e-290)).powf(1.0 / k as f64);
            at(ORDER).min(at(ORDER - 1))
        };
        let all = columns.iter().chain([&x]).map(longest);
        let h = all.fold(limit.hi().abs(), f64::min).copysign(limit.hi());
        // The trace of a quadratic system could vary; of these it does not.
        let constant = self.system.jacobian(&[0.0; 3]);
        self.log_determinant += h * (0..3).map(|i| constant[i][i]).sum::<f64>();
        self.series = x;
        self.x = sum(&x, h);
        self.columns = columns.map(|s| sum(&s, h));
        if h == limit.hi() {
            limit
        } else {
            DoubleDouble::from(h)
        }
    }

    fn state(&self) -> [f64; 3] {
        self.x
    }

    fn expansion(&self, _: usize, into: &mut Expansion<3>) {
        into.order = ORDER;
        into.unit = 1.0;
        into.chart = |x| x;
        for (into, series) in into.variables.iter_mut().zip(&self.series) {
            into[..=ORDER].copy_from_slice(series);
        }
    }
}

impl<Q: Quadratic> Tangent<3> for Track<Q> {
    fn derivatives(&self) -> Derivatives<3> {
        Derivatives {
            start: self.columns,
            parameters: Vec::new(),
            log_determinant: self.log_determinant,
            log_transverse: None,
        }
    }
}
