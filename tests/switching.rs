//! Random piecewise-linear and switching systems against their closed forms, piece by piece: no error is larger than what `--estimate-error`
//! says of it.

use crate::command;
use crate::common::text::file;
use command::{number, object};
use std::f64::consts::PI;

/// So many of each kind.
const EACH: usize = 250;

/// Numbers between 0 and 1, the same ones each time.
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> f64 {
        // Steele, Lea & Flood (2014), SplitMix64.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.next()
    }

    /// Equal in the logarithm.
    fn scale(&mut self, from: f64, to: f64) -> f64 {
        from * (to / from).powf(self.next())
    }
}

/// Runs a system many times; `draw` sets the parameters and gives the time until the end and the exact values there.
fn holds<const N: usize>(
    (name, text): (&str, &str),
    states: [&str; N],
    seed: u64,
    mut draw: impl FnMut(&mut Draws, &mut Vec<(&'static str, f64)>) -> (f64, [f64; N]),
) {
    let path = file(name, text);
    let mut draws = Draws(seed);
    for i in 0..EACH {
        let mut set = Vec::new();
        let (until, exact) = draw(&mut draws, &mut set);
        let method = ["auto", "taylor", "rodas5p"][i % 3];
        let rtol = draws.scale(1e-11, 1e-5);
        let set: Vec<String> = set
            .iter()
            .map(|(name, x)| format!("--set {name}={x}"))
            .collect();
        let run = format!(
            "integrate --system {path} {} --until {until} --method {method} --rtol {rtol} --atol {rtol} --final-only --estimate-error",
            set.join(" ")
        );
        let made = object(&run);
        let final_ = &made["result"]["final"];
        assert!(final_["error_estimate"].is_number(), "{run}: {made}");
        for (state, exact) in states.iter().zip(exact) {
            let [value, off] = ["", "_uncertainty"]
                .map(|part| number(&made, &format!("/result/final/{state}{part}")));
            // The closed form is rounded too.
            let rounding = 1e-13 * (1.0 + exact.abs()) * (1.0 + until);
            assert!(
                (value - exact).abs() <= off + rounding,
                "{run}: {state} = {value} ± {off} for {exact}"
            );
        }
    }
}

/// A damped oscillator with another stiffness on either side: half a turn on each takes pi over its frequency.
#[test]
fn bilinear_oscillators() {
    let text = r#"
        name = "bilinear oscillator"
        states = ["x", "v"]
        [parameters]
        left = 1.0
        right = 2.0
        d = 0.1
        [rates]
        x = "v"
        v = "-2*d*v - left*min(x, 0) - right*max(x, 0)"
        [start]
        x = 0.0
        v = 1.0
        "#;
    holds(("bilinear", text), ["x", "v"], 1, |draws, set| {
        let [left, right] = [0, 1].map(|_| draws.scale(0.3, 300.0));
        let d = draws.within(0.0, 0.3);
        let until = draws.within(1.0, 30.0);
        set.extend([("left", left), ("right", right), ("d", d)]);
        let (mut rest, mut v, mut stiffness, mut other) = (until, 1.0_f64, right, left);
        loop {
            let w = (stiffness - d * d).sqrt();
            if rest < PI / w {
                let (sin, cos) = (w * rest).sin_cos();
                let decay = (-d * rest).exp();
                return (
                    until,
                    [v / w * sin * decay, v * decay * (cos - d / w * sin)],
                );
            }
            rest -= PI / w;
            v *= -(-d * PI / w).exp();
            std::mem::swap(&mut stiffness, &mut other);
        }
    });
}

/// A spring that yields: sinusoids within its limit, parabolas beyond.
#[test]
fn springs_with_a_limit() {
    let text = r#"
        name = "spring with a limit"
        states = ["x", "v"]
        [parameters]
        k = 1.0
        g = 1.0
        [rates]
        x = "v"
        v = "-max(min(k*x, g), -g)"
        [start]
        x = 0.0
        v = 1.0
        "#;
    holds(("limited", text), ["x", "v"], 2, |draws, set| {
        let (k, limit) = (draws.scale(1.0, 1e4), draws.within(0.05, 0.9));
        let until = draws.within(0.5, 20.0);
        // From 0 to where it yields, at x = limit/w, then there and back, and to 0 again.
        let w = k.sqrt();
        let (reach, g) = (limit / w, k * limit / w);
        set.extend([("k", k), ("g", g)]);
        let (inside, speed) = (limit.asin() / w, ((1.0 - limit) * (1.0 + limit)).sqrt());
        let half = 2.0 * inside + 2.0 * speed / g;
        let halves = (until / half).floor();
        let rest = f64::mul_add(-halves, half, until);
        let (x, v) = if rest <= inside {
            ((w * rest).sin() / w, (w * rest).cos())
        } else if rest <= half - inside {
            let beyond = rest - inside;
            (
                reach + speed * beyond - 0.5 * g * beyond * beyond,
                speed - g * beyond,
            )
        } else {
            let left = w * (half - rest);
            (left.sin() / w, -left.cos())
        };
        let sign = if halves % 2.0 == 0.0 { 1.0 } else { -1.0 };
        (until, [sign * x, sign * v])
    });
}

/// A triangular pulse in time, which begins, turns and ends within what else would be one step.
#[test]
fn pulses_that_begin_and_end() {
    let text = r#"
        name = "pulse"
        states = ["s", "u"]
        [parameters]
        begin = 1.0
        end = 2.0
        a = 1.0
        [rates]
        s = "1"
        u = "a*max(0, min(s - begin, end - s))"
        [start]
        s = 0.0
        u = 0.0
        "#;
    holds(("pulse", text), ["s", "u"], 3, |draws, set| {
        let (begin, width, a) = (
            draws.within(0.0, 50.0),
            draws.scale(1e-6, 10.0),
            draws.scale(0.01, 1e6),
        );
        let until = draws.within(0.1, 100.0);
        let end = begin + width;
        set.extend([("begin", begin), ("end", end), ("a", a)]);
        let (since, width) = (until - begin, end - begin);
        let rising = |t: f64| 0.5 * t * t;
        let area = if since <= 0.0 {
            0.0
        } else if since <= 0.5 * width {
            rising(since)
        } else {
            2.0 * rising(0.5 * width) - rising((width - since).max(0.0))
        };
        (until, [until, a * area])
    });
}

/// Growth that changes at a threshold: exponentials on either side.
#[test]
fn growth_that_changes_at_a_threshold() {
    let text = r#"
        name = "threshold"
        states = ["x"]
        [parameters]
        a = 1.0
        b = 2.0
        c = 1.0
        e = 1.0
        [rates]
        x = "e + a*x + b*max(0, x - c)"
        [start]
        x = 0.0
        "#;
    holds(("threshold", text), ["x"], 4, |draws, set| {
        let (a, b) = (draws.within(0.1, 2.0), draws.within(-8.0, 2.0));
        let (c, e) = (draws.within(0.01, 2.0), draws.scale(0.1, 10.0));
        let until = draws.within(0.1, 4.0);
        set.extend([("a", a), ("b", b), ("c", c), ("e", e)]);
        // x' = p + q x from x0.
        let linear = |p: f64, q: f64, x0: f64, t: f64| x0 + (p + q * x0) * (q * t).exp_m1() / q;
        let meets = (1.0 + a * c / e).ln() / a;
        if until <= meets {
            return (until, [linear(e, a, 0.0, until)]);
        }
        (until, [linear(e - b * c, a + b, c, until - meets)])
    });
}
