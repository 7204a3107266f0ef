//! Branches and curves in any parameter: of user-defined systems, and of interfaces in other parameters than V_H and K.

mod begin;
mod branch;
mod following;
mod locus;
mod row;
mod slab;
mod text;
mod watch;

pub use begin::SpecialRow;
pub use branch::{GeneralBranchPlan, GeneralFound};
pub use following::{Free, shown};
pub use locus::{GeneralLocusPlan, plane};
pub(super) use locus::{by_name, ends};
pub use row::{GeneralRow, RowKind};
pub use slab::SlabSubject;
pub use text::TextSubject;
pub use watch::Watched;
pub(super) use watch::user_functions;

use super::system::Described;
use super::units::Quantity;
use twinslip::bifurcation::general::{GeneralPoint, StateRange};
use twinslip::error::Result;
use twinslip::field::Vector;
use twinslip::orbit::{
    ContinuationPoint, Coordinate, Digits, ParametrisedField, Solution, WithinCluster,
};

/// A system with parameters by name, to be continued in any of these.
pub trait Subject: Described + Sync {
    /// The parameters, with what each measures.
    fn parameters(&self) -> Vec<(&'static str, Quantity)>;

    /// The value of one, dimensionless.
    ///
    /// # Errors
    /// [`twinslip::Error::Parameter`] for a name that is none; [`twinslip::Error::Input`] where it was not given.
    fn value(&self, name: &str) -> Result<f64>;

    /// Over one parameter, or two.
    ///
    /// # Errors
    /// [`twinslip::Error::Parameter`] for names that are none, or are the same.
    fn family<'s>(
        &'s self,
        names: &[&str],
        coordinates: [Coordinate; 2],
    ) -> Result<Box<dyn ParametrisedField + 's>>;

    /// Of equal parts the same for states in which they move alike, where there is such a family over these parameters.
    fn alike(&self, _names: &[&str]) -> Option<Box<dyn ParametrisedField + '_>> {
        None
    }

    /// Of two equal parts the same in variables that keep their difference, where there is such a family over these parameters.
    fn difference(&self, _names: &[&str]) -> Option<Box<dyn ParametrisedField + '_>> {
        None
    }

    /// The equilibria that are known at these values of parameters, the others being held.
    ///
    /// # Errors
    /// Those of the search.
    fn equilibria(&self, values: &[(&str, f64)]) -> Result<Vec<Vector>>;

    /// Whether it may have equilibria: under a periodic forcing nothing rests.
    fn may_rest(&self) -> bool {
        true
    }

    /// The box that branches of equilibria do not leave, in the units in which it is followed; empty where none was given.
    fn bounds(&self) -> Vec<StateRange> {
        Vec::new()
    }

    /// An orbit at these values of parameters, where one was asked for; its coordinates are yet to be set.
    ///
    /// # Errors
    /// As of [`twinslip::orbit::find_from`].
    fn orbit(&self, values: &[(&str, f64)]) -> Result<Option<ContinuationPoint>>;

    /// The orbits that are found at these values of parameters without a start near one; their coordinates are yet to be set. Where the
    /// search fails there are none.
    fn orbits(&self, values: &[(&str, f64)]) -> Vec<ContinuationPoint>;

    /// The coordinate in which a parameter is followed between these values.
    ///
    /// # Errors
    /// [`twinslip::Error::Parameter`] for values outside its domain.
    fn coordinate(&self, name: &str, ends: [f64; 2]) -> Result<Coordinate>;

    /// Whether it is of three variables, the last two of equal parts: then it has pitchforks.
    fn has_equal_parts(&self) -> bool {
        false
    }

    /// Groups of equal parts, each by its variables: what differs by an exchange within one of these groups is one solution.
    fn interchangeable(&self) -> Vec<Vec<Vec<usize>>> {
        if self.has_equal_parts() {
            vec![vec![vec![1], vec![2]]]
        } else {
            Vec::new()
        }
    }

    /// The clusters that can split, from 1, of interfaces in clusters.
    fn clusters(&self) -> Vec<usize> {
        Vec::new()
    }

    /// What a small split of each of these grows by, with all digits or a few: ln mu on an orbit, an eigenvalue at an equilibrium.
    ///
    /// # Errors
    /// Those of the flow along an orbit.
    fn within(
        &self,
        _family: &dyn ParametrisedField,
        _point: &GeneralPoint,
        _sharp: bool,
    ) -> Result<Vec<WithinCluster>> {
        Ok(Vec::new())
    }

    /// The unit of time in which it is followed, in its own.
    fn unit_of_time(&self) -> f64 {
        1.0
    }

    /// The length of a direction, in its own units, of states in the units in which it is followed.
    fn length(&self, direction: &Vector) -> f64 {
        direction.norm()
    }

    /// The range of a parameter where none is given, in the user's units; `None` where one must be given.
    fn default_range(&self, name: &str) -> Option<(f64, f64)>;

    /// The parameters that every row tells, held or not.
    fn always_told(&self) -> Vec<(&'static str, Quantity)>;

    /// How many variables there are.
    fn dimension(&self) -> usize;

    /// The states, or what stands for them: names and quantities.
    fn states(&self) -> Vec<(String, Quantity)>;

    /// These of a state in the units in which it is followed.
    fn state_outward(&self, state: &Vector) -> Vec<f64>;

    /// A state in the units in which it is followed by these.
    fn state_inward(&self, states: &[f64]) -> Vector;

    /// What rows tell of a state or an orbit: names and quantities.
    fn numbers(&self, kind: RowKind) -> Vec<(String, Quantity)>;

    /// These numbers of a solution at coordinates of a family.
    ///
    /// # Errors
    /// Those of the flow along an orbit.
    fn told(
        &self,
        there: (&dyn ParametrisedField, [f64; 2]),
        solution: Solution<'_>,
        digits: Digits,
    ) -> Result<Vec<f64>>;
}
