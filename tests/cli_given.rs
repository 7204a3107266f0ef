//! `run SCENE` with options of the scene's command beside it.

use crate::command;
use command::{folder, number, object, refused, run, twinslip};

/// A scene with most of what an option can take the place of.
fn scene(name: &str) -> String {
    let path = folder(name).join("scene.toml");
    let text = "command = \"integrate\"\ndriving = 0.12\nstiffness = 0.14\nuntil = 10.0\nevery = 2.0\n\
                [set]\nresidual_strength = 2e-3\nhealing_time = 50.0\n";
    std::fs::write(&path, text).expect("written");
    path.to_str().expect("UTF-8").to_owned()
}

#[test]
fn options_beside_a_scene_take_the_place_of_its_own() {
    let scene = scene("given");
    let plain = object(&format!("run {scene}"));
    assert_eq!(number(&plain, "/model/residual_strength"), 2e-3);
    for (given, same) in [
        (
            "--until 4",
            "--driving 0.12 --stiffness 0.14 --until 4 --every 2",
        ),
        (
            "--set K=0.1",
            "--driving 0.12 --stiffness 0.1 --until 10 --every 2",
        ),
        (
            "--stiffness=0.1",
            "--driving 0.12 --stiffness 0.1 --until 10 --every 2",
        ),
        // An option that excludes one of the scene's.
        (
            "--points 3",
            "--driving 0.12 --stiffness 0.14 --until 10 --points 3",
        ),
        (
            "--rtol 1e-5 --method rodas5p",
            "--driving 0.12 --stiffness 0.14 --until 10 --every 2 --rtol 1e-5 --method rodas5p",
        ),
    ] {
        let (run, typed) = (
            object(&format!("run {scene} {given}")),
            object(&format!(
                "integrate {same} --set residual_strength=2e-3,healing_time=50"
            )),
        );
        for part in ["model", "numerics", "result"] {
            assert_eq!(run[part], typed[part], "{given}: {part}");
        }
    }
    // One value of [set], and the option of the same parameter.
    for given in ["--set c=3e-3", "--residual-strength 3e-3"] {
        let made = object(&format!("run {scene} {given}"));
        assert_eq!(number(&made, "/model/residual_strength"), 3e-3, "{given}");
        assert_eq!(number(&made, "/model/healing_time"), 50.0, "{given}");
    }
}

#[test]
fn built_in_scenes_of_every_command_take_options() {
    let branch = object("run fig05 --set K=0.3");
    assert_eq!(number(&branch, "/model/stiffness"), 0.3);
    let equilibria = object("run equilibria --driving 500");
    assert_eq!(number(&equilibria, "/model/driving"), 500.0);
    let ended = twinslip("run equilibria --driving 500 --explain -o - --format csv");
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(
        ended.out.starts_with("# twinslip") && ended.err.contains("plan"),
        "{}",
        ended.err
    );
}

#[test]
fn what_a_scene_cannot_take_is_refused() {
    let scene = scene("not-given");
    refused(&format!("run {scene} --returns 5"), "--returns");
    refused(
        &format!("run {scene} --set nothing=5"),
        "no parameter `nothing`",
    );
    // All numbers of the scene would change their meaning.
    refused(
        &format!("run {scene} --driving 1um/s"),
        "the numbers of this scene are dimensionless",
    );
    refused("run --list --set K=1", "");
    let ended = run(&["run", "fig13", "--show", "--set", "K=1"]);
    assert_eq!(ended.code, 2, "{}", ended.err);
}
