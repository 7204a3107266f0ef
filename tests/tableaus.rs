//! The coefficients of the Rosenbrock methods against the conditions that make them what they are called.
//!
//! Hairer & Wanner II, section IV.7: with alpha_ij, beta_ij = alpha_ij + gamma_ij (the diagonal gamma included) and b_i, a
//! method with the exact Jacobian has order p if sum_i b_i Phi_i(t) = 1/gamma(t) for every rooted tree t of up to p nodes,
//! where a node with one son contributes beta and a node with several alpha.

use nalgebra::DMatrix;
use twinslip::integrate::{RosenbrockMethod, Tableau};

/// A rooted tree: the trees that grow from its root.
#[derive(Clone, Debug, PartialEq)]
struct Tree(Vec<Tree>);

impl Tree {
    fn order(&self) -> u32 {
        1 + self.0.iter().map(Tree::order).sum::<u32>()
    }

    /// gamma(t): the order times the densities of the sons.
    fn density(&self) -> f64 {
        f64::from(self.order()) * self.0.iter().map(Tree::density).product::<f64>()
    }

    /// All trees with this many nodes.
    fn all(order: u32) -> Vec<Tree> {
        forests(order - 1, order - 1, usize::MAX)
            .into_iter()
            .map(Tree)
            .collect()
    }
}

/// All multisets of trees with `nodes` nodes together, none with more than `largest`, nor of that size past place `upto`.
fn forests(nodes: u32, largest: u32, upto: usize) -> Vec<Vec<Tree>> {
    if nodes == 0 {
        return vec![Vec::new()];
    }
    let mut found = Vec::new();
    for size in 1..=largest.min(nodes) {
        for (place, tree) in Tree::all(size).into_iter().enumerate() {
            if size == largest && place > upto {
                break;
            }
            for mut rest in forests(nodes - size, size, place) {
                rest.push(tree.clone());
                found.push(rest);
            }
        }
    }
    found
}

/// The method in its usual coefficients.
struct Classical {
    alpha: DMatrix<f64>,
    beta: DMatrix<f64>,
    gamma: DMatrix<f64>,
}

impl Classical {
    fn of(tableau: &Tableau) -> Self {
        let s = tableau.stages;
        let a = DMatrix::from_fn(s, s, |i, j| tableau.a[i][j]);
        let c = DMatrix::from_fn(s, s, |i, j| tableau.c[i][j]);
        let gamma = (DMatrix::identity(s, s) / tableau.gamma - c)
            .try_inverse()
            .unwrap();
        let alpha = a * &gamma;
        Classical {
            beta: &alpha + &gamma,
            alpha,
            gamma,
        }
    }

    /// Weights of the slopes k_i from weights of the u_i.
    fn weights(&self, of_u: &[f64]) -> Vec<f64> {
        let s = self.gamma.nrows();
        (0..s)
            .map(|j| (0..s).map(|i| of_u[i] * self.gamma[(i, j)]).sum())
            .collect()
    }

    /// Phi_i(t).
    fn elementary_weights(&self, tree: &Tree) -> Vec<f64> {
        let s = self.alpha.nrows();
        let matrix = if tree.0.len() == 1 {
            &self.beta
        } else {
            &self.alpha
        };
        let mut product = vec![1.0; s];
        for son in &tree.0 {
            let inner = self.elementary_weights(son);
            for i in 0..s {
                product[i] *= (0..s).map(|j| matrix[(i, j)] * inner[j]).sum::<f64>();
            }
        }
        product
    }

    /// The largest residual of the conditions up to this order.
    fn residual(&self, b: &[f64], order: u32) -> f64 {
        (1..=order)
            .flat_map(Tree::all)
            .map(|tree| (dot(b, &self.elementary_weights(&tree)) - 1.0 / tree.density()).abs())
            .fold(0.0, f64::max)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Residual left by coefficients of sixteen printed digits, some of them near 150 (measured: 2e-14).
const PRINTED: f64 = 5e-14;
/// A condition of the next order is missed by far more than that.
const MISSED: f64 = 1e-6;

#[test]
fn there_are_seventeen_trees_up_to_order_five() {
    let counts: Vec<usize> = (1..=5).map(|order| Tree::all(order).len()).collect();
    assert_eq!(counts, [1, 1, 2, 4, 9]);
}

#[test]
fn every_method_has_its_order_and_no_more() {
    for method in RosenbrockMethod::ALL {
        let tableau = method.tableau();
        let classical = Classical::of(tableau);
        let b = classical.weights(&tableau.m);
        let residual = classical.residual(&b, tableau.order);
        println!("{}: order {} to {residual:e}", tableau.name, tableau.order);
        assert!(residual < PRINTED, "{}: {residual:e}", tableau.name);
        assert!(classical.residual(&b, tableau.order + 1) > MISSED);
    }
}

#[test]
fn every_embedded_method_has_its_order_and_no_more() {
    for method in RosenbrockMethod::ALL {
        let tableau = method.tableau();
        let classical = Classical::of(tableau);
        let embedded: Vec<f64> = (0..tableau.stages)
            .map(|i| tableau.m[i] - tableau.e[i])
            .collect();
        let b = classical.weights(&embedded);
        let residual = classical.residual(&b, tableau.embedded_order);
        println!(
            "{}: order {} to {residual:e}",
            tableau.name, tableau.embedded_order
        );
        assert!(residual < PRINTED, "{}: {residual:e}", tableau.name);
        assert!(classical.residual(&b, tableau.embedded_order + 1) > MISSED);
    }
}

/// sum_i b_i(theta) Phi_i(t) = theta^order(t) / gamma(t), as polynomials: coefficient by coefficient.
#[test]
fn every_continuous_solution_has_its_order() {
    for method in RosenbrockMethod::ALL {
        let tableau = method.tableau();
        let classical = Classical::of(tableau);
        let powers = powers_of_theta(tableau).map(|of_u| classical.weights(&of_u));
        for tree in (1..=tableau.dense_order).flat_map(Tree::all) {
            let weights = classical.elementary_weights(&tree);
            for (power, b) in (1..).zip(&powers) {
                let expected = if power == tree.order() {
                    1.0 / tree.density()
                } else {
                    0.0
                };
                let residual = (dot(b, &weights) - expected).abs();
                assert!(
                    residual < 10.0 * PRINTED,
                    "{}: {tree:?}, theta^{power}: {residual:e}",
                    tableau.name
                );
            }
        }
    }
}

/// The weights of the u_i in y(theta) - y0, by powers 1 to 4 of theta.
fn powers_of_theta(tableau: &Tableau) -> [Vec<f64>; 4] {
    let d = &tableau.d;
    let each = |of: &dyn Fn(usize) -> f64| (0..tableau.stages).map(of).collect();
    [
        each(&|i| tableau.m[i] + d[0][i]),
        each(&|i| d[1][i] - d[0][i]),
        each(&|i| d[2][i] - d[1][i]),
        each(&|i| -d[2][i]),
    ]
}

/// R(infinity) = 1 - b^T B^-1 1: the stiffest components are damped at once.
#[test]
fn every_method_is_damped_at_infinity() {
    for method in RosenbrockMethod::ALL {
        let tableau = method.tableau();
        let classical = Classical::of(tableau);
        let b = classical.weights(&tableau.m);
        let ones = DMatrix::from_element(tableau.stages, 1, 1.0);
        let solved = classical.beta.clone().try_inverse().unwrap() * ones;
        let at_infinity = 1.0 - dot(&b, solved.as_slice());
        assert!(
            at_infinity.abs() < PRINTED,
            "{}: {at_infinity:e}",
            tableau.name
        );
    }
}

/// |R(iy)| <= 1 along the imaginary axis and R analytic to its left: A-stability.
#[test]
fn every_method_is_a_stable() {
    for method in RosenbrockMethod::ALL {
        let tableau = method.tableau();
        let classical = Classical::of(tableau);
        let b = classical.weights(&tableau.m);
        let s = tableau.stages;
        for exponent in -40..=40 {
            let y = 10f64.powf(f64::from(exponent) / 10.0);
            // (I - i y B) x = 1 as one real system of twice the size
            let system = DMatrix::from_fn(2 * s, 2 * s, |i, j| {
                let beta = classical.beta[(i % s, j % s)];
                match (i / s, j / s) {
                    (0, 1) => y * beta,
                    (1, 0) => -y * beta,
                    _ => f64::from(u8::from(i == j)),
                }
            });
            let ones = DMatrix::from_fn(2 * s, 1, |i, _| if i < s { 1.0 } else { 0.0 });
            let x = system.lu().solve(&ones).unwrap();
            let (real, imaginary) = (dot(&b, &x.as_slice()[..s]), dot(&b, &x.as_slice()[s..]));
            let modulus = (1.0 - y * imaginary).hypot(y * real);
            assert!(modulus <= 1.0 + 1e-12, "{} at {y}: {modulus}", tableau.name);
        }
    }
}

/// Rodas5P and RODAS: the last stage is at the end of the step and its weights are those of y1.
#[test]
fn the_rodas_methods_are_stiffly_accurate() {
    for method in [RosenbrockMethod::Rodas5P, RosenbrockMethod::Rodas4] {
        let tableau = method.tableau();
        let classical = Classical::of(tableau);
        let b = classical.weights(&tableau.m);
        let last = tableau.stages - 1;
        for (j, b) in b.iter().enumerate() {
            assert!((b - classical.beta[(last, j)]).abs() < PRINTED);
        }
        let end: f64 = classical.alpha.row(last).iter().sum();
        assert!((end - 1.0).abs() < PRINTED);
    }
}

/// The sums alpha_i and gamma_i are printed too, with df/dt; here they check the conversion.
#[test]
fn the_row_sums_are_the_printed_ones() {
    let rodas4 = Classical::of(RosenbrockMethod::Rodas4.tableau());
    let rodas5p = Classical::of(RosenbrockMethod::Rodas5P.tableau());
    let check = |matrix: &DMatrix<f64>, printed: &[f64]| {
        for (row, printed) in matrix.row_iter().zip(printed) {
            assert!((row.iter().sum::<f64>() - printed).abs() < 10.0 * PRINTED);
        }
    };
    check(&rodas4.alpha, &[0.0, 0.386, 0.21, 0.63, 1.0, 1.0]);
    check(&rodas4.gamma, &[0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0]);
    let alpha = [
        0.0,
        0.6358126895828704,
        0.4095798393397535,
        0.9769306725060716,
        0.4288403609558664,
        1.0,
        1.0,
        1.0,
    ];
    let gamma = [
        0.21193756319429014,
        -0.42387512638858027,
        -0.3384627126235924,
        1.8046452872882734,
        2.325825639765069,
        0.0,
        0.0,
        0.0,
    ];
    check(&rodas5p.alpha, &alpha);
    check(&rodas5p.gamma, &gamma);
}
