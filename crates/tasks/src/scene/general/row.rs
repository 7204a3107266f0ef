//! A row of a branch or of a curve, with its columns.

use super::Subject;
use super::begin::state_of;
use crate::scene::column::{CellValue, Column};
use crate::scene::units::{Quantity, Units};
use nalgebra::Complex;
use std::f64::consts::TAU;
use twinslip::bifurcation::equilibria::generic_crossing::BranchCrossing;
use twinslip::bifurcation::general::{GeneralPoint, GeneralSolution};
use twinslip::bifurcation::orbits::SpecialOrbit;
use twinslip::bifurcation::{Criticality, Label};
use twinslip::equilibrium::{Symmetry, Verdict};
use twinslip::error::Result;
use twinslip::field::Vector;
use twinslip::number::{Uncertain, eigenvector};
use twinslip::orbit::{Digits, ParametrisedField};

/// Names of columns, with what they measure.
type NamedQuantities<'n> = &'n [(String, Quantity)];

/// What rows are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RowKind {
    /// Of orbits, or of equilibria.
    pub orbits: bool,
    /// Of a curve in the plane of two parameters, or of a branch along one.
    pub curve: bool,
    /// Of homoclinic orbits, each told by its equilibrium.
    pub homoclinic: bool,
}

/// What a branch of orbits ends at, that is no homoclinic orbit to a saddle.
const SADDLE_NODE: &str = "saddle-node on a cycle";

/// A point of a branch or of a curve, as rows and special points show it.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralRow {
    /// The number of the branch or curve.
    pub number: usize,
    /// The free parameters, one of a branch, two of a curve, and those that are told though they are held.
    pub parameters: Vec<Uncertain>,
    /// What the system tells of the state or the orbit.
    pub numbers: Vec<f64>,
    /// The state of an equilibrium, or of a point of the orbit.
    pub state: Vec<f64>,
    /// The period of an orbit, or of the oscillation at a Hopf point.
    pub period: Option<Uncertain>,
    /// The real parts of the leading eigenvalues, or ln |mu| of the leading multipliers.
    pub exponents: [Option<f64>; 2],
    /// The eigenvalues of an equilibrium, largest real part first.
    pub eigenvalues: Vec<Complex<f64>>,
    /// How many eigenvalues of an equilibrium have positive real parts.
    pub unstable: Option<usize>,
    /// Of interfaces in clusters what a split of each that can split grows by.
    pub within: Vec<f64>,
    /// The angle of the multipliers of a torus bifurcation, over pi.
    pub angle_over_pi: Option<f64>,
    /// How branches of equilibria cross at a branch point.
    pub crossing: Option<BranchCrossing>,
    /// At a branch point or Hopf point of equilibria, how many eigenvalues, or pairs, are on the imaginary axis together.
    pub multiplicity: Option<usize>,
    /// Where the period grows without bound, whether that is at a saddle-node on the cycle.
    pub saddle_node: bool,
    /// To which side a bifurcation goes.
    pub criticality: Option<Criticality>,
    /// The normal form's coefficient.
    pub coefficient: Option<f64>,
    /// It may be off by this, where that is known.
    pub coefficient_uncertainty: Option<f64>,
    /// Of equilibria at points of codimension two the coefficients of the normal form.
    pub normal_form: Vec<(String, Uncertain)>,
    /// Stability, of branches.
    pub verdict: Option<Verdict>,
    /// What is special here.
    pub label: Option<Label>,
    /// Of equal interfaces, whether both move alike there: a point where they do not stands for its mirror image too.
    pub symmetry: Option<Symmetry>,
    /// What else is to be said.
    pub note: Option<String>,
    /// Of a special orbit that was just found, what is needed to compute it once more.
    pub orbit: Option<SpecialOrbit>,
}

impl GeneralRow {
    /// The row of a point.
    ///
    /// # Errors
    /// As of [`Subject::told`].
    pub fn of(
        subject: &dyn Subject,
        family: &dyn ParametrisedField,
        (kind, names): (RowKind, &[(&'static str, Quantity)]),
        point: GeneralPoint,
    ) -> Result<Self> {
        let numbers = subject.told((family, point.at), point.solution.seen(None), Digits::Six)?;
        let time = subject.unit_of_time();
        // |q|^2 of the eigenvector at a Hopf point, where it is 1 in the units in which it is followed.
        let square = oscillation(family, &point).map_or(1.0, |parts| {
            parts.map(|part| subject.length(&part).powi(2)).iter().sum()
        });
        let eigenvalues: Vec<Complex<f64>> = match &point.solution {
            GeneralSolution::Equilibrium { eigenvalues, .. } => {
                eigenvalues.iter().map(|z| z / time).collect()
            }
            GeneralSolution::Orbit { .. } => Vec::new(),
        };
        let exponents: Vec<f64> = match &point.solution {
            GeneralSolution::Equilibrium { .. } => eigenvalues.iter().map(|z| z.re).collect(),
            GeneralSolution::Orbit {
                log_multipliers, ..
            } => log_multipliers.clone(),
        };
        let free = if kind.curve { 2 } else { 1 };
        let mut parameters = point.parameters[..free].to_vec();
        for (name, _) in &names[free..] {
            parameters.push(Uncertain::new(subject.value(name)?, 0.0));
        }
        // In the user's unit of time; lengths are in the units of the variables.
        let normal_form: Vec<(String, Uncertain)> = point
            .normal_form
            .iter()
            .map(|one| {
                let unit = time.powi(one.time);
                let Uncertain { value, uncertainty } = one.value;
                (
                    one.name.to_owned(),
                    Uncertain::new(value * unit, uncertainty * unit),
                )
            })
            .collect();
        let alone = match &normal_form[..] {
            [(_, alone)] => Some(*alone),
            _ => None,
        };
        let symmetry = subject.has_equal_parts();
        Ok(GeneralRow {
            symmetry: symmetry.then(|| {
                let own = || point.solution.symmetry();
                point.symmetry.unwrap_or_else(own)
            }),
            number: point.number,
            parameters,
            numbers,
            state: subject.state_outward(state_of(&point.solution)),
            period: point
                .period
                .map(|period| Uncertain::new(period.value * time, period.uncertainty * time)),
            exponents: [0, 1].map(|i| exponents.get(i).copied().filter(|x| x.is_finite())),
            eigenvalues,
            unstable: point.unstable(),
            within: point.within.iter().map(|one| one.ln_abs.value).collect(),
            angle_over_pi: point.angle_over_pi,
            crossing: point.crossing,
            multiplicity: point.multiplicity,
            saddle_node: point.saddle_node,
            criticality: point.criticality,
            coefficient: alone
                .map_or_else(|| point.coefficient.map(|x| x / square), |x| Some(x.value)),
            coefficient_uncertainty: alone.map_or_else(
                || point.coefficient_uncertainty.map(|x| x / square),
                |x| Some(x.uncertainty),
            ),
            normal_form,
            verdict: (!kind.curve).then(|| point.verdict()),
            label: point.label,
            note: point.note,
            orbit: point.orbit,
        })
    }

    /// The real part of the eigenvalue nearest to the axis on either side of it, added.
    pub fn saddle_quantity(&self) -> Option<f64> {
        let side = |sign: f64| {
            let own = self.eigenvalues.iter().map(|z| sign * z.re);
            own.filter(|re| *re > 0.0).reduce(f64::min)
        };
        Some(side(1.0)? - side(-1.0)?)
    }

    /// What its label means; where a cluster of more than two splits that is no pitchfork.
    pub fn meaning(&self) -> Option<&'static str> {
        match self.label? {
            Label::Bp if !self.within.is_empty() => Some("branch point"),
            Label::Bp => Some(self.crossing.map_or("branch point", BranchCrossing::name)),
            Label::Hom if self.saddle_node => Some(SADDLE_NODE),
            label => Some(label.meaning()),
        }
    }

    /// The columns of rows.
    pub fn columns(
        subject: &dyn Subject,
        kind: RowKind,
        names: &[(&'static str, Quantity)],
    ) -> Vec<Column<Self>> {
        type Row = GeneralRow;
        use Quantity::{Growth, Number, Time};
        let mut columns: Vec<Column<Row>> = Vec::new();
        for (i, &(name, quantity)) in names.iter().enumerate() {
            columns.push(if kind.curve {
                Column::uncertain(name, quantity, move |row: &Row| row.parameters[i].into())
            } else {
                Column::new(name, quantity, move |row: &Row| {
                    row.parameters[i].value.into()
                })
            });
        }
        let numbers = subject.numbers(kind).into_iter().enumerate();
        columns.extend(numbers.map(|(i, (name, quantity))| {
            Column::new(name, quantity, move |row: &Row| row.numbers[i].into())
        }));
        let period = Column::new("period", Time, |row: &Row| {
            row.period.map(|period| period.value).into()
        });
        if kind.homoclinic {
            columns.push(saddle_quantity());
        } else if kind.curve || kind.orbits {
            columns.push(period);
        }
        if kind.homoclinic {
        } else if kind.curve {
            columns.push(Column::new("angle_over_pi", Number, |row: &Row| {
                row.angle_over_pi.into()
            }));
            columns.push(criticality());
        } else {
            let exponent = if kind.orbits { Number } else { Growth };
            for i in 0..2 {
                let name = format!("ln_abs_multiplier_{}", i + 1);
                let entry = move |row: &Row| row.exponents[i].into();
                columns.push(Column::new(name, exponent, entry));
            }
            for (i, cluster) in subject.clusters().into_iter().enumerate() {
                let known = move |row: &Row| row.within.get(i).copied().filter(|x| x.is_finite());
                let entry = move |row: &Row| known(row).into();
                columns.push(Column::new(format!("within_{cluster}"), exponent, entry));
            }
            columns.push(Column::new("verdict", Number, |row: &Row| {
                row.verdict.map(Verdict::name).into()
            }));
        }
        columns.push(Column::new("label", Number, |row: &Row| {
            row.label.map(Label::name).into()
        }));
        let whole = if kind.curve { "curve" } else { "branch" };
        columns.push(Column::new(whole, Number, |row: &Row| row.number.into()));
        columns.extend(subject.has_equal_parts().then(Self::symmetry_column));
        if !kind.orbits && !kind.curve {
            columns.extend(Self::eigenvalue_columns(subject.dimension()));
        }
        columns
    }

    /// The columns of all eigenvalues of an equilibrium and of the number of unstable ones.
    fn eigenvalue_columns(dimension: usize) -> Vec<Column<Self>> {
        let of = |row: &Self, i: usize| {
            let known = row.eigenvalues.get(i).copied();
            known.filter(|z| z.re.is_finite() && z.im.is_finite())
        };
        let unstable = Column::new("unstable", Quantity::Number, |row: &Self| {
            let count = row.unstable;
            count.map_or(CellValue::Number(None), CellValue::Count)
        });
        let all = (0..dimension).flat_map(|i| Column::eigenvalue(i, Quantity::Growth, of));
        all.chain([unstable]).map(Column::not_in_table).collect()
    }

    fn symmetry_column() -> Column<Self> {
        Column::new("symmetry", Quantity::Number, |row: &Self| {
            row.symmetry.map(Symmetry::name).into()
        })
    }

    /// The columns of special points.
    pub fn special_columns(
        subject: &dyn Subject,
        names: &[(&'static str, Quantity)],
    ) -> Vec<Column<Self>> {
        type Row = GeneralRow;
        use Quantity::{Number, Time};
        let mut columns = vec![
            Column::new("label", Number, |row: &Row| {
                row.label.map(Label::name).into()
            }),
            Column::new("name", Number, |row: &Row| row.meaning().into()),
            Column::new("branch", Number, |row: &Row| row.number.into()),
        ];
        columns.extend(subject.has_equal_parts().then(Self::symmetry_column));
        for (i, &(name, quantity)) in names.iter().enumerate() {
            let entry = move |row: &Row| row.parameters[i].into();
            columns.push(Column::uncertain(name, quantity, entry));
        }
        columns.extend([
            Column::uncertain("period", Time, |row: &Row| row.period.into()),
            criticality(),
            Column::new("coefficient", Number, |row: &Row| row.coefficient.into()),
            Column::new("note", Number, |row: &Row| {
                // A row is a line, whatever the reason says.
                CellValue::Word(row.note.as_ref().map(|note| note.replace('\n', " ")))
            }),
            Column::new("coefficient_uncertainty", Number, |row: &Row| {
                row.coefficient_uncertainty.into()
            }),
            Column::new("multiplicity", Number, |row: &Row| {
                let count = row.multiplicity;
                count.map_or(CellValue::Number(None), CellValue::Count)
            })
            .not_in_table(),
            Column::new("normal_form", Number, |row: &Row| {
                CellValue::Named(row.normal_form.clone())
            })
            .not_in_table(),
        ]);
        let states = subject.states().into_iter().enumerate();
        columns.extend(states.map(|(i, (name, quantity))| {
            let known = move |row: &Row| row.state.get(i).copied().filter(|x| x.is_finite());
            Column::new(name, quantity, move |row: &Row| known(row).into()).not_in_table()
        }));
        columns
    }

    /// From the cells of a CSV in the user's units, by the columns that it has.
    pub fn read(
        cell: &dyn Fn(&str) -> String,
        units: &Units,
        names: &[(&'static str, Quantity)],
        (numbers, states): (NamedQuantities<'_>, NamedQuantities<'_>),
    ) -> Option<Self> {
        let number = |name: &str| cell(name).parse::<f64>().ok();
        let inward = |name: &str, quantity| number(name).map(|x| units.inward(quantity, x));
        let uncertain = |name: &str, quantity| {
            let value = inward(name, quantity)?;
            let off = number(&format!("{name}_uncertainty"));
            let off = off.map_or(f64::INFINITY, |off| off / units.factor(quantity));
            Some(Uncertain::new(value, off))
        };
        let parameters = names
            .iter()
            .map(|(name, quantity)| uncertain(name, *quantity));
        let sides = [
            Criticality::Supercritical,
            Criticality::Subcritical,
            Criticality::Undecided,
        ];
        let verdicts = [Verdict::Stable, Verdict::Unstable, Verdict::Undecided];
        let of_whole = [cell("branch"), cell("curve")];
        let numbers = numbers.iter();
        Some(GeneralRow {
            number: of_whole.iter().find_map(|word| word.parse().ok())?,
            parameters: parameters.collect::<Option<_>>()?,
            numbers: numbers
                .map(|(name, quantity)| inward(name, *quantity).unwrap_or(f64::NAN))
                .collect(),
            state: states
                .iter()
                .map(|(name, quantity)| inward(name, *quantity).unwrap_or(f64::NAN))
                .collect(),
            period: uncertain("period", Quantity::Time),
            // Not shown but in the line itself, which is kept as it stands.
            exponents: [None; 2],
            eigenvalues: Vec::new(),
            unstable: None,
            within: Vec::new(),
            angle_over_pi: number("angle_over_pi"),
            crossing: BranchCrossing::ALL
                .into_iter()
                .find(|crossing| crossing.name() == cell("name")),
            multiplicity: cell("multiplicity").parse().ok(),
            saddle_node: cell("name") == SADDLE_NODE,
            criticality: sides
                .into_iter()
                .find(|side| side.name() == cell("criticality")),
            coefficient: number("coefficient"),
            coefficient_uncertainty: number("coefficient_uncertainty"),
            normal_form: named(&cell("normal_form")).unwrap_or_default(),
            verdict: verdicts
                .into_iter()
                .find(|verdict| verdict.name() == cell("verdict")),
            label: Label::named(&cell("label")),
            symmetry: Symmetry::named(&cell("symmetry")),
            note: Some(cell("note")).filter(|note| !note.is_empty()),
            orbit: None,
        })
    }
}

/// Named numbers with their error budgets, as a cell of a CSV has them.
fn named(cell: &str) -> Option<Vec<(String, Uncertain)>> {
    let parts = cell.split("; ").map(|part| {
        let (name, number) = part.split_once(" = ")?;
        let (value, uncertainty) = number.split_once(" +- ")?;
        let number = Uncertain::new(value.parse().ok()?, uncertainty.parse().ok()?);
        Some((name.to_owned(), number))
    });
    parts.collect()
}

/// The real and imaginary parts of the eigenvector q, with <q, q> = 1, of the oscillation at a Hopf point.
fn oscillation(family: &dyn ParametrisedField, point: &GeneralPoint) -> Option<[Vector; 2]> {
    let GeneralSolution::Equilibrium { state, .. } = &point.solution else {
        return None;
    };
    let frequency = Complex::new(0.0, TAU / point.period?.value);
    let q = eigenvector(&family.field(point.at).jacobian(state), frequency)?;
    Some([q.map(|z| z.re), q.map(|z| z.im)])
}

/// The sum of the real parts of the leading eigenvalues at the equilibrium of a homoclinic orbit.
fn saddle_quantity() -> Column<GeneralRow> {
    Column::new("saddle_quantity", Quantity::Growth, |row: &GeneralRow| {
        row.saddle_quantity().into()
    })
}

fn criticality() -> Column<GeneralRow> {
    Column::new("criticality", Quantity::Number, |row: &GeneralRow| {
        row.criticality.map(Criticality::name).into()
    })
}
