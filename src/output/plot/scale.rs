//! The range of an axis, its ticks and their labels.

use super::Axis;

/// At most so many ticks.
const TICKS: usize = 7;
/// Logarithmic axes shorter than this have ticks at 2 and 5 too.
const FEW_DECADES: f64 = 2.6;
/// And those shorter than this at every digit.
const SHORT: f64 = 0.8;
/// Decades on a logarithmic axis, at least.
const NARROWEST: f64 = 0.5;

/// An axis with its range, in the coordinate that is drawn: log10 for a logarithmic axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    /// Left or lower end.
    pub lo: f64,
    /// Right or upper end.
    pub hi: f64,
    /// Where there are ticks.
    pub ticks: Vec<f64>,
    log: bool,
    step: f64,
}

impl Scale {
    /// For all these values; `None` if none of them can be drawn. The `margin` is a part of their range.
    pub fn new<'a>(
        axis: &Axis,
        values: impl Iterator<Item = &'a f64>,
        margin: f64,
    ) -> Option<Self> {
        let drawn = values
            .map(|&x| coordinate(axis.log, x))
            .filter(|x| x.is_finite());
        let (lo, hi) = drawn.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| {
            (lo.min(x), hi.max(x))
        });
        if lo > hi {
            return None;
        }
        // A constant gets a range that shows it as one.
        let pad = if axis.log {
            (0.5 * (NARROWEST - (hi - lo))).max(margin * (hi - lo))
        } else {
            let least = 1e-3 * lo.abs().max(hi.abs()).max(1e-300);
            if hi - lo < least {
                least
            } else {
                margin * (hi - lo)
            }
        };
        let (lo, hi) = (lo - pad, hi + pad);
        let step = if axis.log {
            nice((hi - lo) / TICKS as f64).max(1.0).ceil()
        } else {
            nice((hi - lo) / TICKS as f64)
        };
        let first = (lo / step).ceil();
        let even = (0..=2 * TICKS).map(|i| (first + i as f64) * step);
        let ticks: Vec<f64> = if axis.log && hi - lo < FEW_DECADES {
            // Powers of ten alone would leave an axis with one number or none.
            let decades = lo.floor() as i32..=hi.ceil() as i32;
            let between: &[f64] = if hi - lo < SHORT {
                &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]
            } else {
                &[1.0, 2.0, 5.0]
            };
            decades
                .flat_map(|n| between.iter().map(move |m| f64::from(n) + m.log10()))
                .collect()
        } else {
            even.collect()
        };
        let rounding = 1e-9 * step;
        let ticks = ticks
            .into_iter()
            .filter(|&x| x >= lo - rounding && x <= hi + rounding)
            .collect();
        Some(Scale {
            lo,
            hi,
            ticks,
            log: axis.log,
            step,
        })
    }

    /// Where a value is drawn.
    pub fn at(&self, x: f64) -> f64 {
        coordinate(self.log, x)
    }

    /// What a tick says.
    pub fn label(&self, tick: f64) -> String {
        if self.log {
            let exponent = (tick + 1e-9).floor();
            let mantissa = 10f64.powf(tick - exponent).round();
            return match (mantissa as i64, exponent as i64) {
                (1, n) if self.hi - self.lo >= FEW_DECADES => power(n),
                (m, n @ -3..=0) => {
                    format!(
                        "{:.*}",
                        n.unsigned_abs() as usize,
                        m as f64 * 10f64.powi(n as i32)
                    )
                }
                (m, n @ 1..=3) => (m * 10_i64.pow(n as u32)).to_string(),
                (1, n) => power(n),
                (m, n) => format!("{m}·{}", power(n)),
            };
        }
        let largest = self.lo.abs().max(self.hi.abs());
        if (1e-4..1e6).contains(&largest) {
            let digits = (-self.step.log10() - 1e-9).ceil().max(0.0) as usize;
            let text = format!("{tick:.digits$}");
            return if text.trim_start_matches(['-', '0', '.']).is_empty() {
                "0".into()
            } else {
                text.replace('-', "−")
            };
        }
        // One power for all ticks, with as many digits as the step needs.
        let exponent = largest.log10().floor();
        let digits = (exponent - self.step.log10() - 1e-9).ceil().max(0.0) as usize;
        if tick == 0.0 {
            return "0".into();
        }
        let mantissa = format!("{:.digits$}", tick / 10f64.powf(exponent));
        format!("{}·{}", mantissa.replace('-', "−"), power(exponent as i64))
    }
}

fn coordinate(log: bool, x: f64) -> f64 {
    if log { x.log10() } else { x }
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

    #[test]
    fn ticks_are_few_and_read_well() {
        let scale = Scale::new(&Axis::log("v"), [1e-7, 1e5].iter(), 0.04).unwrap();
        assert!(scale.ticks.len() <= TICKS + 1);
        assert_eq!(scale.label(-6.0), "10⁻⁶");
        assert_eq!(scale.label(14.0), "10¹⁴");
        let scale = Scale::new(&Axis::linear("t"), [0.0, 2000.0].iter(), 0.0).unwrap();
        assert_eq!((scale.lo, scale.hi), (0.0, 2000.0));
        assert_eq!(scale.label(500.0), "500");
        let scale = Scale::new(&Axis::linear("t"), [0.0, 0.3].iter(), 0.0).unwrap();
        assert_eq!(scale.label(0.1), "0.10");
        let scale = Scale::new(&Axis::linear("p"), [0.0, 4e7].iter(), 0.0).unwrap();
        assert_eq!(scale.label(2e7), "2·10⁷");
    }
}
