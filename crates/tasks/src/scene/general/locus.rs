//! Curves of bifurcations in the plane of any two parameters, from options.

use super::branch::{GeneralFound, found};
use super::following::{self, Free, general, numbers};
use super::{GeneralRow, RowKind, SpecialRow, Subject, Watched};
use crate::scene::continuation::LocusOptions;
use crate::scene::following::Following;
use crate::scene::locus::CurveChoice;
use serde_json::{Value, json};
use std::ops::ControlFlow;
use twinslip::bifurcation::equilibria::generic_curve::EquilibriumBifurcation;
use twinslip::bifurcation::general::{
    Classified, GeneralBifurcation, GeneralCurve, GeneralEvent, GeneralPoint, GeneralSystem,
};
use twinslip::error::{Error, Result};
use twinslip::integrate::Choice;
use twinslip::orbit::{ParametrisedField, TestFunction};

/// A curve that is asked for, checked.
pub struct GeneralLocusPlan<'s> {
    /// Of what.
    pub choice: CurveChoice,
    /// The same.
    pub kind: RowKind,
    /// What bifurcates.
    bifurcation: GeneralBifurcation,
    /// What is followed.
    pub subject: &'s dyn Subject,
    /// What varies.
    pub free: [Free; 2],
    /// The formulas whose zeros are special points.
    pub watched: Watched,
    criticality: bool,
    /// Where it begins.
    begin: Option<GeneralPoint>,
    /// How.
    pub following: Following,
    /// The same for the output.
    pub numerics: Value,
}

/// The two names of `in`.
///
/// # Errors
/// [`Error::Input`] unless there are two.
pub fn plane(text: &str) -> Result<[&str; 2]> {
    let names: Vec<&str> = text.split(',').map(str::trim).collect();
    match names[..] {
        [first, second] if first != second => Ok([first, second]),
        _ => Err(Error::Input(format!(
            "`in` {text:?} must be two different parameters, NAME1,NAME2"
        ))),
    }
}

/// What options of the form NAME=... say of each of the two names.
pub(in crate::scene) fn by_name<'o>(
    option: &str,
    all: &'o [String],
    names: [&str; 2],
) -> Result<[Option<&'o str>; 2]> {
    let mut of = [None; 2];
    for text in all.iter().flat_map(|text| text.split(';')) {
        let pair = text.split_once('=');
        let (name, rest) =
            pair.ok_or_else(|| Error::Input(format!("`{option}` {text:?} must begin with NAME=")))?;
        let Some(i) = names.iter().position(|known| *known == name.trim()) else {
            return Err(Error::unknown(option, name.trim(), &names));
        };
        of[i] = Some(rest);
    }
    Ok(of)
}

/// Both ends of a range, the smaller one first.
pub(in crate::scene) fn ends(name: &str, text: &str) -> Result<(f64, f64)> {
    match numbers("range", &text.replace(':', ","))?[..] {
        [a, b] => Ok((a.min(b), a.max(b))),
        _ => Err(Error::Input(format!(
            "`range` {name}={text} must be two numbers, A,B"
        ))),
    }
}

impl<'s> GeneralLocusPlan<'s> {
    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Input`], in the user's own names.
    pub fn new(
        options: &LocusOptions,
        begin: Option<SpecialRow>,
        subject: &'s dyn Subject,
    ) -> Result<Self> {
        let choice = CurveChoice::named(options.of.as_deref())?;
        choice.holds(options.hold.as_deref())?;
        let bifurcation = choice.bifurcation().unwrap_or(GeneralBifurcation::Held);
        let of_symmetry = [
            GeneralBifurcation::Equilibrium(EquilibriumBifurcation::Pitchfork),
            GeneralBifurcation::Orbit(TestFunction::Transverse),
        ];
        if of_symmetry.contains(&bifurcation) && !subject.has_equal_parts() {
            return Err(Error::Input(format!(
                "a curve of {} needs a symmetry, and this system is not known to have one; follow saddle-node or orbit-saddle-node",
                choice.name
            )));
        }
        if let Some(begin) = &begin {
            begin.checked(choice, bifurcation)?;
        }
        let slab = subject
            .parameters()
            .iter()
            .any(|(name, _)| *name == "driving");
        let default = slab.then_some("driving,stiffness");
        let text = options.plane.as_deref().or(default).ok_or_else(|| {
            Error::Input("say which two parameters vary: `in` NAME1,NAME2".into())
        })?;
        let names = plane(text)?;
        let known = subject.parameters();
        let known: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
        if let Some(name) = names.iter().find(|name| !known.contains(name)) {
            return Err(Error::unknown("in", name, &known));
        }
        let mut ranges = by_name("range", &options.range, names)?;
        let mut at = by_name("at", &options.at, names)?;
        // The old flags are shorthands; their ranges have a colon.
        let shorthands = [
            ("driving", &options.driving_range, &options.at_driving),
            ("stiffness", &options.stiffness_range, &options.at_stiffness),
        ];
        for (name, range, values) in shorthands {
            let place = names.iter().position(|known| *known == name);
            match (place, range.is_some() || values.is_some()) {
                (Some(i), _) => {
                    ranges[i] = ranges[i].or(range.as_deref());
                    at[i] = at[i].or(values.as_deref());
                }
                (None, true) => {
                    return Err(Error::Input(format!(
                        "`{name}_range` and `at_{name}` are of {name}, which does not vary in the plane of {text}"
                    )));
                }
                (None, false) => {}
            }
        }
        let free = |i: usize| {
            let known = subject
                .parameters()
                .iter()
                .any(|(name, _)| *name == names[i]);
            let range = match ranges[i] {
                // A name that is none is told of first.
                _ if !known => (0.0, 1.0),
                None if subject.default_range(names[i]).is_some() => {
                    subject.default_range(names[i]).unwrap_or_default()
                }
                None => {
                    return Err(Error::Input(format!(
                        "`range` {}=A,B is missing, and has no default",
                        names[i]
                    )));
                }
                Some(text) => ends(names[i], text)?,
            };
            let at = at[i].map_or(Ok(Vec::new()), |text| numbers("at", text))?;
            Free::new(subject, ("in", names[i]), range, &at)
        };
        let free = [free(0)?, free(1)?];
        let told_begin = begin.as_ref().map(SpecialRow::told);
        let point = |row: SpecialRow| row.point(subject, free.each_ref());
        let begin = begin.map(point).transpose()?;
        let orbits = choice.of_orbits();
        let homoclinic = bifurcation == GeneralBifurcation::Homoclinic;
        match options.search.start.is_some() && orbits {
            true => following::starts_at(&options.model, &names)?,
            false => following::varies(&options.model, &names)?,
        }
        following::both_symmetries(&options.symmetry)?;
        let following = Following::new(&options.continuation, orbits)?;
        let refused = [
            ("criticality", options.criticality),
            ("crosscheck", following.second.is_some()),
        ];
        if let Some((name, _)) = refused.iter().find(|(_, given)| homoclinic && *given) {
            return Err(Error::Input(format!(
                "`{name}` is of bifurcations of equilibria and of periodic orbits; homoclinic orbits have none"
            )));
        }
        let outward = |free: &Free, x: f64| subject.units().outward(free.quantity, x);
        let list = |free: &Free, all: &[f64]| -> Vec<f64> {
            all.iter().map(|&x| outward(free, x)).collect()
        };
        let kind = RowKind {
            orbits: orbits && !homoclinic,
            curve: true,
            homoclinic,
        };
        if homoclinic && !options.watch.is_empty() {
            return Err(Error::Input(format!(
                "`watch` {:?} has no meaning along a curve of homoclinic orbits, which have no period and no extremes that are known",
                options.watch[0]
            )));
        }
        let watched = Watched::new((options.hold.as_deref(), &options.watch), subject, kind)?;
        let mut numerics = json!({
            "of": choice.name,
            "in": names,
            "ranges": free.each_ref().map(|free| list(free, &[free.range.0, free.range.1])),
            "at": free.each_ref().map(|free| list(free, &free.at)),
            "begin": told_begin,
            "criticality": options.criticality,
            "step_limit": following.step,
            "tolerance": following.tolerance,
            "crosscheck": following.second.map(|second| second.name()),
        });
        watched.told_in(&mut numerics);
        Ok(GeneralLocusPlan {
            choice,
            kind,
            watched,
            bifurcation,
            subject,
            free,
            criticality: options.criticality,
            begin,
            following,
            numerics,
        })
    }

    /// The plan, one subject a line.
    pub fn explain(&self) -> String {
        let ranges = self.free.each_ref().map(|free| {
            let out = |x| self.subject.units().outward(free.quantity, x);
            format!(
                "  {:<18}from {:e} to {:e}\n",
                free.name,
                out(free.range.0),
                out(free.range.1)
            )
        });
        let method = match self.kind.orbits {
            _ if self.kind.homoclinic => {
                "taylor, tangents on, multiple shooting between the tangent spaces of the saddle's manifolds, both parameters unknown"
            }
            true => "taylor, tangents on, multiple shooting, both parameters unknown",
            false => {
                "the equilibrium with the condition of the bifurcation, both parameters unknown; nothing is integrated"
            }
        };
        format!(
            "plan of this command\n  curve             {}\n{}  method            {method}\n  watched           {}\n  points            at most {}",
            match self.bifurcation {
                GeneralBifurcation::Held => format!("orbits with {}", self.watched.texts[0]),
                _ => self.choice.name.to_owned(),
            },
            ranges.concat(),
            self.watched.explain(),
            self.following.max_points
        )
    }

    /// A special point of orbits once more, by another method: what both parameters and the period differ by.
    ///
    /// # Errors
    /// Those of the second method.
    pub fn crosscheck(&self, one: &GeneralRow, method: Choice) -> Result<Option<Vec<f64>>> {
        let names = [self.free[0].name, self.free[1].name];
        let coordinates = self.free.each_ref().map(|free| free.coordinate);
        let family = self.subject.family(&names, coordinates)?;
        let alike = self.subject.alike(&names);
        let functions = self.watched.of(self.subject, &*family);
        let family = functions.with(&*family);
        let alike = alike.as_deref().map(|alike| functions.with(alike));
        let system = GeneralSystem {
            family: &family,
            alike: alike.as_ref().map(|alike| alike as _),
            difference: None,
            names,
            interchangeable: &[],
            equilibria: &|_| Ok(Vec::new()),
            bounds: &[],
        };
        let unit = self.subject.unit_of_time();
        following::crosscheck(&system, (2, unit), one, method)
    }

    /// What is said where no curve is found.
    fn nothing(&self) -> Error {
        Error::NoOrbit {
            what: format!(
                "no {} found in these ranges",
                match self.bifurcation {
                    GeneralBifurcation::Held => format!("orbit with {} is", self.watched.texts[0]),
                    _ => format!("{} bifurcation is", self.choice.name),
                }
            ),
            period: None,
            hint: "give other ranges, or a `start` near an equilibrium or an orbit, or a `box` with all equilibria",
        }
    }

    /// Follows all of them, but those whose numbers are known.
    ///
    /// # Errors
    /// Those of the curves, and of what rows tell.
    pub fn follow(
        &self,
        known: &[usize],
        seen: &mut dyn FnMut(GeneralFound) -> ControlFlow<()>,
    ) -> Result<()> {
        let names = [self.free[0].name, self.free[1].name];
        let coordinates = self.free.each_ref().map(|free| free.coordinate);
        let family = self.subject.family(&names, coordinates)?;
        let alike = self.subject.alike(&names);
        let functions = self.watched.of(self.subject, &*family);
        // The functions are of states.
        let difference = match self.watched.texts.is_empty() {
            true => self.subject.difference(&names),
            false => None,
        };
        let family = functions.with(&*family);
        let alike = alike.as_deref().map(|alike| functions.with(alike));
        let equilibria = |at: [f64; 2]| {
            let values = family.parameters(at);
            let value = |i: usize| self.free[i].asked(at[i]).unwrap_or(values[i]);
            self.subject
                .equilibria(&[(names[0], value(0)), (names[1], value(1))])
        };
        let (mut orbit, mut own_place) = (None, None);
        if self.begin.is_none() && (self.kind.orbits || self.kind.homoclinic) {
            let own = [self.subject.value(names[0]), self.subject.value(names[1])];
            // Without values of their own there is no orbit either.
            if let [Ok(first), Ok(second)] = own {
                let values = [(names[0], first), (names[1], second)];
                own_place =
                    Some([0, 1].map(|i| self.free[i].coordinate.inward([first, second][i])));
                orbit = self.subject.orbit(&values)?;
                // Where nothing rests there is no Hopf point to begin at.
                if orbit.is_none() && !self.subject.may_rest() {
                    orbit = self.subject.orbits(&values).into_iter().next();
                }
                if let Some(orbit) = &mut orbit {
                    orbit.at = [0, 1].map(|i| self.free[i].coordinate.inward([first, second][i]));
                }
            }
        }
        let orbits_at = |at: [f64; 2]| {
            let values = family.parameters(at);
            let value = |i: usize| self.free[i].asked(at[i]).unwrap_or(values[i]);
            self.subject
                .orbits(&[(names[0], value(0)), (names[1], value(1))])
        };
        let interchangeable = self.subject.interchangeable();
        let bounds = self.subject.bounds();
        let curve = GeneralCurve {
            system: GeneralSystem {
                family: &family,
                alike: alike.as_ref().map(|alike| alike as _),
                difference: difference.as_deref(),
                names,
                interchangeable: &interchangeable,
                equilibria: &equilibria,
                bounds: &bounds,
            },
            kind: self.bifurcation,
            ranges: self.free.each_ref().map(Free::ends),
            beyond: self.free.each_ref().map(Free::beyond),
            at: self.free.each_ref().map(Free::landings),
            watch: self.watched.texts.clone(),
            orbit,
            own: own_place,
            found: self.kind.homoclinic.then_some(&orbits_at),
            begin: self.begin.clone(),
            seeds: None,
            symmetry: None,
            criticality: match self.criticality {
                true => Classified::Every,
                false => Classified::Special,
            },
            following: general(&self.following, known),
        };
        let (mut failed, mut met) = (None, 0);
        curve.follow(&mut |event: GeneralEvent| {
            met += 1;
            let free = self.free.each_ref();
            let how = (self.kind, self.following.tolerance);
            match found(self.subject, &family, how, &free, event) {
                Ok(found) => seen(found),
                Err(error) => {
                    failed = Some(error);
                    ControlFlow::Break(())
                }
            }
        })?;
        match failed {
            Some(error) => Err(error),
            None if met == 0 && known.is_empty() => Err(self.nothing()),
            None => Ok(()),
        }
    }
}
