//! The first Lyapunov coefficient l_1 of a Hopf point: negative where the small orbits are stable.
//!
//! l_1 = Re[<p, C(q,q,q*)> - 2 <p, B(q, A^-1 B(q,q*))> + <p, B(q*, (2 i omega - A)^-1 B(q,q))>] / (2 omega)
//! (Kuznetsov 2004, Elements of Applied Bifurcation Theory, (5.62)), with A q = i omega q, <q, q> = 1 and <p, q> = 1, in the
//! coordinates (tau, psi_1, psi_2) of (19). The sign does not depend on coordinates. Everything is computed in 31 digits:
//! the three terms cancel near a degenerate Hopf point, and the states span many decades.

use crate::friction::Law;
use crate::number::{DoubleDouble, Jet, Real};
use std::ops::{Add, Mul, Neg, Sub};

type Number = DoubleDouble;
/// With all derivatives up to the third, in (tau, psi).
type ThirdJet = Jet<Jet<Jet<Number, 2>, 2>, 2>;

/// re + i im; nalgebra's asks for more than these numbers can.
#[derive(Debug, Clone, Copy)]
struct Complex {
    re: Number,
    im: Number,
}

impl Complex {
    const ZERO: Self = Complex {
        re: Number::ZERO,
        im: Number::ZERO,
    };
    const ONE: Self = Complex {
        re: Number::ONE,
        im: Number::ZERO,
    };

    fn real(re: Number) -> Self {
        Complex {
            re,
            im: Number::ZERO,
        }
    }
    fn imaginary(im: Number) -> Self {
        Complex {
            re: Number::ZERO,
            im,
        }
    }
    fn conjugate(self) -> Self {
        Complex {
            im: -self.im,
            ..self
        }
    }
    fn times(self, x: Number) -> Self {
        Complex {
            re: self.re * x,
            im: self.im * x,
        }
    }
    fn square(self) -> Number {
        self.re * self.re + self.im * self.im
    }
    fn over(self, other: Self) -> Self {
        let inverse = Number::ONE / other.square();
        (self * other.conjugate()).times(inverse)
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Complex {
            re: self.re + o.re,
            im: self.im + o.im,
        }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Neg for Complex {
    type Output = Self;
    fn neg(self) -> Self {
        Complex {
            re: -self.re,
            im: -self.im,
        }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Complex {
            re: self.re * o.re - self.im * o.im,
            im: self.re * o.im + self.im * o.re,
        }
    }
}

/// v(tau, psi) and dpsi/dt of one interface, with derivatives.
#[derive(Debug, Clone, Copy)]
struct InterfaceDerivatives {
    v: ThirdJet,
    g: ThirdJet,
}

impl InterfaceDerivatives {
    fn at(law: &impl Law, rate: Number) -> Self {
        let psi = law.steady_state(rate);
        let at = [law.stress(rate, psi), psi];
        let [tau, psi] = [0, 1].map(|i| {
            let inner = Jet::<_, 2>::variable(Jet::<_, 2>::variable(at[i], i), i);
            ThirdJet::variable(inner, i)
        });
        let v = law.slip_rate(law.activation(tau), psi);
        let g = law.evolution(v, psi);
        InterfaceDerivatives { v, g }
    }
}

fn first(x: &ThirdJet, i: usize) -> Number {
    x.value.value.gradient[i]
}

/// The gradient's components along a vector.
fn along<T: Copy>(gradient: &[T; 2], a: [Complex; 2], of: impl Fn(&T) -> Complex) -> Complex {
    a[0] * of(&gradient[0]) + a[1] * of(&gradient[1])
}

/// The second derivative applied to two vectors.
fn bilinear(x: &ThirdJet, a: [Complex; 2], b: [Complex; 2]) -> Complex {
    along(&x.value.gradient, a, |x| {
        along(&x.gradient, b, |&x| Complex::real(x))
    })
}

/// The third derivative applied to three vectors.
fn trilinear(x: &ThirdJet, a: [Complex; 2], b: [Complex; 2], c: [Complex; 2]) -> Complex {
    along(&x.gradient, a, |x| {
        along(&x.gradient, b, |x| {
            along(&x.gradient, c, |&x| Complex::real(x))
        })
    })
}

/// The linearised system (19), or (11), and its nonlinear terms: dtau/dt = K (V_H - sum v_i), dpsi_i/dt = g_i.
struct LinearisedSystem {
    interfaces: Vec<InterfaceDerivatives>,
    k: Number,
}

type ComplexVector = Vec<Complex>;

impl LinearisedSystem {
    /// (tau, psi_i) of a vector.
    fn part(x: &ComplexVector, i: usize) -> [Complex; 2] {
        [x[0], x[i + 1]]
    }

    fn form(&self, of: impl Fn(&ThirdJet, usize) -> Complex) -> ComplexVector {
        let mut stress = Complex::ZERO;
        let mut result = vec![Complex::ZERO];
        for (i, interface) in self.interfaces.iter().enumerate() {
            stress = stress - of(&interface.v, i).times(self.k);
            result.push(of(&interface.g, i));
        }
        result[0] = stress;
        result
    }

    fn b(&self, x: &ComplexVector, y: &ComplexVector) -> ComplexVector {
        self.form(|f, i| bilinear(f, Self::part(x, i), Self::part(y, i)))
    }

    fn c(&self, x: &ComplexVector, y: &ComplexVector, z: &ComplexVector) -> ComplexVector {
        self.form(|f, i| trilinear(f, Self::part(x, i), Self::part(y, i), Self::part(z, i)))
    }

    /// The solution x of (sigma - A) x = b: the states couple through the stress alone.
    fn resolvent(&self, sigma: Complex, b: &ComplexVector) -> ComplexVector {
        let mut diagonal = sigma;
        let mut right = b[0];
        for (i, one) in self.interfaces.iter().enumerate() {
            let gap = sigma - Complex::real(first(&one.g, 1));
            let coupling = self.k * first(&one.v, 1);
            diagonal = diagonal + Complex::real(self.k * first(&one.v, 0));
            diagonal = diagonal + Complex::real(coupling * first(&one.g, 0)).over(gap);
            right = right - b[i + 1].times(coupling).over(gap);
        }
        let stress = right.over(diagonal);
        let states = self.interfaces.iter().zip(&b[1..]).map(|(one, &b)| {
            let gap = sigma - Complex::real(first(&one.g, 1));
            (b + stress.times(first(&one.g, 0))).over(gap)
        });
        std::iter::once(stress).chain(states).collect()
    }
}

/// The sum of products, nothing conjugated.
fn product(a: &ComplexVector, b: &ComplexVector) -> Complex {
    a.iter()
        .zip(b)
        .fold(Complex::ZERO, |sum, (&x, &y)| sum + x * y)
}

/// l_1, and the size of the terms whose sum it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FirstLyapunov {
    pub value: f64,
    pub scale: f64,
}

impl FirstLyapunov {
    /// l_1 in parts of the terms whose sum it is.
    pub fn part(&self) -> f64 {
        self.value / self.scale
    }

    /// The sign, unless it depends on how the law's parameters are rounded: with the Dieterich-Ruina and the slip law l_1 is zero throughout.
    pub fn sign(&self) -> Option<f64> {
        (self.part().abs() > Self::ROUNDING).then(|| self.value.signum())
    }

    /// The part of the terms that the rounding of the law's parameters may change.
    pub const ROUNDING: f64 = 100.0 * f64::EPSILON;
}

/// At the equilibrium with these slip rates, one per interface, where the eigenvalues +-i omega cross at stiffness K.
pub(super) fn first_lyapunov(
    law: &impl Law,
    rates: &[Number],
    k: Number,
    omega: Number,
) -> FirstLyapunov {
    let interfaces: Vec<_> = rates
        .iter()
        .map(|&v| InterfaceDerivatives::at(law, v))
        .collect();
    let system = LinearisedSystem { interfaces, k };
    let i_omega = Complex::imaginary(omega);
    // right and left eigenvector; the left one is p*, so products with it conjugate nothing
    let (mut q, mut p) = (vec![Complex::ONE], vec![Complex::ONE]);
    for one in &system.interfaces {
        let gap = i_omega - Complex::real(first(&one.g, 1));
        q.push(Complex::real(first(&one.g, 0)).over(gap));
        p.push(Complex::real(-(k * first(&one.v, 1))).over(gap));
    }
    let length = q
        .iter()
        .fold(Number::ZERO, |sum, x| sum + x.square())
        .sqrt();
    q = q
        .into_iter()
        .map(|x| x.times(Number::ONE / length))
        .collect();
    let normal = product(&p, &q);
    p = p.into_iter().map(|x| x.over(normal)).collect();

    let conjugate: ComplexVector = q.iter().map(|x| x.conjugate()).collect();
    // A^-1 b = -(0 - A)^-1 b
    let mean = system.resolvent(Complex::ZERO, &system.b(&q, &conjugate));
    let double = system.resolvent(i_omega + i_omega, &system.b(&q, &q));
    let over = Number::ONE / (omega * 2.0);
    let terms = [
        product(&p, &system.c(&q, &q, &conjugate)).times(over),
        product(&p, &system.b(&q, &mean)).times(over * 2.0),
        product(&p, &system.b(&conjugate, &double)).times(over),
    ];
    FirstLyapunov {
        value: (terms[0].re + terms[1].re + terms[2].re).to_f64(),
        scale: terms.iter().map(|t| t.square().sqrt().to_f64()).sum(),
    }
}
