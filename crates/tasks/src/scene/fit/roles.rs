//! What columns measure, by their names.

use super::heading::Heading;

/// What a column of a record may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// When a sample was taken.
    Time,
    /// How far the load point has moved.
    Displacement,
    /// How fast it moves.
    Velocity,
    /// The friction coefficient, or the shear stress.
    Friction,
    /// The normal stress.
    NormalStress,
    /// The uncertainty of the friction coefficient.
    Uncertainty,
}

/// Names in English, German, French, Italian, Spanish and Japanese as [`super::heading::plain`] makes them, the surest first.
const TIMES: &[&str] = &[
    "time",
    "t",
    "elapsed",
    "times",
    "elapsedtime",
    "runtime",
    "zeit",
    "temps",
    "tempo",
    "tiempo",
    "jikan",
];
const DISPLACEMENTS: &[&str] = &[
    "loadpointdisplacement",
    "loadpoint",
    "lpdisp",
    "lpdispl",
    "lpdisplacement",
    "lp",
    "displacement",
    "displ",
    "disp",
    "sheardisplacement",
    "position",
    "shearslip",
    "x",
    "u",
    "slip",
    "verschiebung",
    "weg",
    "versatz",
    "deplacement",
    "spostamento",
    "desplazamiento",
    "heni",
];
const VELOCITIES: &[&str] = &[
    "loadpointvelocity",
    "vlp",
    "loadingrate",
    "rate",
    "velocity",
    "v",
    "sliprate",
    "slipvelocity",
    "speed",
    "geschwindigkeit",
    "vitesse",
    "velocita",
    "velocidad",
    "sokudo",
];
const FRICTIONS: &[&str] = &[
    "friction",
    "mu",
    "frictioncoefficient",
    "coefficientoffriction",
    "coefficient",
    "μ",
    "cof",
    "fric",
    "reibung",
    "reibungskoeffizient",
    "reibungsbeiwert",
    "frottement",
    "coefficientdefrottement",
    "attrito",
    "coefficientediattrito",
    "rozamiento",
    "masatsu",
    "shearnormal",
    "shearstress",
    "tau",
    "τ",
    "schubspannung",
    "scherspannung",
    "cisaillement",
    "sforzoditaglio",
    "sendan",
];
const NORMAL_STRESSES: &[&str] = &[
    "effectivenormalstress",
    "effnormalstress",
    "normalstress",
    "norstress",
    "normal",
    "sigman",
    "sigma",
    "σn",
    "sn",
    "normalspannung",
    "contraintenormale",
    "sforzonormale",
];
const UNCERTAINTIES: &[&str] = &[
    "uncertainty",
    "frictionuncertainty",
    "error",
    "frictionerror",
    "standarderror",
    "err",
    "muerror",
    "std",
    "sd",
    "standarddeviation",
];

impl Role {
    /// Those of a record, in the order in which columns are looked for: `shear/normal` has names of two.
    pub const OF_RECORD: [Role; 5] = [
        Role::Time,
        Role::Friction,
        Role::Velocity,
        Role::Displacement,
        Role::NormalStress,
    ];

    /// What messages call it.
    pub fn name(self) -> &'static str {
        match self {
            Role::Time => "time",
            Role::Displacement => "displacement",
            Role::Velocity => "velocity",
            Role::Friction => "friction",
            Role::NormalStress => "normal stress",
            Role::Uncertainty => "uncertainty",
        }
    }

    /// The option that says which column it is.
    pub fn option(self) -> &'static str {
        match self {
            Role::NormalStress => "normal_stress_column",
            role => role.name(),
        }
    }

    fn names(self) -> &'static [&'static str] {
        match self {
            Role::Time => TIMES,
            Role::Displacement => DISPLACEMENTS,
            Role::Velocity => VELOCITIES,
            Role::Friction => FRICTIONS,
            Role::NormalStress => NORMAL_STRESSES,
            Role::Uncertainty => UNCERTAINTIES,
        }
    }

    /// A name that has one of these in it is not meant by a part of it: displacement across the fault, stress that is a strain.
    fn others(self) -> &'static [&'static str] {
        match self {
            Role::Time => &["step"],
            Role::Displacement => &[
                "normal",
                "vertical",
                "horizontal",
                "dilat",
                "compaction",
                "velocity",
                "rate",
            ],
            Role::Velocity => &["normal", "vertical", "horizontal"],
            Role::Friction => &["error", "std", "uncert"],
            Role::NormalStress => &["displ", "disp", "strain", "velocity"],
            Role::Uncertainty => &["velocity", "rate"],
        }
    }
}

/// Which columns may hold something.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Found {
    None,
    One(usize),
    /// Names say as much of each of these.
    Several(Vec<usize>),
}

/// The columns that have the surest name of those that there are, or that begin with it, or else that have one in their name, but for those
/// that are `taken`.
pub(super) fn columns_of(role: Role, headings: &[Heading], taken: &[usize]) -> Found {
    let plain: Vec<[String; 2]> = headings.iter().map(Heading::plain_names).collect();
    let those = |is: &dyn Fn(&String) -> bool| -> Vec<usize> {
        let free = (0..plain.len()).filter(|at| !taken.contains(at));
        free.filter(|&at| plain[at].iter().any(is)).collect()
    };
    let there = |found: &Vec<usize>| !found.is_empty();
    let names = || role.names().iter();
    let long = || names().filter(|name| name.len() > 2);
    let is_other = |own: &String| role.others().iter().any(|other| own.contains(other));
    let same = names().map(|name| those(&|own| own == name)).find(there);
    let begins = || {
        let mut each = long().map(|name| those(&|own| own.starts_with(name) && !is_other(own)));
        each.find(there)
    };
    let within = || those(&|own| long().any(|name| own.contains(name)) && !is_other(own));
    let found = same.or_else(begins).unwrap_or_else(within);
    match found[..] {
        [] => Found::None,
        [one] => Found::One(one),
        _ => Found::Several(found),
    }
}

/// Whether a name in parentheses is another name of a column.
pub(super) fn is_name(plain: &str) -> bool {
    Role::OF_RECORD
        .iter()
        .any(|role| role.names().contains(&plain))
}

/// Whether one of these names is one of those that columns are found by.
pub(super) fn is_known(plain: &[String; 2]) -> bool {
    let known = |own: &String| {
        let mut all = Role::OF_RECORD.iter().flat_map(|role| role.names());
        all.any(|name| own == name || name.len() > 2 && own.contains(name))
    };
    plain.iter().any(known)
}
