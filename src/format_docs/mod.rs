//! The references of the file formats in `docs/`, generated from the doc comments and defaults of the types.
//!
//! The tests fail if a page is out of date; `cargo xtask docs` regenerates it.

mod defaults;
mod markdown;
mod schema;

use std::path::Path;

use self::defaults::Read;
use self::schema::{Section, reachable, sections};
use crate::generated_section::check;
use crate::reproduce::Experiment;
use crate::run::folder::RunConfig;
use crate::run::preset::Preset;
use crate::scenario::{LevelGenerator, Scenario, ScenarioSetFile, SuiteFile, parse_ron, to_ron};

const SCENARIO: &[&str] = &["crates/scenario/src/schema.rs"];
const SET: &[&str] = &["crates/scenario/src/set.rs"];
const SUITE: &[&str] = &["crates/scenario/src/suite.rs"];
const LEVEL_GENERATOR: &[&str] = &["crates/scenario/src/levels/schema.rs", "crates/scenario/src/schema.rs"];
const PRESET: &[&str] = &[
    "src/run/preset.rs",
    "src/task/reward.rs",
    "src/task/level_progress.rs",
    "crates/policy/src/observation/mod.rs",
    "crates/policy/src/actions.rs",
    "crates/policy/src/activation.rs",
    "crates/learning/src/config.rs",
];
const EXPERIMENT: &[&str] = &[
    "src/reproduce/experiment.rs",
    "src/reproduce/figure_spec.rs",
    "src/reproduce/table_spec.rs",
    "src/reproduce/claim.rs",
    "src/reproduce/measure.rs",
    "src/run/preset.rs",
    "src/task/reward.rs",
    "src/task/level_progress.rs",
    "crates/policy/src/observation/mod.rs",
    "crates/policy/src/actions.rs",
    "crates/policy/src/activation.rs",
    "crates/learning/src/config.rs",
];

/// Reads a file of the format `T`, and writes it with all fields.
fn read<T: serde::Serialize + serde::de::DeserializeOwned>(text: &str) -> String {
    let value: T = parse_ron(text, text).unwrap_or_else(|error| panic!("{error}"));
    to_ron(&value).expect("RON")
}

fn text(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The types of the format `root` in the `files`.
fn types(root: &str, files: &[&str]) -> Vec<Section> {
    reachable(root, sections(&files.iter().map(|file| text(file)).collect::<Vec<_>>()))
}

fn reference(root: &str, files: &[&str], read: Read, last: Option<&str>) -> String {
    markdown::reference(&types(root, files), read, last)
}

#[test]
fn the_scenario_format_in_the_docs_is_that_of_the_schema() {
    let whole = "Everything in one file";
    let reference = reference("Scenario", SCENARIO, read::<Scenario>, Some(whole));
    let example = text("scenarios/empty.ron");
    let last = format!(
        "\n## {whole}\n\n[`scenarios/empty.ron`](../scenarios/empty.ron), which spells out every field of a scenario with its \
         default:\n\n```ron\n{example}```\n"
    );
    check("docs/scenario-format.md", &(reference + &last));
}

#[test]
fn the_level_generator_format_in_the_docs_is_that_of_the_types() {
    check("docs/generators.md", &reference("LevelGenerator", LEVEL_GENERATOR, read::<LevelGenerator>, None));
}

#[test]
fn the_preset_format_in_the_docs_is_that_of_the_types() {
    let whole = "Everything in one file";
    let reference = reference("Preset", PRESET, read::<Preset>, Some(whole));
    let example = read::<Preset>("()");
    let last = format!(
        "\n## {whole}\n\nEvery field with its default, as a run records it:\n\n```ron\n{example}\n```\n"
    );
    check("docs/preset-format.md", &(reference + &last));
}

#[test]
fn the_format_of_sets_in_the_docs_is_that_of_the_types() {
    let reference = reference("ScenarioSetFile", SET, read::<ScenarioSetFile>, None);
    check("docs/scenario-sets.md", &reference);
}

#[test]
fn the_format_of_suites_in_the_docs_is_that_of_the_types() {
    check("docs/suites.md", &reference("SuiteFile", SUITE, read::<SuiteFile>, None));
}

#[test]
fn the_experiment_format_in_the_docs_is_that_of_the_types() {
    check("docs/experiment-format.md", &reference("Experiment", EXPERIMENT, read::<Experiment>, None));
}

#[test]
fn every_field_of_a_preset_has_a_default() {
    // The fields of a motion in a list have no defaults.
    let is_part = |section: &&Section| section.is_struct() && section.name != "RelativeMotion";
    for section in types("Preset", PRESET).iter().filter(is_part) {
        for entry in &section.groups[0].entries {
            assert!(entry.optional, "{} of {} has no default", entry.name, section.name);
            assert!(!entry.about.is_empty(), "{} of {} has no description", entry.name, section.name);
        }
    }
}

#[test]
fn empty_ron_has_every_field_of_a_scenario_with_a_default() {
    let example = text("scenarios/empty.ron");
    let mut named = 0;
    // Types whose fields all have defaults are the parts that every scenario has.
    for section in types("Scenario", SCENARIO).iter().filter(|section| section.is_struct()) {
        let entries = &section.groups[0].entries;
        let is_part = section.name != "Wall" && entries.iter().all(|entry| entry.optional);
        if section.name == "Scenario" || is_part {
            for entry in entries {
                let spelled = format!("{}: ", entry.name);
                let line = |line: &str| line.split("//").next().is_some_and(|code| code.contains(&spelled));
                let section = &section.name;
                assert!(example.lines().any(line), "scenarios/empty.ron lacks `{}` of {section}", entry.name);
                named += 1;
            }
        }
    }
    assert!(named >= 12 + 3 + 6 + 5 + 3, "only {named} fields were found");
}

/// The RON examples in a page that are whole files.
fn examples(page: &str) -> Vec<String> {
    let page = text(page);
    let blocks = page.split("```ron\n").skip(1).filter_map(|rest| Some(rest.split_once("```")?.0.to_owned()));
    blocks.filter(|block| block.starts_with(['(', '/'])).collect()
}

#[test]
fn the_examples_and_messages_in_the_docs_are_those_of_the_program() {
    let (scenarios, presets) = (examples("docs/scenario-format.md"), examples("docs/preset-format.md"));
    let (experiments, generators) = (examples("docs/experiment-format.md"), examples("docs/generators.md"));
    let randomized = examples("docs/domain-randomization.md");
    let counts = [&scenarios, &presets, &experiments, &generators, &randomized].map(Vec::len);
    assert_eq!(counts, [3, 3, 1, 2, 1]);
    for block in scenarios.into_iter().chain(randomized) {
        Scenario::parse(&block, "example.ron").unwrap_or_else(|error| panic!("{error}\n{block}"));
    }
    for block in generators {
        let generator = LevelGenerator::parse(&block, "docs/generators.md");
        let generator = generator.unwrap_or_else(|error| panic!("{error}\n{block}"));
        assert!((0..20).all(|seed| generator.level(seed).is_ok()), "{block}");
    }
    for block in presets {
        Preset::parse(&block, "docs/preset-format.md").unwrap_or_else(|error| panic!("{error}\n{block}"));
    }
    for block in experiments {
        Experiment::parse(&block, "docs/experiment-format.md")
            .unwrap_or_else(|error| panic!("{error}\n{block}"));
    }
    let mistake = "(\n    name: \"Mine\",\n    robot: (radius_cm: 10.0),\n)";
    let message = Scenario::parse(mistake, "mine.ron").expect_err("there is no such field").to_string();
    assert!(text("docs/scenario-format.md").contains(&message), "the page must show: {message}");
    let mistake = "(\n    learning: (replay: (capcity: 1000)),\n)";
    let message = Preset::parse(mistake, "mine.ron").expect_err("there is no such field").to_string();
    assert!(text("docs/preset-format.md").contains(&message), "the page must show: {message}");
    assert!(!RunConfig::looks_like(mistake), "it is not taken for the configuration of a run");
}

#[test]
fn a_small_format_gives_the_reference_written_by_hand() {
    /// The types of `source`, from which the defaults are read.
    #[derive(serde::Serialize, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Robot {
        #[serde(default = "half")]
        radius_m: f32,
        walls: Vec<Wall>,
        #[serde(default)]
        rate: Rate,
    }
    #[derive(serde::Serialize, serde::Deserialize)]
    struct Wall {
        #[serde(default)]
        name: String,
    }
    #[derive(Default, serde::Serialize, serde::Deserialize)]
    enum Rate {
        Constant(f32),
        Linear {
            from: f32,
            #[serde(default)]
            steps: u32,
        },
        #[default]
        Off,
    }
    fn half() -> f32 {
        0.5
    }
    let source = "//! Sizes.\n/// A robot: round.\n///\n/// See [`Wall`].\nstruct Robot {\n/// Its radius | half\n/// across.\n\
        #[serde(default = \"half\")]\nradius_m: f32,\n/// Around.\nwalls: Vec<Wall>,\n/// How fast.\n#[serde(default)]\nrate: Rate,\n}\n\
        /// A wall.\nstruct Wall {\n/// Its name.\n#[serde(default)]\nname: String,\n}\n\
        /// A rate.\nenum Rate {\n/// Fixed.\nConstant(f32),\n/// Growing.\nLinear {\n/// At first.\nfrom: f32,\n\
        /// How long.\n#[serde(default)]\nsteps: u32,\n},\n/// None.\nOff,\n}\n\
        impl Default for Rate {\n/// No rate.\nfn default() -> Self { todo!() }\n}\nstruct Unused { x: f32 }\n";
    let sections = reachable("Robot", sections(&[source.to_owned()]));
    assert_eq!(
        markdown::reference(&sections, read::<Robot>, Some("The end")),
        "\n## Contents\n\n- [Robot](#robot): a robot\n- [Wall](#wall): a wall\n- [Rate](#rate): a rate\n- [The end](#the-end)\n\
         \n## Robot\n\nA robot: round.\n\nSee `Wall`.\n\n\
         | field | written | default | meaning |\n|---|---|---|---|\n\
         | `radius_m` | number | `0.5` | Its radius \\| half across. |\n\
         | `walls` | list of [wall](#wall)s | must be given | Around. |\n\
         | `rate` | [rate](#rate) | `Off` | How fast. |\n\
         \n## Wall\n\nA wall.\n\n\
         | field | written | default | meaning |\n|---|---|---|---|\n\
         | `name` | text | `\"\"` | Its name. |\n\
         \n## Rate\n\nA rate.\n\n*Default:* No rate.\n\n\
         ### `Constant(number)`\n\nFixed.\n\n\
         ### `Linear`\n\nGrowing.\n\n\
         | field | written | default | meaning |\n|---|---|---|---|\n\
         | `from` | number | must be given | At first. |\n\
         | `steps` | whole number | `0` | How long. |\n\
         \n### `Off`\n\nNone.\n"
    );
}
