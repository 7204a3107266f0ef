//! Rosenbrock methods as data: Rodas5P, Rodas4 and the pair of ode23s.
//!
//! One step from y0 with J = Df(y0) solves, for i = 1..s, linear systems with one and the same matrix,
//!
//!   (I/(h gamma) - J) u_i = f(y0 + sum_j a_ij u_j) + (1/h) sum_j c_ij u_j,      y1 = y0 + sum_i m_i u_i,
//!
//! the form of Hairer & Wanner II, section IV.7, which needs no product with J. With Gamma^-1 = I/gamma - C the usual
//! coefficients are alpha = A Gamma and b = m Gamma. The error estimate is sum_i e_i u_i, and
//!
//!   y(t0 + theta h) = (1-theta) y0 + theta {y1 + (1-theta) [k_1 + theta (k_2 + theta k_3)]},      k_l = sum_i d_li u_i,
//!
//! the continuous solution. The fields are autonomous, so the coefficients that go with df/dt are not here.
//!
//! The coefficients are typed as printed, sixteen digits; the order conditions then hold to 2e-14.

/// The most stages of any method here; shorter ones are padded with zeros.
pub const MAX_STAGES: usize = 8;

/// The coefficients of one Rosenbrock method with its embedded estimate and continuous solution.
///
/// ```
/// use twinslip::integrate::RosenbrockMethod;
/// let rodas4 = RosenbrockMethod::Rodas4.tableau();
/// assert_eq!((rodas4.stages, rodas4.order), (6, 4));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tableau {
    /// The name by which the command line knows the method.
    pub name: &'static str,
    /// s.
    pub stages: usize,
    /// Order of y1.
    pub order: u32,
    /// Order of the embedded solution y1 - sum_i e_i u_i.
    pub embedded_order: u32,
    /// Order of the continuous solution.
    pub dense_order: u32,
    /// gamma, the diagonal.
    pub gamma: f64,
    /// a_ij, strictly lower triangular.
    pub a: [[f64; MAX_STAGES]; MAX_STAGES],
    /// c_ij, strictly lower triangular.
    pub c: [[f64; MAX_STAGES]; MAX_STAGES],
    /// m_i, the weights of y1.
    pub m: [f64; MAX_STAGES],
    /// e_i, the weights of the error estimate.
    pub e: [f64; MAX_STAGES],
    /// d_li, the weights of the continuous solution.
    pub d: [[f64; MAX_STAGES]; 3],
    /// Whether the last stage evaluates f at y1, which the next step then needs not do again.
    pub ends_at_last_stage: bool,
}

/// Rodas5P, order 5(4), 8 stages, stiffly accurate, L-stable; continuous solution of order 4.
///
/// Steinebach, G. (2023). Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks within the Julia
/// Differential Equations package. BIT Numerical Mathematics 63, 27.
pub const RODAS5P: Tableau = Tableau {
    name: "rodas5p",
    stages: 8,
    order: 5,
    embedded_order: 4,
    dense_order: 4,
    gamma: 0.21193756319429014,
    a: rows([
        &[],
        &[3.0],
        &[2.849394379747939, 0.45842242204463923],
        &[-6.954028509809101, 2.489845061869568, -10.358996098473584],
        &[
            2.8029986275628964,
            0.5072464736228206,
            -0.3988312541770524,
            -0.04721187230404641,
        ],
        &RODAS5P_BEFORE_END,
        &extended(RODAS5P_BEFORE_END, 5, 1),
        &extended(RODAS5P_BEFORE_END, 5, 2),
    ]),
    c: rows([
        &[],
        &[-14.155112264123755],
        &[-17.97296035885952, -2.859693295451294],
        &[147.12150275711716, -1.41221402718213, 71.68940251302358],
        &[
            165.43517024871676,
            -0.4592823456491126,
            42.90938336958603,
            -5.961986721573306,
        ],
        &[
            24.854864614690072,
            -3.0009227002832186,
            47.4931110020768,
            5.5814197821558125,
            -0.6610691825249471,
        ],
        &[
            30.91273214028599,
            -3.1208243349937974,
            77.79954646070892,
            34.28646028294783,
            -19.097331116725623,
            -28.087943162872662,
        ],
        &[
            37.80277123390563,
            -3.2571969029072276,
            112.26918849496327,
            66.9347231244047,
            -40.06618937091002,
            -54.66780262877968,
            -9.48861652309627,
        ],
    ]),
    m: extended(RODAS5P_BEFORE_END, 5, 3),
    e: unit(7),
    d: rows([
        &[
            25.948786856663858,
            -2.5579724845846235,
            10.433815404888879,
            -2.3679251022685204,
            0.524948541321073,
            1.1241088310450404,
            0.4272876194431874,
            -0.17202221070155493,
        ],
        &[
            -9.91568850695171,
            -0.9689944594115154,
            3.0438037242978453,
            -24.495224566215796,
            20.176138334709044,
            15.98066361424651,
            -6.789040303419874,
            -6.710236069923372,
        ],
        &[
            11.419903575922262,
            2.8879645146136994,
            72.92137995996029,
            80.12511834622643,
            -52.072871366152654,
            -59.78993625266729,
            -0.15582684282751913,
            4.883087185713722,
        ],
    ]),
    ends_at_last_stage: false,
};

/// The weights that the last three stages and y1 of Rodas5P share: each adds the newest u to the one before.
const RODAS5P_BEFORE_END: [f64; MAX_STAGES] = [
    -7.502846399306121,
    2.561846144803919,
    -11.627539656261098,
    -0.18268767659942256,
    0.030198172008377946,
    0.0,
    0.0,
    0.0,
];

/// RODAS, order 4(3), 6 stages, stiffly accurate, L-stable; continuous solution of order 3.
///
/// Hairer, E. and Wanner, G. (1996). Solving Ordinary Differential Equations II, 2nd ed., section VI.4,
/// with gamma = 1/4; the digits are those of their code RODAS (METH = 1).
pub const RODAS4: Tableau = Tableau {
    name: "rodas4",
    stages: 6,
    order: 4,
    embedded_order: 3,
    dense_order: 3,
    gamma: 0.25,
    a: rows([
        &[],
        &[1.544],
        &[0.9466785280815826, 0.2557011698983284],
        &[3.314825187068521, 2.896124015972201, 0.9986419139977817],
        &RODAS4_BEFORE_END,
        &extended(RODAS4_BEFORE_END, 4, 1),
    ]),
    c: rows([
        &[],
        &[-5.6688],
        &[-2.430093356833875, -0.2063599157091915],
        &[-0.1073529058151375, -9.594562251023355, -20.47028614809616],
        &[
            7.496443313967647,
            -10.24680431464352,
            -33.99990352819905,
            11.7089089320616,
        ],
        &[
            8.083246795921522,
            -7.981132988064893,
            -31.52159432874371,
            16.31930543123136,
            -6.058818238834054,
        ],
    ]),
    m: extended(RODAS4_BEFORE_END, 4, 2),
    e: unit(5),
    d: rows([
        &[
            10.12623508344586,
            -7.487995877610167,
            -34.80091861555747,
            -7.992771707568823,
            1.025137723295662,
        ],
        &[
            -0.6762803392801253,
            6.087714651680015,
            16.43084320892478,
            24.76722511418386,
            -6.594389125716872,
        ],
    ]),
    ends_at_last_stage: false,
};

const RODAS4_BEFORE_END: [f64; MAX_STAGES] = [
    1.221224509226641,
    6.019134481288629,
    12.53708332932087,
    -0.687886036105895,
    0.0,
    0.0,
    0.0,
    0.0,
];

/// The pair of ode23s, order 2(3), 3 stages, L-stable; its natural continuous solution of order 2.
///
/// Shampine, L. F. and Reichelt, M. W. (1997). The MATLAB ODE suite. SIAM Journal on Scientific Computing 18, 1-22, section
/// 3.1: d = 1/(2 + sqrt 2), e32 = 6 + sqrt 2. Theirs are slopes, k_1 = u_1/(h d), k_2 = (u_1 + u_2)/(h d) and
/// k_3 = (u_3 + e32 u_2 + 2 u_1)/(h d).
pub const ROS23: Tableau = Tableau {
    name: "rosenbrock23",
    stages: 3,
    order: 2,
    embedded_order: 3,
    dense_order: 2,
    gamma: ROS23_D,
    a: rows([&[], &[0.5 / ROS23_D], &[1.0 / ROS23_D, 1.0 / ROS23_D]]),
    c: rows([
        &[],
        &[-1.0 / ROS23_D],
        &[-2.0 / ROS23_D, -ROS23_E32 / ROS23_D],
    ]),
    m: row(&[1.0 / ROS23_D, 1.0 / ROS23_D]),
    // h/6 (k_1 - 2 k_2 + k_3) is what the third-order solution adds
    e: row(&[
        -1.0 / (6.0 * ROS23_D),
        -(ROS23_E32 - 2.0) / (6.0 * ROS23_D),
        -1.0 / (6.0 * ROS23_D),
    ]),
    d: rows([&[0.0, -1.0 / (ROS23_D * (1.0 - 2.0 * ROS23_D))]]),
    ends_at_last_stage: true,
};

const ROS23_D: f64 = 1.0 / (2.0 + std::f64::consts::SQRT_2);
const ROS23_E32: f64 = 6.0 + std::f64::consts::SQRT_2;

const fn row(values: &[f64]) -> [f64; MAX_STAGES] {
    let mut padded = [0.0; MAX_STAGES];
    let mut i = 0;
    while i < values.len() {
        padded[i] = values[i];
        i += 1;
    }
    padded
}

const fn rows<const GIVEN: usize, const ALL: usize>(
    given: [&[f64]; GIVEN],
) -> [[f64; MAX_STAGES]; ALL] {
    let mut padded = [[0.0; MAX_STAGES]; ALL];
    let mut i = 0;
    while i < GIVEN {
        padded[i] = row(given[i]);
        i += 1;
    }
    padded
}

/// The row with ones at `count` places from `first` on.
const fn extended(mut row: [f64; MAX_STAGES], first: usize, count: usize) -> [f64; MAX_STAGES] {
    let mut i = 0;
    while i < count {
        row[first + i] = 1.0;
        i += 1;
    }
    row
}

const fn unit(i: usize) -> [f64; MAX_STAGES] {
    extended([0.0; MAX_STAGES], i, 1)
}
