//! What the interfaces are: each with its own constants, or all alike.

use super::block::{Block, Constants, LANES};
use crate::error::{Error, Result};
use crate::friction::{AgeingForm, AnyLaw, Law};
use crate::model::Loading;

/// Interfaces that share the stress, with laws whose state ages.
///
/// ```
/// use twinslip::friction::{AnyLaw, Parameters};
/// use twinslip::many::{ManyInterfaces, ManyTaylor};
/// use twinslip::model::Loading;
/// # fn main() -> twinslip::Result<()> {
/// let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
/// let thousand = ManyInterfaces::alike(&law, 1000, Loading::new(10.0, 0.14)?)?;
/// let states: Vec<f64> = (1..=1000).map(|i| 0.002 * (1.0 + 0.01 * f64::from(i))).collect();
/// let end = ManyTaylor::new(1e-15, 10_000)?.flow(&thousand, (9.9, &states), 1.0, &mut |_| Ok(true))?;
/// assert!((end.stress() / 6.742 - 1.0).abs() < 1e-3);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ManyInterfaces {
    pub(super) count: usize,
    pub(super) constants: Vec<Constants>,
    pub(super) exponential: bool,
    /// V_H and K.
    pub loading: Loading,
}

impl ManyInterfaces {
    /// So many equal ones.
    ///
    /// # Errors
    /// [`Error::Parameter`] for none, and for a law that is not of this kind.
    pub fn alike(law: &AnyLaw, count: usize, loading: Loading) -> Result<Self> {
        if count == 0 {
            return Err(Error::parameter("interfaces", count, "at least 1"));
        }
        let one = of_lanes([form(law)?; LANES], [1.0; LANES]);
        let mut constants = vec![one];
        let beside = count % LANES;
        if beside != 0 {
            constants = vec![one; count.div_ceil(LANES)];
            let last = &mut constants[count / LANES];
            // What stands beside the last one is no interface.
            last.factor[beside..].fill(0.0);
        }
        Ok(ManyInterfaces {
            count,
            constants,
            exponential: form(law)?.exponential,
            loading,
        })
    }

    /// Each with its law, and its slip length in units of that of the first, in which times and rates are measured too.
    ///
    /// # Errors
    /// [`Error::Parameter`] for none, for laws that are not of this kind, and for direct effects that are partly exponential.
    pub fn new(laws: &[(AnyLaw, f64)], loading: Loading) -> Result<Self> {
        let Some((first, _)) = laws.first() else {
            return Err(Error::parameter("interfaces", 0, "at least 1"));
        };
        let exponential = form(first)?.exponential;
        let mut constants = Vec::with_capacity(laws.len().div_ceil(LANES));
        for block in laws.chunks(LANES) {
            // What stands beside the last one is no interface.
            let at = |lane: usize| block[lane.min(block.len() - 1)];
            let mut forms = [form(first)?; LANES];
            for (lane, one) in forms.iter_mut().enumerate() {
                *one = form(&at(lane).0)?;
                if one.exponential != exponential {
                    let name = at(lane).0.name();
                    return Err(Error::parameter("law", name, "of one kind for all"));
                }
                if lane >= block.len() {
                    one.gamma0 = 0.0;
                }
            }
            let lengths = std::array::from_fn(|lane| at(lane).1);
            constants.push(of_lanes(forms, lengths));
        }
        Ok(ManyInterfaces {
            count: laws.len(),
            constants,
            exponential,
            loading,
        })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Bytes that a run takes, without rows.
    pub fn memory(&self) -> usize {
        self.count.div_ceil(LANES) * size_of::<Block>()
            + self.constants.len() * size_of::<Constants>()
            + self.count * size_of::<f64>()
    }

    /// The blocks at the beginning.
    pub(super) fn blocks(&self, states: &[f64]) -> Vec<Block> {
        let all = states.chunks(LANES).enumerate();
        let block = |(i, states): (usize, &[f64])| {
            let of = super::block::of(&self.constants, i);
            Block::at(std::array::from_fn(|lane| {
                let psi = states[lane.min(states.len() - 1)];
                of.rest[lane] + of.slope[lane] * psi
            }))
        };
        all.map(block).collect()
    }
}

fn form(law: &AnyLaw) -> Result<AgeingForm> {
    let ages = law.ageing_form().filter(|_| law.damping() == 0.0);
    ages.ok_or_else(|| {
        let what = match law.damping() {
            0.0 => "one whose state ages: spinodal, bounded, regularised-ageing or dieterich-ruina",
            _ => "without damping",
        };
        Error::parameter("the law of many interfaces", law.name(), what)
    })
}

fn of_lanes(forms: [AgeingForm; LANES], lengths: [f64; LANES]) -> Constants {
    let half = |form: &AgeingForm| if form.exponential { 0.5 } else { 1.0 };
    Constants {
        beta: forms.map(|form| form.beta),
        factor: forms.map(|form| half(&form) * form.gamma0),
        rest: forms.map(|form| form.strength[0]),
        slope: forms.map(|form| form.strength[1]),
        source: forms.map(|form| form.healing[0]),
        relaxation: forms.map(|form| form.healing[1]),
        per_length: lengths.map(|length| 1.0 / length),
    }
}
