//! What the columns mean. A column without a meaning is a panic of the page, which a test makes.

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
    ("law", "stress", "steady-state stress τ_ss"),
    ("law", "state", "steady state ψ_ss"),
    (
        "integrate: events",
        "slip_i",
        "slip of interface i in the event",
    ),
    (
        "integrate, three interfaces and more: events",
        "slip",
        "slip of all participants together, each while it slips",
    ),
    (
        "integrate, three interfaces and more: participation",
        "slip",
        "slip of the interface in these events",
    ),
    (
        "integrate, eight interfaces and more",
        "slip_rate",
        "slip rate of all interfaces together",
    ),
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
    ("orbit", "stress", "stress at the first point of the orbit"),
    (
        "orbit",
        "log_state_i",
        "ln ψ of interface i at the first point of the orbit",
    ),
    (
        "orbit",
        "slip_rate_max",
        "largest slip rate of an interface on the orbit",
    ),
    ("orbit", "state_min", "least ψ on the orbit"),
    (
        "branch",
        "stress",
        "stress of an equilibrium, or the mean over an orbit",
    ),
    (
        "branch",
        "state_i",
        "ψ of interface i; of an orbit where its stress is largest",
    ),
    (
        "branch",
        "slip_rate_i",
        "slip rate of interface i; of an orbit where its stress is largest",
    ),
    (
        "branch",
        "ln_abs_multiplier_i",
        "of an orbit the logarithm of the absolute value of multiplier i, the larger one first; of an equilibrium the real part of eigenvalue i",
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
        "angle_over_pi_i",
        "argument of the multiplier over π: 0 of a positive real one, 1 of a negative one",
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
    (
        "critical_stiffness",
        "k_c: below it, steady sliding of a single interface at this rate is unstable",
    ),
    ("criticality", "supercritical, subcritical or undecided"),
    ("curve", "number of the curve"),
    (
        "displacement",
        "displacement of the load point since the record began",
    ),
    ("driving", "driving velocity V_H"),
    (
        "duration",
        "time from the beginning of the event to its end",
    ),
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
    ("events", "number of events in which the interface slipped"),
    (
        "fast",
        "number of interfaces on the fast branch of the steady-state law",
    ),
    ("first", "interface that begins the event"),
    ("fitted", "friction coefficient of the fitted model"),
    ("friction", "friction coefficient, τ/σ"),
    ("interface", "number of the interface"),
    (
        "kind_i",
        "kind of multiplier i: real, complex, or below floor where it is too small for its sign to be known",
    ),
    ("label", "label of a special point, empty elsewhere"),
    ("leader", "interface that slips farthest in the event"),
    (
        "liouville_defect",
        "difference between the logarithm of the product of the multipliers and the integral of the divergence: a check",
    ),
    (
        "ln_abs_multiplier_i",
        "logarithm of the absolute value of multiplier i",
    ),
    ("ln_abs_multiplier_i_uncertainty", "bound on its error"),
    ("log_state_i", "ln ψ of interface i"),
    ("log_state", "ln ψ of the interface"),
    (
        "log_state_uncertainty_i",
        "bound on the error of ln ψ of interface i",
    ),
    ("lyapunov_max", "largest Lyapunov exponent across the flow"),
    ("magnitude", "log10 of the slip of the event"),
    (
        "middle",
        "number of interfaces on the middle branch of the steady-state law",
    ),
    ("n", "number of the return"),
    ("name", "the label in words"),
    (
        "next_slip_rate_sum",
        "sum of the slip rates at the next return",
    ),
    ("note", "what is to be known of the row, in words"),
    ("observed", "measured friction coefficient"),
    ("onset", "time at which the event begins"),
    (
        "participants",
        "number of interfaces that slip in the event",
    ),
    (
        "participation",
        "participants over the number of interfaces",
    ),
    (
        "peak_slip_rate",
        "largest slip rate of all interfaces together",
    ),
    (
        "period",
        "period of the orbit; at a Hopf point that of the orbits born there",
    ),
    (
        "period_of_orbit",
        "number of returns after which the orbit closes",
    ),
    ("recurrence", "time since the onset of the event before"),
    ("regime", "steady, periodic, torus, chaotic or undecided"),
    ("residual", "observed minus fitted friction"),
    ("returns", "number of returns that were computed"),
    (
        "sliding",
        "number of interfaces that slide faster than V_H/N",
    ),
    ("slip", "slip of all interfaces together"),
    ("slip_i", "slip of interface i since the start of the run"),
    ("slip_mean", "mean slip of the participants"),
    ("slip_rate", "slip rate"),
    ("slip_rate_i", "slip rate of interface or cluster i"),
    ("slip_rate_max", "largest slip rate"),
    ("slip_rate_sum", "sum of the slip rates"),
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
    ("state", "ψ"),
    ("state_i", "ψ of interface or cluster i"),
    ("state_max", "largest ψ"),
    ("state_min", "least ψ"),
    (
        "state_uncertainty_i",
        "bound on the error of ψ of interface i",
    ),
    ("stiffness", "stiffness K"),
    ("stress", "shear stress τ"),
    ("stress_before", "stress at the onset"),
    (
        "stress_drop",
        "stress at the beginning of the event minus that at its end",
    ),
    ("stress_max", "largest stress of the orbit"),
    ("stress_min", "least stress of the orbit"),
    (
        "symmetry",
        "symmetric where both interfaces move alike, else asymmetric",
    ),
    ("time", "time"),
    (
        "trivial_defect",
        "distance of the multiplier along the orbit from 1: a check",
    ),
    (
        "unstable",
        "number of eigenvalues with a positive real part",
    ),
    ("verdict", "stable, unstable or undecided"),
];
