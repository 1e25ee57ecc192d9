//! Tests of [`patch`] and [`to_text`]: layout, comments, defaults, line endings.

use serde::{Deserialize, Serialize};
use wayfield_ron_patch::{Style, Unsupported, patch, to_text};

/// A small schema with every kind of supported type.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Map {
    name: String,
    #[serde(default)]
    about: String,
    #[serde(default)]
    route: Vec<(f32, f32)>,
    #[serde(default)]
    posts: Vec<Post>,
    #[serde(default)]
    lidar: Lidar,
    #[serde(default)]
    goal: Goal,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Post {
    radius_m: f32,
    position_m: Point,
    #[serde(default)]
    is_metal: bool,
}

/// A tuple struct, which is how glam serializes a vector.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Point(f32, f32);

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
struct Lidar {
    beams: u32,
    max_range_m: f64,
}

impl Default for Lidar {
    fn default() -> Self {
        Self { beams: 24, max_range_m: 3.5 }
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
enum Goal {
    #[default]
    Anywhere,
    At {
        position_m: Point,
        heading_rad: Option<f32>,
    },
}

fn parse(text: &str) -> Option<Map> {
    ron::from_str(text).ok()
}

fn read(text: &str) -> Map {
    ron::from_str(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn style() -> Style {
    Style::default()
        .with_defaults(&read("(name: \"\")"), &["name"])
        .with_defaults(&Lidar::default(), &[])
        .with_defaults(&post(0.0, 0.0), &["radius_m", "position_m"])
        .with_blank_lines_except(&[("name", "about")])
}

fn post(radius_m: f32, x: f32) -> Post {
    Post { radius_m, position_m: Point(x, 0.0), is_metal: false }
}

/// `text` after `change`.
fn edited(text: &str, change: impl FnOnce(&mut Map)) -> String {
    let mut map = read(text);
    change(&mut map);
    let written = patch(text, &map, &style(), parse).expect("a supported type");
    assert_eq!(read(&written), map, "{written}");
    written
}

#[test]
fn the_canonical_text_has_one_line_per_struct_of_a_list() {
    let mut map = read("(name: \"Yard\")");
    assert_eq!(
        to_text(&map, &style()).as_deref(),
        Ok("(\n    name: \"Yard\",\n)\n"),
        "defaults are left out"
    );
    map.posts = vec![post(0.1, -0.0), Post { is_metal: true, ..post(0.2, 1e-7) }];
    map.goal = Goal::At { position_m: Point(1.0, 2.0), heading_rad: None };
    let expected = r#"(
    name: "Yard",

    posts: [
        (radius_m: 0.1, position_m: (-0.0, 0.0)),
        (radius_m: 0.2, position_m: (1e-7, 0.0), is_metal: true),
    ],

    goal: At(position_m: (1.0, 2.0), heading_rad: None),
)
"#;
    assert_eq!(to_text(&map, &style()).as_deref(), Ok(expected));
    assert_eq!(edited(expected, |_| {}), expected);
}

#[test]
fn the_default_style_writes_every_field_without_blank_lines() {
    let text = to_text(&Lidar::default(), &Style::default());
    assert_eq!(text.as_deref(), Ok("(\n    beams: 24,\n    max_range_m: 3.5,\n)\n"));
}

#[test]
fn a_tuple_that_contains_a_list_of_structs_is_written_on_several_lines() {
    let value = (1, vec![Lidar::default()]);
    let text = to_text(&value, &Style::default()).expect("a supported type");
    assert_eq!(text, "(\n    1,\n    [\n        (beams: 24, max_range_m: 3.5),\n    ],\n)\n");
    let back: (i32, Vec<Lidar>) = ron::from_str(&text).expect("valid RON");
    assert_eq!(back, value);
}

#[test]
fn a_number_may_start_with_a_dot() {
    let text = "(name: \"x\", lidar: (beams: 30, max_range_m: .5), route: [(.5, 1), (-.5, 2)]) // mine\n";
    assert_eq!(edited(text, |map| map.lidar.beams = 31), text.replace("30", "31"));
    assert_eq!(edited(text, |map| map.lidar.max_range_m = 2.5), text.replace(" .5)", " 2.5)"));
    assert_eq!(edited(text, |map| map.route[0].1 = 3.0), text.replace("(.5, 1)", "(.5, 3.0)"));
}

#[test]
fn a_value_that_is_not_a_struct_is_written_and_patched() {
    let read = |text: &str| ron::from_str::<Vec<u32>>(text).ok();
    let style = Style::default();
    assert_eq!(to_text(&vec![1, 2], &style).as_deref(), Ok("[1, 2]\n"));
    assert_eq!(patch("[1, /* two */ 2]\n", &vec![1, 3], &style, read).as_deref(), Ok("[1, /* two */ 3]\n"));
    let read = |text: &str| ron::from_str::<Goal>(text).ok();
    let text = "At(position_m: (1, 2), heading_rad: None) // here\n";
    assert_eq!(patch(text, &Goal::Anywhere, &style, read).as_deref(), Ok("Anywhere // here\n"));
}

#[test]
fn a_map_is_unsupported() {
    let map = std::collections::BTreeMap::from([(1, 2)]);
    let error: Result<_, Unsupported> = to_text(&map, &Style::default());
    assert_eq!(error.map_err(|error| error.to_string()), Err("cannot be written as RON: a map".into()));
}

#[test]
fn a_long_string_is_wrapped_at_spaces() {
    let about = "Twelve letter words, or so.  ".repeat(12) + "\u{2003}and a wide space, \u{7} \u{1F916}";
    let mut map = read("(name: \"\")");
    map.about.clone_from(&about);
    let text = to_text(&map, &style()).expect("a supported type");
    assert_eq!(read(&text).about, about);
    assert!(text.lines().all(|line| line.chars().count() <= 110), "{text}");
    assert_eq!(text.lines().filter(|line| line.ends_with('\\')).count(), 3, "{text}");
    assert!(text.contains("\\u{7}"), "control characters are escaped: {text}");
    map.about = "x".repeat(300);
    let text = to_text(&map, &style()).expect("a supported type");
    assert!(text.contains(&map.about), "a word is not broken: {text}");
    assert_eq!(read(&text).about, map.about);
}

#[test]
fn a_list_keeps_its_layout() {
    const ROWS: &str = "[\n  (0.0, 0.0), (1.0, 0.0), // row\n  (2.0, 0.0), (3.0, 0.0),\n]";
    const PARTS: &str = "[\n  (0.0, 0.0),\n\n  (1.0, 0.0),\n  (2.0, 0.0)\n]";
    for (list, points, expected) in [
        (ROWS, &[1_u8, 2, 3][..], "[\n  (1.0, 0.0), // row\n  (2.0, 0.0), (3.0, 0.0),\n]"),
        (ROWS, &[0, 2, 3], "[\n  (0.0, 0.0),\n  (2.0, 0.0), (3.0, 0.0),\n]"),
        (ROWS, &[0, 1, 3], "[\n  (0.0, 0.0), (1.0, 0.0), // row\n  (3.0, 0.0),\n]"),
        (
            ROWS,
            &[9, 0, 1, 2, 3],
            "[\n  (9.0, 0.0),\n  (0.0, 0.0), (1.0, 0.0), // row\n  (2.0, 0.0), (3.0, 0.0),\n]",
        ),
        (
            ROWS,
            &[0, 9, 1, 2, 3],
            "[\n  (0.0, 0.0), (9.0, 0.0), (1.0, 0.0), // row\n  (2.0, 0.0), (3.0, 0.0),\n]",
        ),
        (ROWS, &[], "[]"),
        (PARTS, &[0, 2], "[\n  (0.0, 0.0),\n\n  (2.0, 0.0)\n]"),
        (PARTS, &[1, 2], "[\n  (1.0, 0.0),\n  (2.0, 0.0)\n]"),
        (PARTS, &[0, 1, 2, 3], "[\n  (0.0, 0.0),\n\n  (1.0, 0.0),\n  (2.0, 0.0),\n  (3.0, 0.0),\n]"),
        ("[(0, 0),(1, 0),(2, 0)]", &[0, 1, 9], "[(0, 0),(1, 0),(9.0, 0)]"),
        ("[(0, 0),(1, 0),(2, 0)]", &[9, 0, 1, 2], "[(9.0, 0.0), (0, 0),(1, 0),(2, 0)]"),
        ("[(0, 0), (1, 0),]", &[0, 1, 2], "[(0, 0), (1, 0), (2.0, 0.0),]"),
        ("[(0, 0), (1, 0), ]", &[0], "[(0, 0), ]"),
        ("[(0, 0), /* of\n1 */ (1, 0)]", &[1], "[/* of\n1 */ (1, 0)]"),
        ("[\n  (0, 0), /* of\n1 */\n  (1, 0),\n]", &[1], "[\n /* of\n1 */\n  (1, 0),\n]"),
        ("[ /* none */ ]", &[1], "[(1.0, 0.0), /* none */ ]"),
        ("[\n  // none\n]", &[1], "[\n    (1.0, 0.0),\n  // none\n]"),
    ] {
        let file = |list: &str| format!("(name: \"x\", route: {list})");
        let written = edited(&file(list), |map| {
            map.route = points.iter().map(|&x| (f32::from(x), 0.0)).collect();
        });
        assert_eq!(written, file(expected), "{list} with {points:?}");
    }
}

#[test]
fn top_level_fields_stay_separated_by_blank_lines() {
    let text = "(\n    name: \"x\",\n\n    route: [(0.0, 0.0)],\n    goal: Anywhere, // far\n)\n";
    let change = |map: &mut Map| map.lidar.beams = 30;
    let with_lidar = |text: &str, lidar| text.replace("    goal", &(String::from(lidar) + "    goal"));
    assert_eq!(edited(text, change), with_lidar(text, "\n    lidar: (beams: 30),\n\n"));
    let dense = text.replace("\n\n", "\n");
    assert_eq!(edited(&dense, change), with_lidar(&dense, "    lidar: (beams: 30),\n"));
}

#[test]
fn a_written_field_stays_when_it_becomes_the_default() {
    let text = "(\n    name: \"x\",\n    lidar: (beams: 30),\n)\n";
    assert_eq!(edited(text, |map| map.lidar.beams = 24), text.replace("30", "24"));
}

#[test]
fn an_option_is_replaced_inside_some() {
    let text = "(name: \"x\", goal: At(position_m: (1, 2), heading_rad: Some(0.5 /* left */)))";
    let turn =
        |heading_rad| move |map: &mut Map| map.goal = Goal::At { position_m: Point(1.0, 2.0), heading_rad };
    assert_eq!(edited(text, turn(Some(1.5))), text.replace("0.5", "1.5"));
    assert_eq!(edited(text, turn(None)), text.replace("Some(0.5 /* left */)", "None"));
}

#[test]
fn comments_follow_their_elements_when_others_are_removed_and_inserted() {
    let text = "(name: \"x\", posts: [\n    // a\n    (radius_m: 0.1, position_m: (0.0, 0.0)),\n\
        \x20   // b\n    (radius_m: 0.2, position_m: (1.0, 0.0)),\n\
        \x20   // c\n    (radius_m: 0.3, position_m: (2.0, 0.0)),\n])\n";
    // Remove the first, move the third, append one.
    let written = edited(text, |map| {
        map.posts.remove(0);
        map.posts[1].position_m.0 = 2.5;
        map.posts.push(post(0.15, 9.0));
    });
    assert_eq!(
        written,
        "(name: \"x\", posts: [\n    // b\n    (radius_m: 0.2, position_m: (1.0, 0.0)),\n\
        \x20   // c\n    (radius_m: 0.3, position_m: (2.5, 0.0)),\n\
        \x20   (radius_m: 0.15, position_m: (9.0, 0.0)),\n])\n"
    );
    // A post with a new position is still recognised by its radius.
    let written = edited(text, |map| {
        map.posts.drain(..2);
        map.posts[0].position_m.0 = 2.5;
    });
    assert_eq!(
        written,
        "(name: \"x\", posts: [\n    // c\n    (radius_m: 0.3, position_m: (2.5, 0.0)),\n])\n"
    );
}

#[test]
fn line_endings_follow_the_old_text() {
    let text = "(\r\n    name: \"x\",\r\n    posts: [], // none yet\r\n)\r\n";
    let written = edited(text, |map| map.posts.push(post(0.1, 1.0)));
    assert!(written.contains("posts: [\r\n"), "{written:?}");
    assert_eq!(written.matches('\n').count(), written.matches("\r\n").count(), "{written:?}");
}

#[test]
fn a_text_that_cannot_be_patched_is_replaced_by_the_canonical_text() {
    // ron reads `r#beams` as `beams`. The writer does not, and would add a second field.
    let text = "// mine\n(name: \"x\", lidar: (r#beams: 30))\n";
    assert_eq!(edited(text, |_| {}), text);
    let written = edited(text, |map| map.lidar.beams = 31);
    assert_eq!(written, "(\n    name: \"x\",\n\n    lidar: (beams: 31),\n)\n");
    let map = read("(name: \"x\")");
    for invalid in ["", "(", "(name: 3)"] {
        let written = patch(invalid, &map, &style(), parse);
        assert_eq!(written.as_deref(), Ok("(\n    name: \"x\",\n)\n"), "{invalid:?}");
    }
}
