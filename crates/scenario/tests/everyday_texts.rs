//! The exact messages for slips caused by editors, keyboards and other formats: each names what was found and what to write.

use serde::Deserialize;
use wayfield_scenario::{Scenario, parse_ron, resemblance, to_text};

/// A file with every kind of value that occurs in presets.
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

/// Asserts that each text gives exactly its message.
fn check(file: &str, message: fn(&str) -> String, cases: &[(&str, &str)]) {
    let mut wrong = String::new();
    for (text, expected) in cases {
        let (found, expected) = (message(text), format!("{file}:{expected}"));
        if found != expected {
            wrong += &format!("for {text}\nfound    {found}\nexpected {expected}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn characters_that_look_like_those_of_ron_are_named() {
    check(
        "w.ron",
        scenario_error,
        &[
            (
                "(name: \"Mine\",\u{a0}robot: (radius_m: 0.1))",
                "1:15: a no-break space (U+00A0): write an ordinary space",
            ),
            (
                "(name: \"Mine\",\u{3000}robot: (radius_m: 0.1))",
                "1:15: a special space (U+3000): write an ordinary space",
            ),
            ("(name: “Mine”)", "1:8: a typographic quotation mark (U+201C): write \"...\""),
            ("(name: \"Mine”)", "1:13: a typographic quotation mark (U+201D): write \"...\""),
            ("(name: «Mine»)", "1:8: a typographic quotation mark (U+00AB): write \"...\""),
            ("(name: `Mine`)", "1:8: a backtick (U+0060): write \"...\""),
            ("(name: 'Mine')", "1:8: `name` must be text in double quotes: \"...\""),
            ("(name: \"Mine\", robot: (radius_m: −0.1))", "1:34: a dash or minus sign (U+2212): write `-`"),
            ("(name: \"Mine\", robot: (radius_m: 0.１))", "1:36: a full-width character (U+FF11): write `1`"),
            ("(name: \"Mine\"， robot: (radius_m: 0.1))", "1:14: a full-width character (U+FF0C): write `,`"),
            (
                "(name: \"Mine\", ro\u{200b}bot: (radius_m: 0.1))",
                "1:18: an invisible character (U+200B): delete it",
            ),
            ("(name: \"Mine\"\u{7}, robot: ())", "1:14: an invisible character (U+0007): delete it"),
        ],
    );
}

#[test]
fn everyday_number_notations_get_the_number_to_write() {
    check(
        "w.ron",
        scenario_error,
        &[
            ("(name: \"Mine\", robot: (radius_m: 0,1))", "1:34: a decimal comma: write 0.1"),
            (
                "(name: \"Mine\", robot: (radius_m: 0.1 m))",
                "1:34: `robot.radius_m` must be a number only: write 0.1, without `m`",
            ),
            (
                "(name: \"Mine\", robot: (radius_m: 10cm))",
                "1:34: `robot.radius_m` must be a number only: write 0.1 for 10 cm",
            ),
            (
                "(name: \"Mine\", lidar: (field_of_view_rad: 270°))",
                "1:43: `lidar.field_of_view_rad` must be a number only: write 4.712389 for 270 °",
            ),
            (
                "(name: \"Mine\", robot: (radius_m: \"0.1\"))",
                "1:34: `robot.radius_m` must be a number, without quotes",
            ),
            (
                "(name: \"Mine\", robot: (radius_m: 1/2))",
                "1:37: this is not a comment: write `//` or `/* */`, or the result of a division as one number",
            ),
            ("(name: \"Mine\", lidar: (beams: 2e1))", "1:31: `lidar.beams` must be a whole number: write 20"),
            (
                "(name: \"Mine\", lidar: (beams: 24.0))",
                "1:31: `lidar.beams` must be a whole number: write 24",
            ),
            (
                "(name: \"Mine\", lidar: (beams: 10-20))",
                "1:31: `lidar.beams` must be a single number, not `10-20`",
            ),
            (
                "(name: \"Mine\", lidar: (max_range_m: 2km))",
                "1:37: `lidar.max_range_m` must be a number only: write 2000 for 2 km",
            ),
            (
                "(name: \"Mine\", task: (control_period_s: 5km/h))",
                "1:41: `task.control_period_s` must be a number only: write 1.3888888 for 5 km/h",
            ),
            (
                "(name: \"Mine\", task: (control_period_s: 5 km/h))",
                "1:41: `task.control_period_s` must be a number only: write 1.3888888 for 5 km/h",
            ),
            (
                "(name: \"Mine\", robot: (max_acceleration_m_s2: 2m/s^2))",
                "1:47: `robot.max_acceleration_m_s2` must be a number only: write 2, without `m/s^2`",
            ),
            (
                "(name: \"Mine\", robot: (radius_m: 2m// two\n))",
                "1:34: `robot.radius_m` must be a number only: write 2, without `m`",
            ),
            (
                "(name: \"Mine\", robot: (radius_m: 2in))",
                "1:34: `robot.radius_m` must be a number only, in the unit of the field, without `in`",
            ),
            (
                "(name: \"Mine\", lidar: (beams: 2.4e0))",
                "1:31: `lidar.beams` must be a whole number, without a fraction",
            ),
            (
                "(name: \"Mine\", lidar: (beams: -0.5e1))",
                "1:31: `lidar.beams` must be a whole number in range: this one is negative or too large",
            ),
            (
                "(name: \"Mine\", lidar: (beams: 1e30))",
                "1:31: `lidar.beams` must be a whole number in range: this one is negative or too large",
            ),
            (
                "(name: \"Mine\", lidar: (beams: 1e16))",
                "1:31: `lidar.beams` must be a whole number in digits only",
            ),
            (
                "(name: \"Mine\", benchmark_route: (start_m: (0,6, 0,6)))",
                "1:43: decimal commas: write (0.6, 0.6)",
            ),
            (
                "(name: \"Mine\", benchmark_route: (start_m: (100,200,300)))",
                "1:52: `benchmark_route.start_m` must end before this: a `)` is missing, or it has too many parts",
            ),
        ],
    );
    check(
        "p.ron",
        preset_error,
        &[
            ("(arenas: 1, budget: EnvSteps(6e5))", "1:30: `budget` must be a whole number: write 600000"),
            (
                "(arenas: 1, budget: EnvSteps(600k))",
                "1:30: `budget` must be a number in digits: write 600000",
            ),
            (
                "(arenas: 1, budget: EnvSteps(0.6M))",
                "1:30: `budget` must be a number in digits: write 600000",
            ),
            ("(arenas: 1, budget: EnvSteps(600,000))", "1:30: a comma inside a number: write 600000"),
            ("(arenas: 1, budget: EnvSteps(1,000,000))", "1:30: commas inside a number: write 1000000"),
            ("(arenas: 1,024, budget: EnvSteps(1))", "1:10: a comma inside a number: write 1024 or 1.024"),
            ("(arenas: 1, budget: EnvSteps(\"6\"))", "1:30: `budget` must be a whole number, without quotes"),
        ],
    );
    let text = "(arenas: 1, budget: Episodes(1_000), learning: (double: true, gamma: +.5, loss: Mse, learning_rate: Constant(1.)))";
    let read: Preset = parse_ron(text, "p.ron").expect("RON's own ways to write numbers are read");
    assert_eq!(read.budget, Budget::Episodes(1000));
}

#[test]
fn other_formats_and_their_syntax_are_named() {
    let parentheses = "1:1: the file must be written in parentheses: (name: ..., ...)";
    check(
        "w.ron",
        scenario_error,
        &[
            (
                "{\"name\": \"Mine\"}",
                "1:1: this looks like JSON: RON has parentheses instead of braces, and field names without quotes: (name: ...)",
            ),
            ("(\"name\": \"Mine\")", "1:2: a field's name has no quotes: write `name: value`"),
            ("name: Mine\nrobot:\n  radius_m: 0.1\n", parentheses),
            ("name = \"Mine\"\n[robot]\nradius_m = 0.1\n", parentheses),
            ("[robot]\nradius_m = 0.1\n", "1:1: the file must be written in parentheses: (...)"),
            ("# my world\n(name: \"Mine\")", "1:1: a comment starts with `//`, not with `#`"),
            ("(name: \"Mine\", # my world\n)", "1:16: a comment starts with `//`, not with `#`"),
            ("(name: \"Mine\"; robot: ())", "1:14: fields are separated by commas, not by `;`"),
            ("(name = \"Mine\")", "1:7: write `:` between a field's name and its value, not `=`"),
            (
                "(name: \"C:\\worlds\")",
                "1:11: a backslash begins an escape: for the backslash itself, write two of them",
            ),
        ],
    );
}

#[test]
fn a_value_in_place_of_a_choice_gets_the_choices() {
    let choices = "`budget` must be one of the choices `Episodes`, `EnvSteps`";
    check(
        "p.ron",
        preset_error,
        &[
            ("(arenas: 1, budget: 600000)", &format!("1:21: {choices}: write `Episodes(600000)`")),
            ("(arenas: 1, budget: 6e5)", &format!("1:21: {choices}")),
            ("(arenas: 1, budget: (1, 2))", &format!("1:21: {choices}")),
            ("(arenas: 1, budget: \"EnvSteps\")", &format!("1:21: {choices}, without quotes")),
            (
                "(arenas: 1, budget: envsteps(6))",
                "1:21: unknown choice `envsteps` for `budget`: did you mean `EnvSteps`? the choices are `Episodes`, `EnvSteps`",
            ),
            ("(arenas: 1, budget: EnvSteps)", "1:29: `budget` must be written with parentheses: (...)"),
        ],
    );
}

#[test]
fn all_problems_of_a_text_are_listed() {
    let loss = "the choices `Mse`, `Huber`";
    let rate = "the choices `Constant`, `Linear`";
    check(
        "p.ron",
        preset_error,
        &[
            (
                "(arenas: 1, budget: EnvSteps(6e5), # a comment\n # another\n colour: 1)",
                "1:30: `budget` must be a whole number: write 600000\n\
                 p.ron:1:36: a comment starts with `//`, not with `#`\n\
                 p.ron:2:2: a comment starts with `//`, not with `#`\n\
                 p.ron:3:2: unknown field `colour` in the file: the fields are `arenas`, `budget`, `learning`",
            ),
            (
                "(arenas: 1, colour: 1 , budget: EnvSteps(1))",
                "1:13: unknown field `colour` in the file: the fields are `arenas`, `budget`, `learning`",
            ),
            ("()", "1:1: the file lacks the fields `arenas`, `budget`: add them"),
            (
                "(learning: (double: True, gamma: 0,99, loss: 'mse', learning_rate: 3e-4), colour: 1)",
                &format!(
                    "1:1: the file lacks the fields `arenas`, `budget`: add them\n\
                     p.ron:1:21: `learning.double` must be true or false\n\
                     p.ron:1:34: a decimal comma: write 0.99\n\
                     p.ron:1:46: `learning.loss` must be one of {loss}, without quotes: write `Mse`\n\
                     p.ron:1:68: `learning.learning_rate` must be one of {rate}: write `Constant(3e-4)`\n\
                     p.ron:1:75: unknown field `colour` in the file: the fields are `arenas`, `budget`, `learning`"
                ),
            ),
            (
                "(arenas: 1 budget: Episodes(1) learning: (gamma: 1, loss: Mse(), learning_rate: Linear(to: 0.1)))",
                "1:12: a comma or a closing bracket is missing before this\n\
                 p.ron:1:32: a comma or a closing bracket is missing before this\n\
                 p.ron:1:42: `learning` lacks the field `double`: add `double: ...`\n\
                 p.ron:1:62: `learning.loss` must be written without parentheses\n\
                 p.ron:1:81: `learning.learning_rate` lacks the field `from`: add `from: ...`",
            ),
        ],
    );
    check(
        "w.ron",
        scenario_error,
        &[
            (
                "(obstacles: [(shape: Circl(radius_m: 0.1)), (shape: Circle(radius_m: big), position_m: 3)], robot: (radius_m: 99))",
                "1:1: the file lacks the field `name`: add `name: ...`\n\
                 w.ron:1:14: `obstacles[0]` lacks the field `position_m`: add `position_m: ...`\n\
                 w.ron:1:22: unknown choice `Circl` for `obstacles[0].shape`: did you mean `Circle`? the choices are \
                 `Circle`, `Rectangle`, `Polygon`, `Capsule`\n\
                 w.ron:1:70: `obstacles[1].shape.radius_m` must be a number\n\
                 w.ron:1:88: `obstacles[1].position_m` must be a point: (x, y)\n\
                 w.ron:1:111: `robot.radius_m` is 99: write a number from 0.01 to 10 (metres)",
            ),
            // A point in another unit is not also outside the enclosure.
            (
                "(name: \"Mine\", obstacles: [(shape: Circle(radius_m: 0.1), position_cm: (60, -60))])",
                "1:59: unknown field `position_cm` in `obstacles[0]`: did you mean `position_m`? the fields are `shape`, \
                 `position_m`, `rotation_rad`, `motion`",
            ),
        ],
    );
}

#[test]
fn a_long_text_still_gets_its_first_problem_quickly() {
    let text = format!("(name: 3, about: \"{}\", colour: 1)", "x".repeat(1 << 19));
    let began = std::time::Instant::now();
    assert_eq!(scenario_error(&text), "w.ron:1:8: `name` must be text in double quotes: \"...\"");
    assert!(began.elapsed().as_secs() < 5);
    let text = format!("(name: \"Mine\", about: \"{}\", starts: Fixed)", "x".repeat(1 << 15));
    let message = scenario_error(&text);
    assert!(message.ends_with("`starts` must be written with parentheses: (...)"), "{message}");
}

#[test]
fn a_byte_order_mark_is_read_and_kept() {
    let text = "\u{feff}(name: \"Mine\", robot: (radius_m: 0.1))\n";
    let mut scenario = Scenario::parse(text, "w.ron").expect("the mark is skipped");
    assert_eq!(to_text(&scenario, Some(text)), text);
    scenario.robot.radius_m = 0.11;
    assert_eq!(to_text(&scenario, Some(text)), text.replace("0.1)", "0.11)"));
    let message = scenario_error("\u{feff}(name: \"Mine\", robot: (radius_m: 99))");
    assert!(
        message.starts_with("w.ron:1:34: `robot.radius_m` is 99"),
        "columns do not count the mark: {message}"
    );
    let message = scenario_error("\u{feff}(name: \"Mine\", robt: 1)");
    assert!(message.starts_with("w.ron:1:16: unknown field `robt`"), "{message}");
    let named = "\u{feff}Scenario(name: \"Mine\")";
    assert_eq!(resemblance::<Scenario>(named, "Scenario"), usize::MAX, "the name after the mark is read");
}
