//! Coefficients of the normal forms of orbits of autonomous systems at points of codimension two. A cycle of radius 1 that turns once in 2 pi takes the place of the
//! forcing; its radius and its frequency change with the displacement, so that the return map is not the map after a fixed time. Its coefficients are known.

use crate::normal_forms_of_resonances::{assert_coefficients, only, write};
use std::f64::consts::{SQRT_2, TAU};

/// u' and v' are these beside a cycle in x and y, all seen through a nonlinear change of variables and in units of 1/size.
struct Beside {
    name: &'static str,
    kind: &'static str,
    label: &'static str,
    /// What the two parameters are at first, and the ranges in which they are followed.
    parameters: [(&'static str, f64, &'static str); 2],
    /// Definitions that the rates use.
    terms: &'static str,
    /// What r^2 - 1 comes to, and what the frequency is.
    cycle: [&'static str; 2],
    rates: [&'static str; 2],
    /// An orbit goes through (1, 0, u, 0).
    start: f64,
}

/// A coefficient: its name, its value, and the power of the length of the eigenvector by which it falls.
type Exact = (&'static str, f64, i32);

impl Beside {
    fn file(&self, size: f64) -> String {
        let Beside {
            name,
            terms,
            parameters: [(one, of_one, _), (other, of_other, _)],
            cycle: [radius, frequency],
            rates: [gu, gv],
            start,
            ..
        } = self;
        let text = format!(
            r#"name = "{name}"
states = ["X", "Y", "U", "V"]

[parameters]
{one} = {of_one:?}
{other} = {of_other:?}
size = {size:?}

[where]
v = "V/size - 0.3*(U/size)^2"
u = "U/size - 0.2*v^2"
x = "X/size - 0.25*u*v"
y = "Y/size + 0.2*u^2"
rr = "x^2 + y^2"
{terms}gx = "x*(1 - rr + {radius}) - y*({frequency})"
gy = "y*(1 - rr + {radius}) + x*({frequency})"
gu = "{gu}"
gv = "{gv}"
gU = "gu + 0.4*v*gv"

[rates]
X = "size*(gx + 0.25*(gu*v + u*gv))"
Y = "size*(gy - 0.4*u*gu)"
U = "size*gU"
V = "size*(gv + 0.6*U/size*gU)"

[start]
X = {:?}
Y = 0.0
U = {:?}
V = 0.0
"#,
            size,
            start * size
        );
        write(&format!("beside-{name}-{size}"), &text)
    }

    /// The coefficients are these, in any unit.
    fn has(&self, exact: &[Exact]) {
        for size in [1.0, 1e3] {
            let file = self.file(size);
            let [(one, _, of_one), (other, _, of_other)] = self.parameters;
            let words = format!(
                "locus {} --system {file} --in {one},{other} --range {one}={of_one} --range {other}={of_other} --start={:?},0,{:?},0 --period-guess 6.28",
                self.kind,
                size,
                self.start * size
            );
            let point = only(&words, self.label);
            let scaled = exact
                .iter()
                .map(|&(name, value, power)| (name, value / size.powi(power)));
            assert_coefficients(&point, &scaled.collect::<Vec<_>>());
            assert_eq!(point["criticality"], "supercritical");
        }
    }
}

/// Of a pair the cycle has r^2 - 1 = |z|^2 / 4, and turns at 1 + 0.3 |z|^2.
const OF_PAIR: [&str; 2] = ["0.25*s", "1 + 0.3*s"];
/// The same of a real multiplier.
const OF_ONE: [&str; 2] = ["0.25*u^2", "1 + 0.3*u"];
const OF_TORI: [(&str, f64, &str); 2] = [("mu", -0.05, "-0.06,0.05"), ("d", 0.0, "-0.03,0.02")];

/// z' = i z / 3 + 0.7 (x + i y) z*^2 + (-0.5 - 0.9 i) z |z|^2 + (0.4 + 0.6 i) z (r^2 - 1): of C, 0.1 + 0.15 i is by the radius, and -0.1 i by the frequency.
#[test]
fn a_resonance_of_one_to_three_of_a_cycle() {
    Beside {
        name: "third",
        kind: "torus",
        label: "R3",
        parameters: OF_TORI,
        terms: "s = \"u^2 + v^2\"\n",
        cycle: OF_PAIR,
        rates: [
            "mu*u - (1/3 + d)*v + 0.7*(x*(u^2 - v^2) + 2*y*u*v) + (-0.5*u + 0.9*v)*s + (0.4*u - 0.6*v)*(rr - 1)",
            "mu*v + (1/3 + d)*u + 0.7*(y*(u^2 - v^2) - 2*x*u*v) + (-0.5*v - 0.9*u)*s + (0.4*v + 0.6*u)*(rr - 1)",
        ],
        start: 0.0,
    }
    .has(&[("B_1", 3.0 * TAU * 0.7 * SQRT_2, 1), ("C_1", 6.0 * TAU * -0.4, 2)]);
}

/// z' = i z / 4 + (-0.5 + 0.9 i) z |z|^2 + 0.6 (x + i y) z*^3 + (0.4 + 0.6 i) z (r^2 - 1): of C, 0.1 + 0.15 i is by the radius, and -0.075 i by the frequency.
#[test]
fn a_resonance_of_one_to_four_of_a_cycle() {
    Beside {
        name: "fourth",
        kind: "torus",
        label: "R4",
        parameters: OF_TORI,
        terms: "s = \"u^2 + v^2\"\np = \"u^3 - 3*u*v^2\"\nq = \"3*u^2*v - v^3\"\n",
        cycle: OF_PAIR,
        rates: [
            "mu*u - (1/4 + d)*v + 0.6*(x*p + y*q) + (-0.5*u - 0.9*v)*s + (0.4*u - 0.6*v)*(rr - 1)",
            "mu*v + (1/4 + d)*u + 0.6*(y*p - x*q) + (-0.5*v + 0.9*u)*s + (0.4*v + 0.6*u)*(rr - 1)",
        ],
        start: 0.0,
    }
    .has(&[("Re A_0", -0.4 / 0.6, 0), ("Im A_0", 0.975 / 0.6, 0)]);
}

/// In a frame that turns by half a turn while the cycle turns once, u' = v and v' = 0.9 u^3 - 0.7 u^2 v: products of two of the cosine and the sine of half the angle
/// are linear in x and y.
#[test]
fn a_resonance_of_one_to_two_of_a_cycle() {
    Beside {
        name: "second",
        kind: "period-doubling",
        label: "R2",
        parameters: [("e1", -0.1, "-0.2,0.1"), ("e2", -0.1, "-0.2,0.2")],
        terms: r#"c2 = "(1 + x)/2"
s2 = "(1 - x)/2"
sc = "y/2"
su = "sc*u + s2*v"
cu = "c2*u + sc*v"
sv = "-s2*u + sc*v"
cv = "-sc*u + c2*v"
uu = "c2*u^2 + 2*sc*u*v + s2*v^2"
sf = "e1*su + e2*sv + 0.9*uu*su - 0.7*uu*sv"
cf = "e1*cu + e2*cv + 0.9*uu*cu - 0.7*uu*cv"
"#,
        cycle: ["0", "1"],
        rates: ["-0.5*v + cv - sf", "0.5*u + sv + cf"],
        start: 0.0,
    }
    .has(&[
        ("C_1", TAU * TAU * 0.9, 2),
        ("D_1", TAU * 0.7 - 2.7 * TAU * TAU, 2),
    ]);
}

/// u' = v and v' = 0.6 u^2 - 0.8 u v for one turn; what the frequency adds, a term in v^2, does not count.
#[test]
fn a_resonance_of_one_to_one_of_a_cycle() {
    let a = TAU * TAU * 0.6;
    Beside {
        name: "first",
        kind: "orbit-saddle-node",
        label: "R1",
        parameters: [("e1", -0.1, "-0.1,0.1"), ("e2", -0.1, "-0.1,0.1")],
        terms: "",
        cycle: OF_ONE,
        rates: ["v", "e1 + e2*v + 0.6*u^2 - 0.8*u*v - u^3 - v^3"],
        start: -0.4,
    }
    .has(&[("a", a, 1), ("b", -0.8 * TAU + 2.0 * a, 1)]);
}

/// u' = -0.7 u^3 + 0.4 u (r^2 - 1) = -0.6 u^3 + ... Also from an orbit along which u and v stay 0, which says nothing of their size.
#[test]
fn a_cusp_of_a_cycle() {
    for (name, start) in [("cusp", 0.1), ("cusp-from-zero", 0.0)] {
        Beside {
            name,
            kind: "orbit-saddle-node",
            label: "CP",
            parameters: [("e1", 0.0, "-0.2,0.2"), ("e2", 0.2, "-0.2,0.2")],
            terms: "",
            cycle: OF_ONE,
            rates: ["e1 + e2*u - 0.7*u^3 + 0.4*u*(rr - 1)", "-v"],
            start,
        }
        .has(&[("c", -0.6 * TAU, 2)]);
    }
}
