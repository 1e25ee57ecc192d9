//! The exact messages for texts as editors, keyboards and other formats make them: each names what it found and what to write.

use serde::Deserialize;
use wayfield_scenario::{Scenario, parse_ron, to_text};

/// A file with every kind of value, as presets have them.
#[derive(Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
struct Preset {
    arenas: usize,
    budget: Budget,
    #[serde(default)]
    learning: Option<Learning>,
}

#[derive(Debug, Deserialize, PartialEq)]
enum Budget {
    Episodes(u64),
    EnvSteps(u64),
}

#[derive(Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
struct Learning {
    double: bool,
    gamma: f32,
    loss: Loss,
    learning_rate: Schedule,
}

#[derive(Debug, Deserialize, PartialEq)]
enum Loss {
    Mse,
    Huber { delta: f32 },
}

#[derive(Debug, Deserialize, PartialEq)]
enum Schedule {
    Constant(f32),
    Linear { from: f32, to: f32 },
}

/// The message for a scenario that must not parse.
fn scenario_error(text: &str) -> String {
    Scenario::parse(text, "w.ron").expect_err(text).to_string()
}

/// The message for a preset that must not parse.
fn preset_error(text: &str) -> String {
    parse_ron::<Preset>(text, "p.ron").expect_err(text).to_string()
}

fn show(cases: &[(&str, &str)], message: fn(&str) -> String, file: &str) {
    for (text, _) in cases {
        println!("{text:?}\n    {}", message(text).replace(file, ""));
    }
}

#[test]
fn explore() {
    show(
        &[
            ("(name: \"Mine\",\u{a0}robot: (radius_m: 0.1))", ""),
            ("(name: “Mine”)", ""),
            ("(name: \"Mine”)", ""),
            ("(name: 'Mine')", ""),
            ("(name: «Mine»)", ""),
            ("(name: \"Mine\", robot: (radius_m: 0,1))", ""),
            ("(name: \"Mine\", robot: (radius_m: −0.1))", ""),
            ("(name: \"Mine\", robot: (radius_m: ０.1))", ""),
            ("(name: \"Mine\", robot: (radius_m: 0.１))", ""),
            ("(name: \"Mine\"， robot: (radius_m: 0.1))", ""),
            ("(name: \"Mine\", ro\u{200b}bot: (radius_m: 0.1))", ""),
            ("(name: \"Mine\",\u{3000}robot: (radius_m: 0.1))", ""),
            ("(name: \"Mine\", robot: (radius_m: 0.1 m))", ""),
            ("(name: \"Mine\", robot: (radius_m: 10cm))", ""),
            ("(name: \"Mine\", robot: (radius_m: \"0.1\"))", ""),
            ("(name: \"Mine\", robot: (radius_m: 1/2))", ""),
            ("(name: \"Mine\", lidar: (field_of_view_rad: 270°))", ""),
            ("(name: \"Mine\", lidar: (beams: 2e1))", ""),
            ("(name: \"Mine\", lidar: (beams: 24.0))", ""),
            ("(name: \"Mine\", benchmark_route: (start_m: (0,6, 0,6)))", ""),
            ("(name: \"Mine\", benchmark_route: (start_m: (0.6, 0.6, 0.6)))", ""),
            ("(name: \"Mine\", benchmark_route: (start_m: (100,200,300)))", ""),
            ("{\"name\": \"Mine\"}", ""),
            ("(\"name\": \"Mine\")", ""),
            ("name: Mine\nrobot:\n  radius_m: 0.1\n", ""),
            ("name = \"Mine\"\n[robot]\nradius_m = 0.1\n", ""),
            ("[robot]\nradius_m = 0.1\n", ""),
            ("# my world\n(name: \"Mine\")", ""),
            ("(name: \"Mine\", # my world\n)", ""),
            ("(\n# my world\nname: \"Mine\")", ""),
            ("(name: \"Mine\"; robot: (radius_m: 0.1))", ""),
            ("(name: \"Mine\", robot: (radius_m: 0.1;))", ""),
            ("(name = \"Mine\")", ""),
            ("(name: \"C:\\worlds\")", ""),
            ("(name: \"Mine\", lidar: (beams: 24, beems: 3, max_range_m: far), gaols: 3, task: (goal_radius_m: -1))", ""),
            ("(obstacles: [(shape: Circl(radius_m: 0.1)), (shape: Circle(radius_m: big), position_m: 3)], robot: (radius_m: 99))", ""),
            ("\u{feff}(name: \"Mine\", zzz: 1)", ""),
            ("\r(name: \"Mine\",\r\n\tzzz: 1)", ""),
            ("(name: \"Mine\") // end;\n", ""),
        ],
        scenario_error_or_ok,
        "w.ron:",
    );
    show(
        &[
            ("(arenas: 16, budget: EnvSteps(6e5))", ""),
            ("(arenas: 16, budget: EnvSteps(6.5e5))", ""),
            ("(arenas: 16, budget: EnvSteps(600k))", ""),
            ("(arenas: 16, budget: EnvSteps(0.6M))", ""),
            ("(arenas: 16, budget: EnvSteps(600,000))", ""),
            ("(arenas: 16, budget: EnvSteps(1,000,000))", ""),
            ("(arenas: 1,024, budget: EnvSteps(1))", ""),
            ("(arenas: 16, budget: 600000)", ""),
            ("(arenas: 16, budget: \"EnvSteps\")", ""),
            ("(arenas: 16, budget: envsteps(6))", ""),
            ("(arenas: 16, budget: EnvSteps)", ""),
            ("(arenas: 16, budget: EnvSteps(\"6\"))", ""),
            ("(arenas: 16, budget: Steps(6))", ""),
            ("(arenas: \"16\", budget: Episodes(-6))", ""),
            ("()", ""),
            ("(learning: (double: True, gamma: 0,99, loss: \"huber\", learning_rate: 3e-4))", ""),
            ("(arenas: 1, budget: Episodes(1), learning: (double: yes, gamma: .99, loss: 1.0, learning_rate: (0.1, 0.2)))", ""),
            ("(arenas: 1, budget: Episodes(1), learning: (double: 1, gamma: 1., loss: Mse(), learning_rate: Constant(0,001)))", ""),
            ("(arenas: 1, budget: Episodes(1), learning: (gamma: +0.5, loss: mse, learning_rate: Linear(to: 0.1)))", ""),
            ("(arenas: 1 budget: Episodes(1) learning: ())", ""),
            ("(arenas: null, budget: None)", ""),
            ("(arenas: 1.000.000, budget: Episodes(1))", ""),
            ("(arenas: 1, budget: Episodes(1_000), learning: (double: true, gamma: 1,000.5, loss: Mse, learning_rate: Constant(0.1)))", ""),
        ],
        preset_error,
        "p.ron:",
    );
    let _ = (to_text, scenario_error as fn(&str) -> String);
}

fn scenario_error_or_ok(text: &str) -> String {
    match Scenario::parse(text, "w.ron") {
        Ok(_) => "OK".into(),
        Err(error) => error.to_string(),
    }
}
