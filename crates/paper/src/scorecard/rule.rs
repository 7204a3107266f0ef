//! The rule of the verdicts.
//!
//! - A printed number agrees if it lies within half a unit of its last digit from the computed one, that is if rounding the
//!   computed one to the printed digits gives it. The uncertainty of the computed one does not help.
//! - A printed bound, `< 0.135`, is a claim about a largest value: it agrees if that value, rounded to the printed digits or
//!   rounded up to them, is the bound. So the bound must be right and as tight as its digits allow. `> x` likewise.
//! - A number that is printed in two forms, `0.0552 (log10: -1.2582)`, is one fact: it agrees if it does in both.
//! - A claim agrees if the computed word is the printed one.

use super::Answer;

/// What stands between a number and its logarithm, where both are printed.
const LOGARITHM: &str = " (log10: ";

/// What comes of the comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Agreement {
    /// By the rule.
    Agrees,
    /// By the rule.
    Differs,
    /// It differs, and there is a reason to think that something else was meant.
    Misprint,
}

impl Agreement {
    /// The word in files.
    pub fn name(self) -> &'static str {
        match self {
            Agreement::Agrees => "agrees",
            Agreement::Differs => "differs",
            Agreement::Misprint => "misprint",
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
pub fn compare(printed: &str, computed: &Answer) -> (Agreement, bool) {
    let verdict = |agrees: bool| {
        if agrees {
            Agreement::Agrees
        } else {
            Agreement::Differs
        }
    };
    let x = match computed {
        Answer::Word(word) => return (verdict(*word == printed), true),
        Answer::Number(x) => x,
    };
    let Some(agrees) = rule(printed) else {
        return (Agreement::Differs, true);
    };
    let all = [
        agrees(x.value),
        agrees(x.value - x.uncertainty),
        agrees(x.value + x.uncertainty),
    ];
    (verdict(all[0]), all[1] == all[0] && all[2] == all[0])
}

/// A printed number as text, and its logarithm where that is printed too.
pub(super) fn forms(printed: &str) -> (&str, Option<&str>) {
    let both = printed.strip_suffix(')');
    match both.and_then(|both| both.split_once(LOGARITHM)) {
        Some((number, logarithm)) => (number, Some(logarithm)),
        None => (printed, None),
    }
}

/// By which part a printed number or bound differs from the computed one; where a logarithm is printed too, the finer of both,
/// the number that it is the logarithm of. `None` of claims.
pub fn difference(printed: &str, computed: &Answer) -> Option<f64> {
    let Answer::Number(x) = computed else {
        return None;
    };
    let (number, logarithm) = forms(printed);
    let part = match logarithm {
        Some(text) => {
            let off = Decimal::read(text)?.value - x.value.log10();
            (std::f64::consts::LN_10 * off).exp_m1()
        }
        None => Decimal::read(number.trim_start_matches(['<', '>', ' ']))?.value / x.value - 1.0,
    };
    part.is_finite().then_some(part)
}

/// What a printed number or bound asks of the computed one; `None` for a text that is neither.
fn rule(printed: &str) -> Option<Box<dyn Fn(f64) -> bool>> {
    if let (number, Some(logarithm)) = forms(printed) {
        let (number, logarithm) = (rule(number)?, Decimal::read(logarithm)?);
        return Some(Box::new(move |x| {
            number(x) && logarithm.is_rounded(x.log10())
        }));
    }
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
