//! `--import`: maps and worlds become scenarios that can be checked, drawn over their map, and trained in.

mod cli_support;

use std::fmt::Write as _;

use cli_support::messages::rejection;
use cli_support::{Workspace, quick_fast};

const MAP: &str = "image: room.pgm\nresolution: 0.1\norigin: [-2.0, -1.5, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

/// A room of 4 m x 3 m with a pillar, as the text of a PGM file.
fn room() -> String {
    let mut text = String::from("P2\n40 30\n255\n");
    for row in 0..30 {
        for column in 0..40 {
            let is_wall = row == 0 || row == 29 || column == 0 || column == 39;
            let is_pillar = (18..22).contains(&column) && (13..17).contains(&row);
            let _ = write!(text, "{} ", if is_wall || is_pillar { 0 } else { 254 });
        }
        text.push('\n');
    }
    text
}

const WORLD: &str = "<sdf version='1.6'><world name='w'>
<model name='walls'><static>1</static><link name='l'>
<collision name='a'><pose>0 1.5 0.5 0 0 0</pose><geometry><box><size>4 0.1 1</size></box></geometry></collision>
<collision name='b'><pose>0 -1.5 0.5 0 0 0</pose><geometry><box><size>4 0.1 1</size></box></geometry></collision>
<collision name='c'><pose>2 0 0.5 0 0 0</pose><geometry><box><size>0.1 3 1</size></box></geometry></collision>
<collision name='d'><pose>-2 0 0.5 0 0 0</pose><geometry><box><size>0.1 3 1</size></box></geometry></collision>
<collision name='statue'><geometry><mesh><uri>statue.dae</uri></mesh></geometry></collision>
</link></model></world></sdf>";

const BARN: &str = r#"{"radius_m": 0.075, "start_m": [-2.25, 3.0], "heading_rad": 1.57, "goal_m": [-2.25, 13.0],
"goal_radius_m": 1.0, "time_limit_s": 100, "worlds": [
{"world": 3, "circles_m": [[-0.075, 5.0]], "metric_path_length_m": 10.5}, {"world": 7, "circles_m": [[-4.425, 8.0]]}]}"#;

fn workspace() -> Workspace {
    let workspace = Workspace::new();
    workspace.write("map.yaml", MAP);
    workspace.write("room.pgm", room());
    workspace.write("room.world", WORLD);
    workspace.write("barn.json", BARN);
    workspace.write("quick.ron", quick_fast());
    workspace
}

#[test]
fn an_imported_map_can_be_checked_drawn_over_the_map_and_trained_in() {
    let workspace = workspace();
    let done = workspace.run_ok("--import map.yaml --out room.ron");
    assert_eq!((done.stdout.as_str(), done.stderr.as_str()), ("room.ron\n", ""));
    assert_eq!(workspace.run_ok("--check room.ron").stdout, "room.ron: ok (scenario)\n");
    workspace.run_ok("--draw plain.svg --scenario room.ron");
    workspace.run_ok("--draw over.svg --scenario room.ron --over map.yaml");
    let areas = workspace.text("over.svg").matches("<polygon").count()
        - workspace.text("plain.svg").matches("<polygon").count();
    assert!(areas >= 1, "the pillar is marked");
    assert!(workspace.text("over.svg").contains("occupied in the map"));
    for name in ["over.pdf", "over.png"] {
        workspace.run_ok(&format!("--draw {name} --scenario room.ron --over map.yaml"));
    }
    workspace.run_ok("--train --scenario room.ron --preset quick.ron --steps 200 --out run");
}

#[test]
fn the_robot_of_the_import_can_be_chosen() {
    let workspace = workspace();
    workspace.run_ok("--import map.yaml --out hall.ron --robot hall --set scenario.lidar.beams=36");
    let text = workspace.text("hall.ron");
    assert!(text.contains("beams: 36") && text.contains("v_m_s: 0.3"), "{text}");
    workspace.run_ok("--check hall.ron");
}

#[test]
fn settings_change_the_robot_that_the_file_implies() {
    let workspace = workspace();
    workspace.run_ok("--import barn.json --world 3 --out own.ron");
    workspace.run_ok("--import barn.json --world 3 --out set.ron --set scenario.lidar.beams=36");
    let own = workspace.text("own.ron");
    assert!(own.contains("beams: 72") && own.contains("radius_m: 0.3"), "{own}");
    assert_eq!(workspace.text("set.ron"), own.replace("beams: 72", "beams: 36"));
}

#[test]
fn what_is_not_imported_is_printed_and_written_into_the_file() {
    let workspace = workspace();
    let done = workspace.run_ok("--import room.world --out room.ron --json");
    assert_eq!(done.stderr, "note: room.world: meshes are left out: walls/statue\n");
    let json: serde_json::Value = serde_json::from_str(&done.stdout).expect("JSON");
    let expected = serde_json::json!({
        "scenario": "room.ron", "deviation_m": 0.0, "path_length_m": null,
        "findings": ["meshes are left out: walls/statue"],
    });
    assert_eq!(json, expected);
    assert!(
        workspace.text("room.ron").starts_with("// Not imported: meshes are left out: walls/statue.\n(\n")
    );
    let check = workspace.run_ok("--check room.ron");
    assert!(check.stdout.ends_with("room.ron: ok (scenario)\n"), "{}", check.stdout);
}

#[test]
fn a_file_of_barn_worlds_fills_a_folder_or_gives_one_world() {
    let workspace = workspace();
    let done = workspace.run_ok("--import barn.json --out worlds");
    assert_eq!(done.stdout, "worlds/barn-003.ron\nworlds/barn-007.ron\n");
    let json = workspace.run_ok("--import barn.json --out worlds --json").stdout;
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(
        (&json[0]["scenario"], &json[0]["path_length_m"]),
        (&"worlds/barn-003.ron".into(), &10.5.into())
    );
    assert_eq!(json.as_array().map(Vec::len), Some(2));
    workspace.run_ok("--import barn.json --world 3 --out three.ron");
    assert_eq!(workspace.text("three.ron"), workspace.text("worlds/barn-003.ron"));
    assert!(workspace.text("three.ron").contains("Shortest path: 10.5000 m."));
    workspace.run_ok("--check worlds three.ron");
    workspace.write("UPPER.JSON", BARN);
    assert_eq!(
        workspace.run_ok("--import UPPER.JSON --out upper").stdout,
        "upper/barn-003.ron\nupper/barn-007.ron\n"
    );
}

#[test]
fn stages_with_moving_cylinders_fill_a_folder_or_give_one_stage() {
    let workspace = workspace();
    workspace.write(
        "stages.json",
        r#"{"stages": {"4": {"static": [{"box": [0, 1, 3, 0.1, 0]}, {"box": [0, -1, 3, 0.1, 0]}],
        "moving": [{"radius_m": 0.16, "period_s": 40, "keys": [[0, -1, 0], [20, 1, 0], [40, -1, 0]]}]}}}"#,
    );
    assert_eq!(workspace.run_ok("--import stages.json --out stages").stdout, "stages/stage-4.ron\n");
    workspace.run_ok("--import stages.json --world 4 --out four.ron");
    let text = workspace.text("four.ron");
    assert_eq!(text, workspace.text("stages/stage-4.ron"));
    assert!(text.contains("end: Loop(period_s: 40.0)"), "{text}");
    workspace.run_ok("--check four.ron");
}

#[test]
fn invalid_imports_are_rejected_and_nothing_is_written() {
    let workspace = workspace();
    workspace.write("zero.yaml", MAP.replace("0.1", "0"));
    workspace.write("missing.yaml", MAP.replace("room.pgm", "other.png"));
    workspace.write("nan.yaml", MAP.replace("[-2.0, -1.5, 0.0]", "[.nan, 0, 0]"));
    workspace.write("cut.pgm", &room()[..500]);
    workspace.write("cut.yaml", MAP.replace("room.pgm", "cut.pgm"));
    workspace.write("huge.yaml", MAP.replace("room.pgm", "huge.pgm"));
    workspace.write("huge.pgm", "P5\n100000 100000\n255\n");
    workspace.write("small.yaml", MAP.replace("0.1", "0.005"));
    workspace.write("meshes.world", "<sdf><world name='w'><model name='m'><link name='l'><collision name='c'><geometry><mesh/></geometry></collision></link></model></world></sdf>");
    workspace.write("number.world", WORLD.replace("4 0.1 1", "4 0 1"));
    workspace.write("broken.world", "<sdf>\n<world>\n");
    for (arguments, expected) in [
        ("--import map.yaml", "--import needs an output file; help: add --out SCENARIO.ron"),
        (
            "--import map.yaml --out room.txt",
            "room.txt: not a scenario file; help: give a name that ends in .ron",
        ),
        ("--import map.yaml --out no/room.ron", "the folder no does not exist; help: create it first"),
        ("--import nothing.yaml --out new.ron", "nothing.yaml: no such file"),
        ("--import quick.ron --out new.ron", "quick.ron: not a kind of file that can be imported; help: "),
        (
            "--import zero.yaml --out new.ron",
            "zero.yaml:2:13: `resolution` is 0, not a number from 0.001 to 10; help: ",
        ),
        ("--import missing.yaml --out new.ron", "missing.yaml:1:8: there is no image `other.png`; help: "),
        (
            "--import nan.yaml --out new.ron",
            "nan.yaml:3:9: `origin` is [.nan, 0, 0], not three numbers from -1000000 to 1000000; help: ",
        ),
        ("--import cut.yaml --out new.ron", "cut.pgm: not a complete image: it ends too early; help: "),
        ("--import huge.yaml --out new.ron", "huge.pgm: 100000 x 100000 pixels, more than 8388608; help: "),
        ("--import small.yaml --out new.ron", "small.yaml: the robot fits nowhere on this map: "),
        ("--import room.pgm --out new.ron", "room.pgm: an image has no scale; help: "),
        (
            "--import meshes.world --out new.ron",
            "nothing in it can be imported: meshes are left out: m/c; help: ",
        ),
        ("--import number.world --out new.ron", "number.world:3:"),
        ("--import broken.world --out new.ron", "not readable XML: "),
        (
            "--import barn.json --out new.ron",
            "barn.json: it holds many worlds; help: choose one with --world N",
        ),
        ("--import barn.json --world 4 --out new.ron", "barn.json: it has no world 4; help: "),
        ("--import map.yaml --robot nobody --out new.ron", "nobody: no such file"),
        ("--import map.yaml --set scenario.robot.radius_m=-1 --out new.ron", "radius_m"),
        (
            "--draw new.svg --scenario scenario-1 --over map.yaml",
            "does not say where it lies in a map; help: ",
        ),
        ("--import map.yaml --out /dev/stdout --json", "both go to standard output; help: "),
        #[cfg(unix)]
        ("--import map.yaml --out /dev/fd/1 --json", "both go to standard output; help: "),
        ("--draw new.svg --scenario scenario-1 --resolution 0.05", "--resolution is for --over"),
        ("--draw new.svg --scenario clutter --levels 4 --over map.yaml", "cannot be used with"),
        ("--import map.yaml --out new.ron --tolerance -1", "give 0 to 10 (metres)"),
        ("--import map.yaml --out new.ron --resolution 0", "give 0.001 to 10 (metres)"),
    ] {
        let message = rejection(&workspace, arguments);
        assert!(message.contains(expected), "wayfield {arguments}\n{message}");
    }
}
