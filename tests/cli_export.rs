//! `--export`: a policy becomes an ONNX file that other programs run, with a model card that has measured numbers only.

mod cli_support;
#[path = "../crates/export/tests/python/mod.rs"]
mod python;

use std::path::Path;

use cli_support::messages::Messages;
use cli_support::{Workspace, quick_fast, raw};
use python::Measurements;
use wayfield::policy::Policy;

const SHIPPED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/policies/scenario-1.safetensors");

/// A workspace with a shipped policy.
fn workspace() -> Workspace {
    let workspace = Workspace::new();
    workspace.write("policy.safetensors", std::fs::read(SHIPPED).expect("the shipped policy"));
    workspace
}

#[test]
fn the_python_program_in_the_documentation_prints_the_documented_output() {
    let Some(python) = python::python() else { return };
    let workspace = workspace();
    let page = include_str!("../docs/onnx.md");
    let block = |start: &str| {
        let after = page.split_once(start).expect("the block").1;
        after.split_once("```").expect("the end of the block").0
    };
    workspace.write("example.py", block("```python\n"));
    let done = workspace.run_ok("--export policy.safetensors --onnx policy.onnx");
    assert_eq!((done.stdout.as_str(), done.stderr.as_str()), ("policy.onnx\nREADME.md\n", ""));
    let printed = python::run(&python, &workspace.path(""), Path::new("example.py"));
    assert_eq!(printed, block("```text\n"));
}

#[test]
fn the_program_on_the_model_card_runs() {
    let Some(python) = python::python() else { return };
    let workspace = workspace();
    workspace.run_ok("--export policy.safetensors --onnx policy.onnx");
    let page = workspace.text("README.md");
    let program =
        page.split_once("```python\n").and_then(|(_, rest)| rest.split_once("```")).expect("a program").0;
    workspace.write("example.py", program);
    let printed = python::run(&python, &workspace.path(""), Path::new("example.py"));
    assert_eq!(printed, "[[0.15 1.5 ]]\n");
}

#[test]
fn the_model_card_lists_the_results_of_tests() {
    let workspace = workspace();
    for scenario in ["scenario-1", "crossing"] {
        let arguments = "--eval policy.safetensors --rounds 2 --episodes 10 --seed 4 --json --scenario";
        let done = workspace.run_ok(&format!("{arguments} {scenario}"));
        workspace.write(&format!("{scenario}.json"), done.stdout);
    }
    workspace.run_ok(
        "--export policy.safetensors --onnx policy.onnx --eval-results scenario-1.json crossing.json",
    );
    let page = workspace.text("README.md");
    let index = page.lines().find_map(|line| line.strip_prefix("model-index: ")).expect("a model index");
    let index: serde_json::Value = serde_json::from_str(index).expect("JSON");
    let results = index[0]["results"].as_array().expect("a list");
    assert_eq!(results.len(), 2, "the success rate from training, which is optimistic, is left out: {index}");
    for (result, file) in results.iter().zip(["scenario-1.json", "crossing.json"]) {
        let test: serde_json::Value = serde_json::from_str(&workspace.text(file)).expect("JSON");
        assert_eq!(result["dataset"]["name"], test["scenario"]);
        for metric in result["metrics"].as_array().expect("a list") {
            assert_eq!(metric["value"], test[metric["type"].as_str().expect("a name")], "{metric}");
            assert_eq!(metric["verified"], false);
            assert!(metric["name"].as_str().is_some_and(|name| name.contains("20 episodes, seed 4")));
        }
        assert!(result["metrics"].as_array().is_some_and(|metrics| metrics.len() >= 3), "{result}");
        let row = format!(
            "| {} | {:.1} % (",
            test["scenario"].as_str().expect("a name"),
            100.0 * test["success_rate"].as_f64().expect("a rate")
        );
        assert!(page.contains(&row), "{row}: {page}");
    }
}

#[test]
fn an_exported_policy_with_raw_observations_gives_the_same_results() {
    let Some(python) = python::python() else { return };
    let workspace = Workspace::new();
    workspace.write("raw.ron", raw(&quick_fast()));
    workspace.run_ok("--train --preset raw.ron --steps 3000 --out run");
    workspace.run_ok("--export run/policy.safetensors --onnx policy.onnx");
    let policy = Policy::from_bytes(&workspace.read("run/policy.safetensors")).expect("a valid policy");
    Measurements::random(&policy, 3.5).assert_parity(&python, &workspace.path(""));
}

#[test]
fn a_readme_written_by_a_person_is_never_overwritten() {
    let workspace = workspace();
    workspace.write("README.md", "mine");
    let done = workspace.run_ok("--export policy.safetensors --onnx policy.onnx");
    assert_eq!(done.stdout, "policy.onnx\n");
    assert!(
        done.stderr.starts_with("note: README.md: not overwritten") && done.stderr.contains("help: "),
        "{done:?}"
    );
    assert_eq!(workspace.text("README.md"), "mine");

    std::fs::remove_file(workspace.path("README.md")).expect("removed");
    workspace.run_ok("--export policy.safetensors --onnx first.onnx");
    workspace.run_ok("--export policy.safetensors --onnx second.onnx");
    assert!(workspace.text("README.md").contains("second.onnx"), "wayfield's own model card is overwritten");
}

#[test]
fn an_onnx_file_in_a_pipe_is_the_same_and_nothing_else_is_written() {
    let workspace = workspace();
    let done =
        workspace.shell("\"$WAYFIELD\" --export policy.safetensors --onnx /dev/stdout | cat > piped.onnx");
    assert_eq!((done.status, done.stderr.as_str()), (Some(0), ""));
    assert!(!workspace.path("README.md").exists());
    workspace.run_ok("--export policy.safetensors --onnx POLICY.ONNX");
    assert_eq!(workspace.read("piped.onnx"), workspace.read("POLICY.ONNX"));
}

#[test]
fn invalid_exports_are_refused_in_one_line() {
    let workspace = workspace();
    let mut old = Policy::from_bytes(&workspace.read("policy.safetensors")).expect("a valid policy");
    old.card = None;
    workspace.write("old.safetensors", old.to_bytes().expect("finite weights"));
    workspace.write("text.safetensors", "not a policy");
    std::fs::create_dir(workspace.path("folder.onnx")).expect("created");
    workspace.write("text.json", "{\"policy\": 1}");
    let eval = "--eval policy.safetensors --rounds 1 --episodes 5 --json";
    let results: serde_json::Value = serde_json::from_str(&workspace.run_ok(eval).stdout).expect("JSON");
    for (file, key, value) in [
        ("rate.json", "success_rate", 1.5.into()),
        ("other.json", "weights_crc32c", "00000000".into()),
        ("map.json", "class", "B".into()),
    ] {
        let mut results = results.clone();
        results[key] = value;
        workspace.write(file, results.to_string());
    }
    let mut messages = Messages::new("export");
    for (comment, arguments) in [
        ("no output file", "--export policy.safetensors"),
        ("another extension", "--export policy.safetensors --onnx policy.pb"),
        ("no such folder", "--export policy.safetensors --onnx no/policy.onnx"),
        ("a folder", "--export policy.safetensors --onnx folder.onnx"),
        ("no such policy", "--export no.safetensors --onnx policy.onnx"),
        ("not a policy", "--export text.safetensors --onnx policy.onnx"),
        ("a policy without a card", "--export old.safetensors --onnx policy.onnx"),
        ("no results of a test", "--export policy.safetensors --onnx policy.onnx --eval-results no.json"),
        ("other JSON", "--export policy.safetensors --onnx policy.onnx --eval-results text.json"),
        ("a rate beyond 1", "--export policy.safetensors --onnx policy.onnx --eval-results rate.json"),
        (
            "results of another policy",
            "--export policy.safetensors --onnx policy.onnx --eval-results other.json",
        ),
        (
            "results of the policy with a map",
            "--export policy.safetensors --onnx policy.onnx --eval-results map.json",
        ),
    ] {
        messages.case(comment);
        messages.line(&workspace, arguments);
    }
    messages.case("options of other modes");
    messages.add(&workspace, "--onnx policy.onnx");
    messages.add(&workspace, "--export policy.safetensors --onnx policy.onnx --json");
    messages.check();
}
