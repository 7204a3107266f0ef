//! Meanings of the columns of equilibria, branches, curves and sweeps; other columns are declared with theirs. A column without a meaning is a
//! panic of the page, which a test makes.

/// The meaning of a column in the list of this heading, by its name with `_i` in place of a number.
///
/// # Panics
/// For a column that is in neither list: they have to name all of them.
pub fn meaning(heading: &str, name: &str) -> &'static str {
    let here = HERE
        .iter()
        .find(|(list, one, _)| *list == heading && *one == name);
    let here = here.map(|(.., meaning)| *meaning);
    let anywhere = || MEANINGS.iter().find(|(one, _)| *one == name);
    let found = here.or_else(|| anywhere().map(|(_, meaning)| *meaning));
    found.unwrap_or_else(|| {
        panic!("no meaning of the column {name} in crates/cli/src/reference/meanings.rs")
    })
}

/// Columns that have another meaning in one list than in the others.
const HERE: &[(&str, &str, &str)] = &[
    (
        "equilibria",
        "residual",
        "largest residual of the equations, relative: a check",
    ),
    (
        "equilibria of more than two interfaces",
        "residual",
        "largest residual of the equations, relative: a check",
    ),
    (
        "equilibria of more than two interfaces",
        "symmetry",
        "symmetric where all interfaces are in the same state, else asymmetric",
    ),
    ("branch orbits", "stress", "mean over the orbit"),
    (
        "branch orbits",
        "state_i",
        "ψ of interface i where the stress is largest",
    ),
    (
        "branch orbits",
        "slip_rate_i",
        "slip rate of interface i where the stress is largest",
    ),
    (
        "branch orbits",
        "ln_abs_multiplier_i",
        "logarithm of the absolute value of multiplier i, the larger one first",
    ),
    ("branch equilibria", "stress_min", "as stress"),
    ("branch equilibria", "stress_max", "as stress"),
    ("branch equilibria", "period", "empty: a column of orbits"),
    (
        "branch equilibria",
        "ln_abs_multiplier_i",
        "of equal interfaces along V_H or K empty: a column of orbits; else the real part of eigenvalue i",
    ),
    (
        "branch equilibria of more than two interfaces",
        "stress_min",
        "as stress",
    ),
    (
        "branch equilibria of more than two interfaces",
        "stress_max",
        "as stress",
    ),
    (
        "branch equilibria of more than two interfaces",
        "period",
        "empty: a column of orbits",
    ),
    (
        "branch equilibria of more than two interfaces",
        "ln_abs_multiplier_i",
        "empty: a column of orbits",
    ),
    (
        "locus",
        "period",
        "period of the orbit, or of the oscillation at a Hopf point",
    ),
    (
        "branch and locus: special points",
        "branch",
        "number of the branch or curve",
    ),
    (
        "branch and locus: special points",
        "label",
        "label of the point",
    ),
    (
        "sweep",
        "stress_min",
        "least stress of what the run settles on",
    ),
    (
        "sweep",
        "stress_max",
        "largest stress of what the run settles on",
    ),
];

const MEANINGS: &[(&str, &str)] = &[
    (
        "angle_over_pi",
        "argument of the critical multipliers over π: 2/3 at the resonance 1:3, 1 at 1:2",
    ),
    (
        "arrangements",
        "number of states of this kind: how many ways there are to choose which interfaces are where",
    ),
    ("branch", "number of the branch"),
    (
        "coefficient",
        "coefficient of the normal form, whose sign decides the criticality",
    ),
    (
        "coefficient_uncertainty",
        "bound on the error of the coefficient",
    ),
    ("count_i", "number of interfaces in cluster i"),
    ("criticality", "supercritical, subcritical or undecided"),
    ("curve", "number of the curve"),
    ("driving", "driving velocity V_H"),
    ("eigenvalue_i_im", "imaginary part of eigenvalue i"),
    ("eigenvalue_i_re", "real part of eigenvalue i"),
    (
        "eigenvalue_i_kind",
        "clusters: each cluster keeps together; within: interfaces of one cluster part",
    ),
    ("eigenvalue_i_multiplicity", "multiplicity of eigenvalue i"),
    (
        "eigenvalue_uncertainty_i",
        "bound on the error of eigenvalue i, as a distance in the complex plane",
    ),
    (
        "fast",
        "number of interfaces on the fast branch of the steady-state law",
    ),
    ("label", "label of a special point, empty elsewhere"),
    ("log_state_i", "ln ψ of interface i"),
    (
        "log_state_uncertainty_i",
        "bound on the error of ln ψ of interface i",
    ),
    ("lyapunov_max", "largest Lyapunov exponent across the flow"),
    (
        "middle",
        "number of interfaces on the middle branch of the steady-state law",
    ),
    ("name", "the label in words"),
    (
        "normal_form",
        "coefficients of the normal form of a point of codimension two, with their bounds",
    ),
    ("note", "what is to be known of the row, in words"),
    (
        "period",
        "period of the orbit; at a Hopf point that of the orbits born there",
    ),
    (
        "period_of_orbit",
        "number of returns after which the orbit closes",
    ),
    ("regime", "steady, periodic, torus, chaotic or undecided"),
    ("returns", "number of returns that were computed"),
    (
        "saddle_quantity",
        "sum of the real parts of the two eigenvalues next to the imaginary axis, one on either side of it",
    ),
    ("slip_rate_i", "slip rate of interface or cluster i"),
    (
        "slip_rate_uncertainty_i",
        "bound on the error of slip rate i",
    ),
    (
        "slow",
        "number of interfaces on the slow branch of the steady-state law",
    ),
    ("start_state_i", "ψ of interface i at the start"),
    ("start_stress", "stress at the start"),
    ("state_i", "ψ of interface or cluster i"),
    (
        "state_uncertainty_i",
        "bound on the error of ψ of interface i",
    ),
    ("stiffness", "stiffness K"),
    ("stress", "shear stress τ"),
    ("stress_max", "largest stress of the orbit"),
    ("stress_min", "least stress of the orbit"),
    (
        "symmetry",
        "symmetric where both interfaces move alike, else asymmetric",
    ),
    (
        "unstable",
        "number of eigenvalues with a positive real part",
    ),
    ("verdict", "stable, unstable or undecided"),
];
