//! What the interfaces are: each with its own constants, or all alike.

use super::constants::{Constants, Kind, LANES, OneOfMany, Single};
use super::share::Share;
use crate::error::{Error, Result};
use crate::friction::positive;
use crate::model::Loading;

/// Interfaces that share the stress, with laws whose state ages.
///
/// ```
/// use twinslip::friction::{AnyLaw, Parameters};
/// use twinslip::many::{ManyInterfaces, ManyTaylor};
/// use twinslip::model::Loading;
/// # fn main() -> twinslip::Result<()> {
/// let law = AnyLaw::Spinodal(Parameters::heslot_1994().spinodal());
/// let thousand = ManyInterfaces::alike(law, 1000, Loading::new(10.0, 0.14)?)?;
/// let states: Vec<f64> = (1..=1000).map(|i| 0.002 * (1.0 + 0.01 * f64::from(i))).collect();
/// let end = ManyTaylor::new(1e-15, 10_000)?.flow(&thousand, (9.9, &states), 1.0, &mut |_| Ok(true))?;
/// assert!((end.stress() / 6.742 - 1.0).abs() < 1e-3);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct ManyInterfaces {
    pub(super) share: Share,
    pub(super) constants: Vec<Constants>,
    pub(super) kind: Kind,
    /// V_H and K.
    pub loading: Loading,
}

impl ManyInterfaces {
    /// So many equal ones.
    ///
    /// # Errors
    /// [`Error::Parameter`] for none, and for a law that is not of this kind.
    pub fn alike(one: impl Into<OneOfMany>, count: usize, loading: Loading) -> Result<Self> {
        Self::alike_in(Share::all(count), &one.into(), loading)
    }

    /// The same, of which this process holds a share.
    ///
    /// # Errors
    /// As [`ManyInterfaces::alike`].
    pub fn alike_in(share: Share, one: &OneOfMany, loading: Loading) -> Result<Self> {
        if share.count() == 0 {
            return Err(Error::parameter("interfaces", 0, "at least 1"));
        }
        let single = Single::new(one)?;
        let constants = Constants::of([single; LANES]);
        let held = share.held().len();
        let beside = held % LANES;
        let mut all = vec![constants];
        if beside != 0 {
            all = vec![constants; held.div_ceil(LANES)];
            // What stands beside the last one is no interface.
            all[held / LANES].factor[beside..].fill(0.0);
        }
        Ok(ManyInterfaces {
            share,
            constants: all,
            kind: Kind {
                exponential: single.exponential,
                own_stress: single.own_stress(),
                slip: single.slip,
            },
            loading,
        })
    }

    /// Each as it is.
    ///
    /// # Errors
    /// [`Error::Parameter`] for none, for laws that are not of this kind, and for direct effects that are partly exponential.
    pub fn new(all: &[OneOfMany], loading: Loading) -> Result<Self> {
        let share = Share::all(all.len());
        Self::new_in(share, all.iter().copied().map(Ok), loading)
    }

    /// Of the share that this process holds each as it is, one after the other.
    ///
    /// # Errors
    /// As [`ManyInterfaces::new`], and those of the iterator.
    pub fn new_in(
        share: Share,
        mut held: impl Iterator<Item = Result<OneOfMany>>,
        loading: Loading,
    ) -> Result<Self> {
        if share.count() == 0 {
            return Err(Error::parameter("interfaces", 0, "at least 1"));
        }
        let count = share.held().len();
        let mut kind: Option<Kind> = None;
        let mut constants = Vec::with_capacity(count.div_ceil(LANES));
        let mut lanes: Vec<Single> = Vec::with_capacity(LANES);
        for i in 0..count {
            let one = held.next().unwrap_or_else(|| {
                Err(Error::parameter(
                    "the number of laws",
                    i,
                    format!("{count}"),
                ))
            })?;
            let single = Single::new(&one)?;
            let kind = kind.get_or_insert(Kind {
                exponential: single.exponential,
                own_stress: false,
                slip: single.slip,
            });
            if (single.exponential, single.slip) != (kind.exponential, kind.slip) {
                let name = one.law.name();
                return Err(Error::parameter("law", name, "of one kind for all"));
            }
            kind.own_stress |= single.own_stress();
            lanes.push(single);
            if lanes.len() == LANES || i + 1 == count {
                // What stands beside the last one is no interface.
                let mut none = single;
                none.factor = 0.0;
                let of_lanes = |lane: usize| lanes.get(lane).copied().unwrap_or(none);
                constants.push(Constants::of(std::array::from_fn(of_lanes)));
                lanes.clear();
            }
        }
        Ok(ManyInterfaces {
            share,
            constants,
            kind: kind.unwrap_or(Kind {
                exponential: false,
                own_stress: false,
                slip: false,
            }),
            loading,
        })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.share.count()
    }

    /// Which this process holds.
    pub fn share(&self) -> &Share {
        &self.share
    }

    /// Blocks held here.
    pub(super) fn blocks(&self) -> usize {
        self.share.held().len().div_ceil(LANES)
    }

    /// Whether a run can begin in this stress and these states.
    pub(super) fn checked(&self, stress: f64, states: &[f64]) -> Result<()> {
        positive("tau in `start`", stress)?;
        for &psi in states {
            positive("psi in `start`", psi)?;
        }
        let held = self.share.held().len();
        if states.len() != held {
            let must = format!("{held}, one for each interface");
            return Err(Error::parameter("the number of states", states.len(), must));
        }
        Ok(())
    }

    /// Bytes of the constants.
    pub(super) fn constants_memory(&self) -> usize {
        self.constants.len() * size_of::<Constants>()
    }
}
