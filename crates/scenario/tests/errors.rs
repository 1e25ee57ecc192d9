//! The exact messages for invalid scenario files: file, line, column, problem and fix.

use std::path::Path;

use glam::vec2;
use wayfield_scenario::{Obstacle, ObstacleMotion, Scenario, Shape, diagnostics, parse_ron, to_ron};

const FIXTURES: &str = "tests/fixtures";

/// The message for a file that must not load. Tests run in the root of the package, so paths are short.
fn load_error(path: &str) -> String {
    Scenario::load(path).expect_err(path).to_string()
}

/// The message for a text that must not parse.
fn parse_error(text: &str) -> String {
    Scenario::parse(text, "w.ron").expect_err(text).to_string()
}

#[test]
fn each_invalid_file_gives_the_message_in_its_fixture() {
    for name in [
        "typo",
        "broken",
        "latin-1",
        "numbers",
        "fit",
        "obstacles",
        "speeds",
        "outside",
        "beyond",
        "no-room",
        "too-near",
        "places",
        "unreachable",
    ] {
        let message = load_error(&format!("{FIXTURES}/{name}.ron"));
        let file = format!("{FIXTURES}/{name}.txt");
        if std::env::var_os("WAYFIELD_RENEW").is_some() {
            std::fs::write(&file, format!("{message}\n")).expect("the fixture can be written");
        }
        let expected = std::fs::read_to_string(&file).unwrap_or_default();
        assert_eq!(
            message,
            expected.trim_end(),
            "{file} is out of date; help: cargo xtask messages. The message is now:\n{message}\n"
        );
    }
}

#[test]
fn the_message_for_a_missing_file_lists_its_neighbours() {
    let near = format!("{FIXTURES}/neighbours");
    let listed = format!("(files there: {near}/crossing.ron, {near}/doorway.ron)");
    assert_eq!(
        load_error(&format!("{near}/dorway.ron")),
        format!("{near}/dorway.ron: no such file: did you mean `{near}/doorway.ron`? {listed}")
    );
    assert_eq!(load_error(&format!("{near}/zzz.ron")), format!("{near}/zzz.ron: no such file {listed}"));
    assert_eq!(load_error(&near), format!("{near}: this is a folder: name a file in it {listed}"));
    assert_eq!(
        load_error(&format!("{near}/doorway.ron/x.ron")),
        format!("{near}/doorway.ron/x.ron: can't be read: Not a directory (os error 20)")
    );
}

#[test]
fn a_file_over_a_mebibyte_is_rejected() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("large.ron");
    std::fs::write(&path, " ".repeat((1 << 20) + 1)).expect("the scenario can be written");
    let message = load_error(path.to_str().expect("a plain path"));
    assert_eq!(message, format!("{}: larger than 1 MiB, the limit for this kind of file", path.display()));
}

#[test]
fn syntax_errors_have_a_position_and_a_fix() {
    let fields = "`name`, `about`, `enclosure`, `walls`, `obstacles`, `generators`, `robot`, `lidar`, `task`, \
         `starts`, `goals`, `benchmark_route`";
    let mut wrong = String::new();
    let root = format!("1:13: unknown field `zzz` in the file: the fields are {fields}");
    for (text, message) in [
        (r#"(name: "a", zzz: 1)"#, root.as_str()),
        (
            r#"(name: "a", lidar: (beems: 3))"#,
            "1:21: unknown field `beems` in `lidar`: did you mean `beams`? the fields are `beams`, \
             `field_of_view_rad`, `max_range_m`, `noise_std_m`, `dropout`, `latency_steps`",
        ),
        (
            "(name: \"a\",\n obstacles: [(shape: Circl(radius_m: 1), position_m: (0, 0))])",
            "2:22: unknown choice `Circl` for `obstacles[0].shape`: did you mean `Circle`? the choices are `Circle`, \
             `Rectangle`, `Polygon`, `Capsule`",
        ),
        (
            "(name: \"a\",\n obstacles: [(shape: Circle(radius_m: 1), position_m: (0, 0), motion: Wander())])",
            "2:71: unknown choice `Wander` for `obstacles[0].motion`: the choices are `Static`, `Orbit`, `Patrol`, \
             `BackAndForth`, `RandomWalk`, `Pedestrian`, `KeyFrames`",
        ),
        (
            r#"(name: "a", enclosure: Circle(radius_m: 2))"#,
            "1:24: unknown choice `Circle` for `enclosure`: the choices are `Rectangle`, `Polygon`",
        ),
        (
            r#"(name: "a", goals: Fix(position_m: (0, 0)))"#,
            "1:20: unknown choice `Fix` for `goals`: did you mean `Fixed`? the choices are `Random`, `Within`, \
             `Fixed`, `OneOf`",
        ),
        (
            r#"(name: "a", generators: [(count: 2, shape: Capsule(length_m: (1, 2)))])"#,
            "1:44: unknown choice `Capsule` for `generators[0].shape`: the choices are `Circle`, `Rectangle`",
        ),
        (
            r#"(name: "a", generators: [(count: 2, shape: Circle(radius_m: 0.1))])"#,
            "1:61: `generators[0].shape.radius_m` must be written with parentheses: (...)",
        ),
        (
            r#"(name: "a", walls: [(corners_m: [0, 1])])"#,
            "1:34: `walls[0].corners_m[0]` must be a point: (x, y)\n\
             w.ron:1:37: `walls[0].corners_m[1]` must be a point: (x, y)",
        ),
        (
            r#"(name: "a", walls: [(thickness_m: 1)])"#,
            "1:21: `walls[0]` has neither corners nor cells: write `corners_m` or `cells`",
        ),
        ("(about: \"a\",\n)", "1:1: the file lacks the field `name`: add `name: ...`"),
        (
            r#"(name: "a", obstacles: [(shape: Circle(), position_m: (0, 0))])"#,
            "1:33: `obstacles[0].shape` lacks the field `radius_m`: add `radius_m: ...`",
        ),
        (
            r#"(name: "a", lidar: (dropout: 1, dropout: 0))"#,
            "1:33: `dropout` appears twice in `lidar`: remove one",
        ),
        (r#"(name: "a", lidar: (beams: "x"))"#, "1:28: `lidar.beams` must be a whole number, without quotes"),
        (
            r#"(name: "a", lidar: (beams: 2.5))"#,
            "1:28: `lidar.beams` must be a whole number, without a fraction",
        ),
        (
            r#"(name: "a", lidar: (beams: -2))"#,
            "1:29: `lidar.beams` must be a whole number in range: this one is negative or too large",
        ),
        (
            r#"(name: "a", lidar: (dropout: "x"))"#,
            "1:30: `lidar.dropout` must be a number, or a range (lowest, highest), without quotes",
        ),
        ("(name: a)", "1:8: `name` must be text in double quotes: \"...\""),
        (r#"(name: "a", obstacles: (1))"#, "1:24: `obstacles` must be a list in square brackets: [...]"),
        (
            r#"(name: "a", benchmark_route: (start_m: [0, 0]))"#,
            "1:40: `benchmark_route.start_m` must be a point: (x, y)",
        ),
        (r#"(name: "a", starts: Random)"#, "1:27: `starts` must be written with parentheses: Random()"),
        (
            r#"(name: "a", benchmark_route: (start_m: (0)))"#,
            "1:42: `benchmark_route.start_m` must be a point: (x, y)",
        ),
        (
            r#"(name: "a", benchmark_route: (start_m: (0, 0, 0)))"#,
            "1:47: `benchmark_route.start_m` must end before this: a `)` is missing, or it has too many parts",
        ),
        (r#"(name: "a" lidar: ())"#, "1:12: a comma or a closing bracket is missing before this"),
        (
            r#"(name: "a", obstacles: [}"#,
            "1:25: this closes no open bracket, or a value is missing before it",
        ),
        (r#"(name: "a", lidar = ())"#, "1:19: write `:` between a field's name and its value, not `=`"),
        (r#"(name: "a", lidar: (3))"#, "1:21: `3` is not a valid field name: write `name: value`"),
        (r#"(name: "a") x"#, "1:13: the file's value ends before this: remove what follows"),
        (r#"(name: "a", "#, "1:13: the file ends too early: a closing bracket is missing"),
        ("", " the file is empty"),
        ("Scenrio(name: \"a\")", "1:1: expected `Scenario(...)` or `(...)`, found `Scenrio`"),
        ("/* (name", "1:3: this comment has no end: close it with `*/`"),
        ("(name: \"abc", "1:8: this text has no closing quote: add one"),
        (
            r#"(name: "a\q")"#,
            "1:10: a backslash begins an escape: for the backslash itself, write two of them",
        ),
    ] {
        let (found, expected) = (parse_error(text), format!("w.ron:{message}"));
        if found != expected {
            wrong += &format!("for {text}\nfound    {found}\nexpected {expected}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn other_ron_files_have_messages_of_the_same_form() {
    fn message<T: serde::de::DeserializeOwned + std::fmt::Debug>(text: &str) -> String {
        parse_ron::<T>(text, "p.ron").expect_err(text).to_string()
    }
    assert_eq!(message::<bool>("1"), "p.ron:1:1: the file must be true or false");
    assert_eq!(message::<Vec<u8>>("[1, 2"), "p.ron:1:6: a comma or a closing bracket is missing before this");
    assert_eq!(
        message::<std::num::NonZeroU8>("0"),
        "p.ron:1:2: the file must be a nonzero u8, not the unsigned integer `0`"
    );
    let deep = "[".repeat(1 << 20);
    assert_eq!(
        message::<ron::Value>(&deep),
        "p.ron:1:34: brackets are nested too deeply here: no value in this kind of file needs that many"
    );
    assert_eq!(parse_ron::<Option<u8>>("7", "p.ron"), Ok(Some(7)), "Some(...) need not be written");
}

#[test]
fn long_texts_and_large_lists_are_rejected() {
    let circle = Obstacle {
        shape: Shape::Circle { radius_m: -1.0 },
        position_m: vec2(0.0, 0.0),
        rotation_rad: 0.0,
        motion: ObstacleMotion::Static,
    };
    let scenario = Scenario {
        name: "n".repeat(101),
        about: "a".repeat(2_001),
        obstacles: vec![circle; 10_001],
        ..Scenario::default()
    };
    let found: Vec<_> = diagnostics(&scenario).iter().take(4).map(ToString::to_string).collect();
    assert_eq!(
        found,
        [
            "`name` must have 1 to 100 characters on one line",
            "`about` is too long: write at most 2000 characters",
            "`obstacles` has 10001 entries: write 0 to 10000",
            "`obstacles[0].shape.radius_m` is -1: write a number from 0.001 to 1000 (metres)",
        ]
    );
    let many_obstacles = Scenario { obstacles: scenario.obstacles[..150].to_vec(), ..Scenario::default() };
    let text = to_ron(&many_obstacles).expect("the scenario can be written");
    let message = parse_error(&text);
    assert_eq!(message.lines().count(), 101);
    assert!(message.ends_with("w.ron: and 50 more problems: fix some and check again"), "{message}");
}

#[test]
fn a_tab_in_a_name_is_rejected() {
    let scenario = Scenario { name: "a\tb".into(), ..Scenario::default() };
    let found: Vec<_> = diagnostics(&scenario).iter().map(ToString::to_string).collect();
    assert_eq!(found, ["`name` contains a tab: write a space instead"]);
}

#[test]
fn non_finite_and_huge_numbers_are_rejected_everywhere() {
    for (name, expected) in [("everything.ron", 101), ("everything-else.ron", 6)] {
        let text = std::fs::read_to_string(Path::new(FIXTURES).join(name)).expect("the fixture is there");
        Scenario::parse(&text, name).expect("the unmodified file is valid");
        let mut numbers = 0;
        let mut at = 0;
        while let Some(start) = text[at..].find(|c: char| c.is_ascii_digit() || c == '-').map(|k| at + k) {
            at = text[start..]
                .find(|c: char| !(c.is_ascii_digit() || "-.".contains(c)))
                .map_or(text.len(), |k| start + k);
            for bad in ["NaN", "inf", "-inf", "-0.7e30", "1e30"] {
                let broken = format!("{}{bad}{}", &text[..start], &text[at..]);
                assert!(
                    Scenario::parse(&broken, "w.ron").is_err(),
                    "{bad} passes at byte {start}:\n{broken}"
                );
            }
            numbers += 1;
        }
        assert_eq!(numbers, expected, "each number of {name} was tried");
    }
}
