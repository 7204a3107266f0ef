//! Vertical branches: at a degenerate Hopf point all orbits exist at one value of the parameter, as in a conservative system.
//!
//! Along such a branch the parameter varies by no more than the noise of its values. Nothing bifurcates there, and what looks
//! like folds is noise.

use super::chart::Chart;
use super::refine::rough;
use super::rows::GivenParameters;
use crate::bifurcation::{Label, Special};
use crate::number::Uncertain;
use crate::orbit::{Condition, DirectedPoint, Palc};

/// Standard deviations of what is noise.
const DEVIATIONS: f64 = 5.0;
/// Fewer orbits, or orbits of less different sizes, show nothing.
const FEWEST: usize = 8;
const SIZES: f64 = 4.0;
/// So many orbits of a vertical branch are enough.
const ENOUGH: usize = 60;
/// Where no more is asked for than that it is vertical, orbits of so different sizes are.
const PLENTY: f64 = 64.0;

/// What is known of a branch that has been vertical so far.
#[derive(Debug, Clone, Copy, Default)]
pub struct Vertical {
    orbits: usize,
    /// The least and the greatest coordinate of the parameter, and the largest standard deviation of one.
    coordinates: (f64, f64),
    noise: f64,
    /// The smallest one.
    least: f64,
    /// The least and the greatest extent and period.
    extents: (f64, f64),
    periods: (f64, f64),
}

fn widened(range: (f64, f64), x: f64, first: bool) -> (f64, f64) {
    if first {
        (x, x)
    } else {
        (range.0.min(x), range.1.max(x))
    }
}

impl Vertical {
    /// With the next orbit; `None` where the parameter varies.
    pub fn and(
        self,
        palc: &mut Palc<'_, '_>,
        DirectedPoint { here, direction }: &DirectedPoint,
        free: usize,
    ) -> Option<Self> {
        let (site, first) = (&here.site, self.orbits == 0);
        let plane = [Condition::Plane(direction, site)];
        let all_free = &palc.curve.settings.free;
        let noise = palc.curve.corrector.noise(here, all_free, &plane)?;
        let next = Vertical {
            orbits: self.orbits + 1,
            coordinates: widened(self.coordinates, site.at[free], first),
            noise: self.noise.max(noise.parameters[free]),
            least: widened((self.least, self.least), noise.parameters[free], first).0,
            extents: widened(self.extents, site.shooting.extent(), first),
            periods: widened(self.periods, site.shooting.period(), first),
        };
        (next.range() <= 2.0 * DEVIATIONS * next.noise).then_some(next)
    }

    fn range(&self) -> f64 {
        self.coordinates.1 - self.coordinates.0
    }

    /// Whether there are orbits enough to say so.
    pub fn is_shown(&self) -> bool {
        self.orbits >= FEWEST && self.extents.1 > SIZES * self.extents.0
    }

    /// Whether there are more than that.
    pub fn is_enough(&self) -> bool {
        self.orbits >= ENOUGH && self.is_shown()
    }

    /// Whether there are so many, or of so different sizes, that there is no doubt.
    pub fn is_plain(&self) -> bool {
        self.is_enough() || self.is_shown() && self.extents.1 > PLENTY * self.extents.0
    }

    /// How many orbits there are.
    pub fn orbits(&self) -> usize {
        self.orbits
    }

    /// How far the coordinate of the parameter may be off.
    pub fn uncertainty(&self) -> f64 {
        self.range() + DEVIATIONS * self.least
    }

    /// The end of the branch, in words.
    pub fn end(
        &self,
        palc: &Palc<'_, '_>,
        chart: Chart,
        free: usize,
        mut given: GivenParameters,
    ) -> Special {
        let name = ["V_H", "K"][free];
        let mut special = rough(Label::Ep, &chart.usual(&palc.now.here.site));
        given[free] = None;
        special.given(given);
        let place = [&mut special.driving, &mut special.stiffness];
        let uncertainty = self.uncertainty();
        for (_, place) in place.into_iter().enumerate().filter(|(i, _)| *i == free) {
            *place = Uncertain::new(place.value, uncertainty * place.value);
        }
        special.note = Some(format!(
            "vertical branch: on {} orbits of periods from {:.6} to {:.6} {name} varies by {:.1e} of its value, within the \
             error. The Hopf point is degenerate: all orbits exist at this {name} at once, as in a conservative system. Not \
             followed further",
            self.orbits,
            self.periods.0,
            self.periods.1,
            self.range()
        ));
        special
    }
}
