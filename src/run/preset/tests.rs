use super::*;
use crate::learning::Sampling;
use crate::run::shipped;
use crate::scenario::to_ron;

/// A folder with the preset files `files`: name, text.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("temporary folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("the file can be written");
    }
    folder
}

/// The error of the preset file `name`, without the folder's name.
fn error(files: &[(&str, &str)], name: &str) -> String {
    let folder = folder(files);
    let error = Preset::load(folder.path().join(name)).expect_err(name).to_string();
    let path = |path: &Path| format!("{}/", path.display());
    let canonical = folder.path().canonicalize().expect("the folder exists");
    error.replace(&path(&canonical), "").replace(&path(folder.path()), "")
}

#[test]
fn a_file_without_fields_is_the_paper_s_training() {
    let preset = Preset::parse("()", "p.ron").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(preset, Preset::default());
    assert_eq!((preset.arenas, preset.budget), (1, Budget::Episodes(1000)));
    let preset = Preset::parse("(learning: (gamma: 0.5, replay: (capacity: 1000)))", "p.ron");
    let learning = preset.unwrap_or_else(|error| panic!("{error}")).learning;
    assert_eq!((learning.gamma, learning.batch_size, learning.replay.capacity), (0.5, 64, 1000));
}

#[test]
fn dropout_of_predictions_needs_predictions() {
    let found = error(&[("p.ron", "(\n    prediction_dropout: 0.5,\n)")], "p.ron");
    let expected = "p.ron:2:25: `prediction_dropout` needs an observation with predictions; help: ";
    assert!(found.starts_with(expected), "{found}");
    let found = error(&[("p.ron", "(prediction_dropout: 1.5)")], "p.ron");
    assert!(found.contains("`prediction_dropout`") && found.contains("0 to 1"), "{found}");
}

#[test]
fn a_preset_takes_missing_fields_from_the_preset_that_it_is_based_on() {
    let folder = folder(&[
        (
            "base.ron",
            "Preset(based_on: \"fast\", arenas: 8, learning: (gamma: 0.8, network: (hidden: [32])))",
        ),
        (
            "mine.ron",
            "(about: \"mine\", based_on: \"base.ron\", learning: (gamma: 0.9, replay: (sampling: Uniform /* why */)))",
        ),
    ]);
    let mine = Preset::load(folder.path().join("mine.ron")).unwrap_or_else(|error| panic!("{error}"));
    let mut expected = shipped::preset("fast").expect("shipped");
    expected.about = "mine".into();
    expected.arenas = 8;
    expected.learning.gamma = 0.9;
    expected.learning.network.hidden = vec![32];
    expected.learning.replay.sampling = Sampling::Uniform;
    assert_eq!(mine, expected);
    assert!(!to_ron(&mine).expect("RON").contains("based_on"), "a run records the complete preset");
}

#[test]
fn a_folder_with_the_name_of_a_shipped_scenario_does_not_hide_it() {
    let folder = folder(&[("mine.ron", "(scenario: \"hall\")")]);
    std::fs::create_dir(folder.path().join("hall")).expect("a folder");
    let mine = Preset::load(folder.path().join("mine.ron")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(mine.scenario.as_deref(), Some("hall"));
}

#[test]
fn problems_of_presets_that_are_based_on_others_are_located_in_the_right_file() {
    let base = ("base.ron", "(based_on: \"fast\")");
    for (files, expected) in [
        (
            vec![("mine.ron", "(\n    based_on: \"fsat\",\n)")],
            "mine.ron:2:15: `based_on` names no file and no shipped preset: did you mean `fast`? the shipped ones are `fast`, \
             `general`, `dqn`, `per_d3qn`, `per_d3qn_tuned`",
        ),
        (
            vec![("mine.ron", "(based_on: \"other.ron\")"), ("other.ron", "(based_on: \"mine.ron\")")],
            "other.ron:1:12: `based_on` is circular or too long (mine.ron -> other.ron); help: remove the `based_on` of one of \
             them",
        ),
        (
            vec![("mine.ron", "(based_on: \"base.ron\")"), ("base.ron", "(\n    arenas: none)")],
            "base.ron:2:13: `arenas` must be a whole number",
        ),
        (
            vec![("mine.ron", "(based_on: \"base.ron\",\n    learning: (gama: 0.9))"), base],
            "mine.ron:2:16: unknown field `gama` in `learning`: did you mean `gamma`? the fields are `network`, `double`, ",
        ),
        (
            vec![("mine.ron", "(based_on: \"base.ron\",\n    learning: (gamma: 1.5))"), base],
            "mine.ron:2:23: `learning.gamma` is 1.5; help: give 0 to 1",
        ),
        (
            vec![("mine.ron", "(based_on: \"base.ron\",\n    learning: (replay: (capacity: 8)))"), base],
            "mine.ron:2:35: `learning.replay.capacity` is 8",
        ),
    ] {
        let message = error(&files, "mine.ron");
        assert!(message.starts_with(expected), "{message}\nexpected {expected}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
}

#[test]
fn based_on_is_rejected_outside_of_a_preset_s_own_file() {
    let preset = Preset { based_on: Some("fast".into()), ..Preset::default() };
    let found = preset.diagnostics();
    assert_eq!(found.len(), 1);
    assert_eq!(
        found[0].to_string(),
        "`based_on` is only read from a preset's own file; help: remove it here"
    );
}
