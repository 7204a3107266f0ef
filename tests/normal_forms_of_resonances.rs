//! Coefficients of the normal forms of orbits at points of codimension two. The systems are normal forms under a forcing of period 2 pi, in coordinates in which
//! they rotate once in k periods, seen through a nonlinear change of variables: so their return maps have known coefficients.

use crate::command::{self, number};
use serde_json::Value;
use std::f64::consts::{SQRT_2, TAU};

/// x' and y' are these, X = x + 0.25 y^2 + 0.3 cos t and Y = y + 0.4 (x + 0.25 y^2)^2; with a third variable, which decays by itself, X + 0.2 Z^2 and
/// Z = z + 0.3 x y in its place.
struct Seen {
    name: &'static str,
    parameters: &'static str,
    /// Definitions that the rates use.
    terms: &'static str,
    rates: [&'static str; 2],
    third: bool,
}

impl Seen {
    fn file(&self) -> String {
        let (states, start, shift, rate, last, z) = match self.third {
            false => (r#""X", "Y""#, "", "", "", "", ""),
            true => (
                r#""X", "Y", "Z""#,
                "Z = 0.0\n",
                " - 0.2*Z^2",
                " + 0.4*Z*gz",
                "Z = \"gz\"\n",
                "z = \"Z - 0.3*x*y\"\ngz = \"-0.3*z + 0.3*(gx*y + x*gy)\"\n",
            ),
        };
        let Seen {
            name,
            parameters,
            terms,
            rates: [gx, gy],
            ..
        } = self;
        let text = format!(
            r#"name = "{name}"
states = [{states}]
period = "2*pi"

[parameters]
{parameters}

[where]
xi = "X - 0.3*cos(t){shift}"
y = "Y - 0.4*xi^2"
x = "xi - 0.25*y^2"
{terms}gx = "{gx}"
gy = "{gy}"
{z}gxi = "gx + 0.5*y*gy"

[rates]
X = "gxi - 0.3*sin(t){rate}"
Y = "gy + 0.8*xi*gxi"
{last}
[start]
X = 0.3
Y = 0.0
{start}"#
        );
        write(name, &text)
    }
}

/// The path of a file with this text.
pub fn write(name: &str, text: &str) -> String {
    let folder = command::folder(&format!("normal-form-{name}"));
    let path = folder.join(format!("{name}.toml"));
    std::fs::write(&path, text).expect("a file");
    path.to_str().expect("a path").to_owned()
}

/// The only point with this label on curves over two parameters.
fn point(kind: &str, file: &str, ranges: [(&str, &str); 2], label: &str) -> Value {
    let [(one, of_one), (other, of_other)] = ranges;
    let words = format!(
        "locus {kind} --system {file} --in {one},{other} --range {one}={of_one} --range {other}={of_other}"
    );
    only(&words, label)
}

/// The only point with this label that a run finds.
pub fn only(words: &str, label: &str) -> Value {
    let made = command::object(words);
    let special = made["result"]["special"].as_array().expect("points");
    let mut found = special.iter().filter(|point| point["label"] == label);
    let point = found.next().unwrap_or_else(|| panic!("{special:#?}"));
    assert!(found.next().is_none(), "{special:#?}");
    point.clone()
}

/// The coefficients are these, within their bounds, which are sharp.
pub fn assert_coefficients(point: &Value, all: &[(&str, f64)]) {
    for (name, exact) in all {
        let [value, off] = ["value", "uncertainty"]
            .map(|part| number(point, &format!("/normal_form/{name}/{part}")));
        assert!(
            (value - exact).abs() <= off && off < 3e-8 * exact.abs(),
            "{name}: {value} ± {off:e}, {exact}"
        );
    }
}

/// z' = (mu + i (1/3 + d)) z + 0.7 e^(it) z*^2 + (-0.5 - 0.9 i) z |z|^2 with z = x + i y, of which three periods are the flow of
/// w' = 3 T (0.7 sqrt(2) w*^2 + 2 (-0.5 - 0.9 i) w |w|^2), z = sqrt(2) e^(it/3) w.
#[test]
fn a_resonance_of_one_to_three_has_the_coefficients_of_its_third_iterate() {
    for third in [false, true] {
        let file = Seen {
            name: if third { "third-of-three" } else { "third" },
            parameters: "mu = -0.05\nd = 0.0",
            terms: "r = \"x^2 + y^2\"\n",
            rates: [
                "mu*x - (1/3 + d)*y + 0.7*(cos(t)*(x^2 - y^2) + 2*sin(t)*x*y) + (-0.5*x + 0.9*y)*r",
                "mu*y + (1/3 + d)*x + 0.7*(sin(t)*(x^2 - y^2) - 2*cos(t)*x*y) + (-0.5*y - 0.9*x)*r",
            ],
            third,
        }
        .file();
        let ranges = [("mu", "-0.06,0.05"), ("d", "-0.03,0.02")];
        let point = point("torus", &file, ranges, "R3");
        let (b_1, c_1) = (3.0 * TAU * 0.7 * SQRT_2, -3.0 * TAU);
        assert_coefficients(&point, &[("B_1", b_1), ("C_1", c_1)]);
        assert_eq!(point["criticality"], "supercritical");
    }
}

/// z' = (mu + i (1/4 + d)) z + (-0.5 + 0.9 i) z |z|^2 + 0.6 e^(it) z*^3: A_0 = (-0.5 + 0.9 i) / 0.6.
#[test]
fn a_resonance_of_one_to_four_has_the_ratio_of_its_cubic_terms() {
    let file = Seen {
        name: "fourth",
        parameters: "mu = -0.05\nd = 0.0",
        terms: "r = \"x^2 + y^2\"\np = \"x^3 - 3*x*y^2\"\nq = \"3*x^2*y - y^3\"\n",
        rates: [
            "mu*x - (1/4 + d)*y + 0.6*(cos(t)*p + sin(t)*q) + (-0.5*x - 0.9*y)*r",
            "mu*y + (1/4 + d)*x + 0.6*(sin(t)*p - cos(t)*q) + (-0.5*y + 0.9*x)*r",
        ],
        third: false,
    }
    .file();
    let ranges = [("mu", "-0.06,0.05"), ("d", "-0.03,0.02")];
    let point = point("torus", &file, ranges, "R4");
    assert_coefficients(&point, &[("Re A_0", -0.5 / 0.6), ("Im A_0", 1.5)]);
    // Of displacements at one phase the torus has the coefficient of the flow, too.
    assert!((number(&point, "/coefficient") + TAU).abs() < 1e-7);
    assert_eq!(point["criticality"], "supercritical");
}

/// u' = v, v' = e_1 u + e_2 v + C u^3 + D u^2 v in a frame that turns by half a turn each period: the map is minus the flow for the time T, so that
/// C_1 = T^2 C and D_1 = -T D - 3 T^2 C.
#[test]
fn a_resonance_of_one_to_two_has_the_coefficients_of_the_flow_of_its_square() {
    let (terms, stable) = (
        "c = \"cos(t/2)\"\ns = \"sin(t/2)\"\nu = \"c*x + s*y\"\nv = \"-s*x + c*y\"\nf = \"e1*u + e2*v + 0.9*u^3 - 0.7*u^2*v\"\n",
        "supercritical",
    );
    let unstable = "c = \"cos(t/2)\"\ns = \"sin(t/2)\"\nu = \"c*x + s*y\"\nv = \"-s*x + c*y\"\nf = \"e1*u + e2*v - 0.9*u^3 + 0.7*u^2*v\"\n";
    let cases = [
        ("second", terms, false, (0.9, -0.7), stable),
        ("second-of-three", terms, true, (0.9, -0.7), stable),
        ("other-second", unstable, false, (-0.9, 0.7), "subcritical"),
    ];
    for (name, terms, third, (c, d), criticality) in cases {
        let file = Seen {
            name,
            parameters: "e1 = -0.1\ne2 = -0.1",
            terms,
            rates: ["-0.5*y + c*v - s*f", "0.5*x + s*v + c*f"],
            third,
        }
        .file();
        let ranges = [("e1", "-0.2,0.1"), ("e2", "-0.2,0.2")];
        let point = point("period-doubling", &file, ranges, "R2");
        let (c_1, d_1) = (TAU * TAU * c, -TAU * d - 3.0 * TAU * TAU * c);
        assert_coefficients(&point, &[("C_1", c_1), ("D_1", d_1)]);
        assert_eq!(point["criticality"], criticality);
        assert_eq!(point["note"], format!("s = {}", c.signum()));
    }
}

/// x' = y, y' = e_1 + e_2 y + 0.6 x^2 + b x y - x^3 - y^3, for the time T: a = 0.6 T^2 and b T + 2 a.
#[test]
fn a_resonance_of_one_to_one_has_the_coefficients_of_its_flow() {
    for (name, rate, b, criticality) in [
        (
            "first",
            "e1 + e2*y + 0.6*x^2 - 0.8*x*y - x^3 - y^3",
            -0.8,
            "supercritical",
        ),
        (
            "other-first",
            "e1 + e2*y + 0.6*x^2 + 0.8*x*y - x^3 - y^3",
            0.8,
            "subcritical",
        ),
    ] {
        let file = Seen {
            name,
            parameters: "e1 = -0.1\ne2 = -0.1",
            terms: "",
            rates: ["y", rate],
            third: false,
        }
        .file();
        let ranges = [("e1", "-0.1,0.1"), ("e2", "-0.1,0.1")];
        let point = point("orbit-saddle-node", &file, ranges, "R1");
        let a = TAU * TAU * 0.6;
        assert_coefficients(&point, &[("a", a), ("b", b * TAU + 2.0 * a)]);
        assert_eq!(point["criticality"], criticality);
    }
}

/// x' = e_1 + e_2 x - 0.7 x^3 for the time T, and the same with x 1000 times as large.
#[test]
fn a_cusp_of_orbits_has_the_coefficient_of_its_flow_in_any_unit() {
    for size in [1.0, 1e3] {
        let text = format!(
            r#"name = "cusp"
states = ["X"]
period = "2*pi"

[parameters]
e1 = 0.0
e2 = 0.2
size = {size:?}

[where]
x = "X/size - 0.3*cos(t)"

[rates]
X = "size*(e1 + e2*x - 0.7*x^3 - 0.3*sin(t))"

[start]
X = {:?}
"#,
            0.3 * size
        );
        let file = write(&format!("cusp-{size}"), &text);
        let ranges = [("e1", "-0.2,0.2"), ("e2", "-0.2,0.2")];
        let point = point("orbit-saddle-node", &file, ranges, "CP");
        assert_coefficients(&point, &[("c", -0.7 * TAU / (size * size))]);
        assert_eq!(point["criticality"], "supercritical");
    }
}
