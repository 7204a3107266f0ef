//! The rule of the verdicts.
//!
//! - A printed number agrees if it lies within half a unit of its last digit from the computed one, that is if rounding the
//!   computed one to the printed digits gives it. The uncertainty of the computed one does not help.
//! - A printed bound, `< 0.135`, is a claim about a largest value: it agrees if that value, rounded to the printed digits or
//!   rounded up to them, is the bound. So the bound must be right and as tight as its digits allow. `> x` likewise.
//! - A claim agrees if the computed word is the printed one.

use super::Answer;

/// What comes of the comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// By the rule.
    Agrees,
    /// By the rule.
    Differs,
    /// It differs, and there is a reason to think that something else was meant.
    Misprint,
}

impl Verdict {
    /// The word in files.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Agrees => "agrees",
            Verdict::Differs => "differs",
            Verdict::Misprint => "misprint",
        }
    }
}

/// A number as it is printed: its value and the unit of its last digit.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Decimal {
    value: f64,
    unit: f64,
}

impl Decimal {
    fn read(text: &str) -> Option<Self> {
        let value: f64 = text.parse().ok().filter(|x: &f64| x.is_finite())?;
        let (digits, power) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        let behind = digits.split_once('.').map_or(0, |(_, behind)| behind.len());
        let power: i32 = power.parse().ok()?;
        // As text, so that the unit is the double next to the decimal.
        let unit = format!("1e{}", power - behind as i32).parse().ok()?;
        Some(Decimal { value, unit })
    }

    fn is_rounded(self, x: f64) -> bool {
        (x - self.value).abs() <= 0.5 * self.unit
    }

    fn is_tight_above(self, x: f64) -> bool {
        self.is_rounded(x) || (x <= self.value && x > self.value - self.unit)
    }

    fn is_tight_below(self, x: f64) -> bool {
        self.is_rounded(x) || (x >= self.value && x < self.value + self.unit)
    }
}

/// The verdict, and whether it is the same wherever the true value lies within its uncertainty. A misprint is never found here.
pub fn judge(printed: &str, computed: &Answer) -> (Verdict, bool) {
    let verdict = |agrees: bool| {
        if agrees {
            Verdict::Agrees
        } else {
            Verdict::Differs
        }
    };
    let x = match computed {
        Answer::Word(word) => return (verdict(*word == printed), true),
        Answer::Number(x) => x,
    };
    let Some(agrees) = rule(printed) else {
        return (Verdict::Differs, true);
    };
    let all = [
        agrees(x.value),
        agrees(x.value - x.uncertainty),
        agrees(x.value + x.uncertainty),
    ];
    (verdict(all[0]), all[1] == all[0] && all[2] == all[0])
}

/// What a printed number or bound asks of the computed one; `None` for a text that is neither.
fn rule(printed: &str) -> Option<Box<dyn Fn(f64) -> bool>> {
    if let Some(bound) = printed.strip_prefix('<') {
        let bound = Decimal::read(bound.trim())?;
        return Some(Box::new(move |x| bound.is_tight_above(x)));
    }
    if let Some(bound) = printed.strip_prefix('>') {
        let bound = Decimal::read(bound.trim())?;
        return Some(Box::new(move |x| bound.is_tight_below(x)));
    }
    let number = Decimal::read(printed.trim())?;
    Some(Box::new(move |x| number.is_rounded(x)))
}
