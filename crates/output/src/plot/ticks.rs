//! Where an axis has ticks and what they say: as many as have room.

use super::scale::Scale;

/// At most so many ticks.
const TICKS: usize = 7;
/// Logarithmic axes shorter than this have ticks at 2 and 5 too.
const FEW_DECADES: f64 = 2.6;
/// And those shorter than this at every digit.
const SHORT: f64 = 0.8;
/// Even those leave axes shorter than this with a number or none: they have ticks at equal differences.
const SHORTEST: f64 = 0.3;
/// Where a decade has fewer pixels than this, a small tick is at each power of ten only.
const DECADE: f64 = 45.0;

/// A tick with its label.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// The coordinate.
    pub at: f64,
    /// What it says.
    pub label: String,
}

/// The ticks of an axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ticks {
    /// With a label.
    pub named: Vec<Tick>,
    /// Without.
    pub small: Vec<f64>,
}

impl Ticks {
    /// The most that fit on an axis that long in pixels, by the judgement of who knows how large the labels are.
    pub fn fitting(scale: &Scale, pixels: f64, fits: impl Fn(&[Tick]) -> bool) -> Self {
        let choices = choices(scale);
        // One number says nothing of an axis, if two can be had.
        let with = |least: usize| choices.iter().filter(move |ticks| ticks.len() >= least);
        let chosen = with(2)
            .find(|ticks| fits(ticks))
            .or_else(|| with(1).find(|ticks| fits(ticks)))
            .or_else(|| with(1).next_back());
        let mut named = chosen.cloned().unwrap_or_default();
        if !fits(&named) {
            named.truncate(1);
        }
        let small = small(scale, pixels, &named);
        Ticks { named, small }
    }
}

/// Sets of ticks, the densest first.
fn choices(scale: &Scale) -> Vec<Vec<Tick>> {
    let length = scale.hi - scale.lo;
    if !scale.log {
        let steps = (1..=TICKS).rev().map(|n| nice(length / n as f64));
        return steps
            .map(|step| even(scale.lo, scale.hi, step, &|x| x))
            .collect();
    }
    let mut choices = Vec::new();
    if length >= FEW_DECADES {
        let steps = [1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];
        let few = steps.iter().filter(|&&step| length / step <= TICKS as f64);
        let powers = few.map(|&step| decades(scale, step));
        choices.extend(powers);
        return choices;
    }
    let digits: &[&[f64]] = &[
        &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
        &[1.0, 2.0, 5.0],
        &[1.0, 3.0],
        &[1.0],
    ];
    if length >= SHORTEST {
        let allowed = if length < SHORT { digits } else { &digits[1..] };
        choices.extend(allowed.iter().map(|digits| at_digits(scale, digits)));
    }
    let (lo, hi) = (10f64.powf(scale.lo), 10f64.powf(scale.hi));
    let steps = (1..=TICKS - 2).rev().map(|n| nice((hi - lo) / n as f64));
    choices.extend(steps.map(|step| even(lo, hi, step, &f64::log10)));
    choices
}

/// Ticks at the multiples of a step.
fn even(lo: f64, hi: f64, step: f64, place: &dyn Fn(f64) -> f64) -> Vec<Tick> {
    let largest = lo.abs().max(hi.abs());
    let first = (lo / step - 1e-9).ceil();
    (0..=2 * TICKS)
        .map(|i| (first + i as f64) * step)
        .filter(|&x| x <= hi + 1e-9 * step)
        .map(|x| Tick {
            at: place(x),
            label: plain(x, step, largest),
        })
        .collect()
}

/// Ticks at powers of ten.
fn decades(scale: &Scale, step: f64) -> Vec<Tick> {
    let first = (scale.lo / step - 1e-9).ceil();
    (0..=TICKS)
        .map(|i| (first + i as f64) * step)
        .filter(|&at| at <= scale.hi + 1e-9)
        .map(|at| Tick {
            at,
            label: power(at.round() as i64),
        })
        .collect()
}

/// Ticks at these digits of each decade.
fn at_digits(scale: &Scale, digits: &[f64]) -> Vec<Tick> {
    let ticks = digits_within(scale, digits).into_iter();
    ticks
        .map(|(digit, exponent, at)| Tick {
            at,
            label: digit_label(digit, exponent),
        })
        .collect()
}

fn digits_within(scale: &Scale, digits: &[f64]) -> Vec<(f64, i32, f64)> {
    let decades = scale.lo.floor() as i32..=scale.hi.ceil() as i32;
    decades
        .flat_map(|n| {
            digits
                .iter()
                .map(move |&m| (m, n, f64::from(n) + m.log10()))
        })
        .filter(|&(_, _, at)| at >= scale.lo - 1e-9 && at <= scale.hi + 1e-9)
        .collect()
}

/// Logarithmic axes show by small ticks that they are.
fn small(scale: &Scale, pixels: f64, named: &[Tick]) -> Vec<f64> {
    const DIGITS: [f64; 9] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
    if !scale.log {
        return Vec::new();
    }
    let digits = if pixels < DECADE * (scale.hi - scale.lo) {
        &DIGITS[..1]
    } else {
        &DIGITS[..]
    };
    let all = digits_within(scale, digits).into_iter();
    all.map(|(_, _, at)| at)
        .filter(|at| named.iter().all(|tick| (tick.at - at).abs() > 1e-9))
        .collect()
}

/// A digit times a power of ten.
fn digit_label(digit: f64, exponent: i32) -> String {
    match (digit as i64, exponent) {
        (m, n @ -3..=0) => {
            let digits = n.unsigned_abs() as usize;
            format!("{:.digits$}", m as f64 * 10f64.powi(n))
        }
        (m, n @ 1..=3) => (m * 10_i64.pow(n as u32)).to_string(),
        (1, n) => power(i64::from(n)),
        (m, n) => format!("{m}·{}", power(i64::from(n))),
    }
}

/// A multiple of a step, with as many digits as that needs.
fn plain(x: f64, step: f64, largest: f64) -> String {
    let digits = |exponent: f64| (exponent - step.log10() - 1e-9).ceil().max(0.0) as usize;
    if x.abs() < 1e-6 * step {
        return "0".into();
    }
    if (1e-4..1e6).contains(&largest) {
        let digits = digits(0.0);
        return format!("{x:.digits$}").replace('-', "−");
    }
    // One power for all ticks.
    let exponent = largest.log10().floor();
    let digits = digits(exponent);
    let mantissa = format!("{:.digits$}", x / 10f64.powf(exponent));
    format!("{}·{}", mantissa.replace('-', "−"), power(exponent as i64))
}

/// 1, 2 or 5 times a power of ten, not less than x.
fn nice(x: f64) -> f64 {
    let power = 10f64.powf(x.log10().floor());
    [1.0, 2.0, 5.0]
        .into_iter()
        .map(|m| m * power)
        .find(|&candidate| candidate >= x * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// 10 to the n, in superscripts.
fn power(n: i64) -> String {
    let digits = n.abs().to_string();
    let raised = digits.bytes().map(|digit| match digit {
        b'1' => '¹',
        b'2' => '²',
        b'3' => '³',
        b'0' => '⁰',
        other => char::from_u32(0x2074 + u32::from(other - b'4')).unwrap_or('?'),
    });
    let sign = if n < 0 { "⁻" } else { "" };
    format!("10{sign}{}", raised.collect::<String>())
}

#[cfg(test)]
mod test {
    use super::*;

    fn labels(lo: f64, hi: f64, log: bool, most: usize) -> Vec<String> {
        let scale = Scale { lo, hi, log };
        let ticks = Ticks::fitting(&scale, 400.0, |ticks| ticks.len() <= most);
        for tick in &ticks.named {
            assert!(tick.at >= lo - 1e-6 && tick.at <= hi + 1e-6, "{tick:?}");
        }
        ticks.named.into_iter().map(|tick| tick.label).collect()
    }

    #[test]
    fn ticks_are_few_and_read_well() {
        let long = labels(-7.5, 5.5, true, 99);
        assert_eq!(long, ["10⁻⁶", "10⁻⁴", "10⁻²", "10⁰", "10²", "10⁴"]);
        let thinned = labels(-3.0, 9.0, true, 5);
        assert_eq!(thinned, ["10⁻³", "10⁰", "10³", "10⁶", "10⁹"]);
        let times = labels(0.0, 2000.0, false, 99);
        assert_eq!(times, ["0", "500", "1000", "1500", "2000"]);
        assert_eq!(labels(0.0, 0.3, false, 9)[..3], ["0", "0.05", "0.10"][..]);
        assert_eq!(labels(0.0, 4e7, false, 99)[4], "4·10⁷");
        assert_eq!(labels(-0.2, 0.2, false, 5)[0], "−0.2");
    }

    #[test]
    fn short_axes_have_two_numbers_at_least() {
        assert_eq!(labels(0.0, 1.0, true, 99), ["1", "2", "5", "10"]);
        assert_eq!(labels(-2.1, -1.4, true, 3), ["0.01", "0.02"]);
        let shortest = labels(1.35_f64.log10(), 1.58_f64.log10(), true, 99);
        assert_eq!(shortest, ["1.35", "1.40", "1.45", "1.50", "1.55"]);
        for (lo, hi) in [(1.234_567, 1.234_569), (0.95, 1.05), (-3e-7, 1e-7)] {
            assert!(labels(lo, hi, false, 4).len() > 1, "{lo} to {hi}");
        }
    }

    #[test]
    fn small_ticks_stand_between() {
        let scale = |hi| Scale {
            lo: 0.0,
            hi,
            log: true,
        };
        assert_eq!(Ticks::fitting(&scale(3.0), 400.0, |_| true).small.len(), 24);
        assert_eq!(Ticks::fitting(&scale(12.0), 400.0, |_| true).small.len(), 6);
    }
}
