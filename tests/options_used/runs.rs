//! Quick runs of all commands for all kinds of system.

/// What moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// Two equal interfaces.
    Two,
    /// Two that differ.
    Unequal,
    /// Clusters of equal interfaces.
    Clusters,
    /// Fifty with constants of their own.
    Many,
    /// One.
    One,
    /// A law from a file.
    Law,
    /// A system from a file or one that is built in.
    System,
    /// Two equal interfaces in SI.
    Si,
}
use Kind::{Clusters, Law, Many, One, Si, System, Two, Unequal};

/// The commands, each with the options of its runs by kind. Those that look for equilibria of formulas in boxes, and for orbits on them,
/// are the faster the fewer states there are.
pub fn commands() -> Vec<(&'static str, Vec<(Kind, String)>)> {
    const FORMULAS: &str = "--law scenes/laws/spinodal.toml";
    let interfaces = |plain: &str, clusters: &str, law: &str| {
        vec![
            (Two, plain.to_owned()),
            (Unequal, format!("{plain} --set residual_strength_2=2e-3")),
            (Clusters, format!("{plain} {clusters}")),
            (One, format!("{plain} --interfaces 1")),
            (Law, format!("{plain} {FORMULAS} {law}")),
        ]
    };
    let with = |mut all: Vec<(Kind, String)>, others: &[(Kind, &str)]| {
        all.extend(
            others
                .iter()
                .map(|(kind, text)| (*kind, (*text).to_owned())),
        );
        all
    };
    let (few, one) = ("--interfaces 2 --clusters 2", "--interfaces 1");
    let some = "--interfaces 4 --clusters 2,2";
    let plain = "--driving 10 --stiffness 0.14";
    let si = "--si --driving 1e-5 --stiffness 5.43e9";
    let many = format!("{plain} --interfaces 50 --draw healing_time=90:110");
    vec![
        (
            "law",
            with(
                interfaces("--points 20", "", ""),
                &[(Si, "--si --points 20")],
            ),
        ),
        (
            "equilibria",
            with(
                interfaces(plain, "--interfaces 4", ""),
                &[(Many, &many), (System, "--system lorenz"), (Si, si)],
            ),
        ),
        (
            "integrate",
            with(
                interfaces(&format!("{plain} --until 4"), some, ""),
                &[
                    (Many, &format!("{many} --until 4")),
                    (System, "--system tests/data/cases/toggle.toml --until 1"),
                    (Si, &format!("{si} --until 3.6")),
                ],
            ),
        ),
        (
            "orbit",
            with(
                interfaces(&format!("{plain} --crosscheck none"), few, one),
                &[(System, "--system brusselator --crosscheck none")],
            ),
        ),
        (
            "section",
            with(
                interfaces(&format!("{plain} --returns 4 --skip 2"), some, ""),
                &[
                    (
                        System,
                        "--system brusselator --surface x=1 --returns 4 --skip 2",
                    ),
                    (Si, &format!("{si} --returns 4 --skip 2")),
                ],
            ),
        ),
        (
            "branch equilibria",
            with(
                interfaces("--stiffness 0.14 --from 180 --to 250", few, one),
                &[
                    (System, "--system lorenz --along r --from 24 --to 26"),
                    (Si, "--si --stiffness 5.43e9 --from 1.8e-4 --to 2.5e-4"),
                ],
            ),
        ),
        (
            "branch orbits",
            with(
                vec![
                    (Two, "--stiffness 0.14 --from 185 --to 192".to_owned()),
                    (
                        Unequal,
                        "--stiffness 0.14 --from 231 --to 233 --set residual_strength_2=2e-3"
                            .to_owned(),
                    ),
                    (
                        Clusters,
                        format!("--stiffness 0.14 --from 185 --to 192 {few}"),
                    ),
                    (One, format!("--stiffness 0.14 --from 220 --to 240 {one}")),
                    (
                        Law,
                        format!("--stiffness 0.14 --from 220 --to 240 {FORMULAS} {one}"),
                    ),
                ],
                &[(
                    System,
                    "--system brusselator --along b --from 2.1 --to 1.95",
                )],
            ),
        ),
        (
            "locus hopf",
            with(
                interfaces(
                    "--driving-range 185:235 --stiffness-range 0.139:0.141",
                    &format!("{few} --start 8.88,1e-4"),
                    &format!("{one} --start 8.69,4.3e-5"),
                ),
                &[
                    (
                        System,
                        "--system lorenz --in r,s --range r=24,26 --range s=9.5,10.5",
                    ),
                    (
                        Si,
                        "--si --driving-range 1.8e-4:2.5e-4 --stiffness-range 5.4e9:5.5e9",
                    ),
                ],
            ),
        ),
        (
            "sweep",
            with(
                interfaces("--driving 10 --stiffness 0.14", few, one),
                &[
                    (System, "--system brusselator --grid b=2.2:2.3:2"),
                    (Si, "--si --driving 1e-5 --stiffness 5.4e9"),
                ],
            ),
        ),
    ]
}
