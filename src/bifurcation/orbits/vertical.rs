//! Vertical branches: at a degenerate Hopf point all orbits exist at one value of the parameter, as in a conservative system.
//!
//! Along such a branch the parameter varies by no more than the noise of its values. Nothing bifurcates there, and what looks
//! like folds is noise.

use crate::orbit::{Condition, DirectedPoint, Palc};

/// Standard deviations of what is noise.
const DEVIATIONS: f64 = 5.0;
/// Fewer orbits, or orbits of less different sizes, show nothing.
const FEWEST: usize = 8;
const SIZES: f64 = 4.0;
/// So many orbits of a vertical branch are enough.
const ENOUGH: usize = 60;

/// What is known of a branch that has been vertical so far.
#[derive(Debug, Clone, Copy, Default)]
pub struct Vertical {
    orbits: usize,
    /// The least and the greatest coordinate of the parameter, and the largest standard deviation of one.
    coordinates: (f64, f64),
    noise: f64,
    /// The smallest one.
    least: f64,
    /// The least and the greatest extent.
    extents: (f64, f64),
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

    /// How many orbits there are.
    pub fn orbits(&self) -> usize {
        self.orbits
    }

    /// How far the coordinate of the parameter may be off.
    pub fn uncertainty(&self) -> f64 {
        self.range() + DEVIATIONS * self.least
    }
}
