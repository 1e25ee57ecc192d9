//! The model card for Hugging Face: a page in Markdown, with front matter in YAML.
//!
//! Every number on it comes from the policy's own card, or from the results of a test. What was not measured is not on it.

use std::fmt::Write as _;

use serde_json::{Value, json};
use wayfield_policy::card::Quantity;
use wayfield_policy::{Card, Policy};

use crate::{EvalResults, ExportError, TrainedScenario, described};

/// A comment in each model card that wayfield has written. The exporter overwrites only pages that contain it.
pub const MODEL_CARD_MARK: &str =
    "<!-- Written by `wayfield --export`. Delete this line to keep your own changes. -->";

/// The model card, in Markdown, of a `policy` that is exported into the file `onnx_file`. It includes the `results` of tests.
///
/// # Errors
/// The policy has no card, or its scenario is unreadable.
pub fn model_card(policy: &Policy, onnx_file: &str, results: &[EvalResults]) -> Result<String, ExportError> {
    let (card, scenario) = described(policy)?;
    let front = front_matter(card, &scenario, onnx_file, results);
    let mut page = format!("---\n{front}---\n\n{MODEL_CARD_MARK}\n\n");
    // Writing to a `String` cannot fail.
    let _ = write_page(&mut page, policy, card, &scenario, onnx_file, results);
    Ok(page)
}

/// The front matter. Values are JSON with YAML's escapes, so untrusted text cannot inject YAML.
fn front_matter(card: &Card, scenario: &TrainedScenario, onnx_file: &str, results: &[EvalResults]) -> String {
    let tags = [
        "reinforcement-learning",
        "deep-reinforcement-learning",
        "robotics",
        "navigation",
        "lidar",
        "onnx",
        "wayfield",
    ];
    let mut fields = vec![
        ("library_name", json!("wayfield")),
        ("pipeline_tag", json!("reinforcement-learning")),
        ("tags", json!(tags)),
    ];
    let mut index: Vec<Value> = results.iter().map(tested).collect();
    // The success rate during training is optimistic, so the results of a test replace it.
    if let (true, Some(rate)) = (index.is_empty(), card.training.success_rate) {
        let name = "success rate in the evaluation that selected the policy";
        index.push(result(&scenario.name, &[metric("success_rate", rate, name)]));
    }
    if !index.is_empty() {
        fields.push(("model-index", json!([{"name": onnx_file, "results": index}])));
    }
    fields.iter().map(|(name, value)| format!("{name}: {}\n", ascii(value))).collect()
}

/// The results of a test, as an entry of the model index.
fn tested(results: &EvalResults) -> Value {
    let EvalResults { episodes, seed, .. } = results;
    let of = |what: &str| format!("{what} over {episodes} episodes, seed {seed}");
    let mut metrics = vec![
        metric("success_rate", results.success_rate, &of("success rate")),
        metric("collision_rate", results.collision_rate, &of("collision rate")),
        metric("timeout_rate", results.timeout_rate, &of("timeout rate")),
    ];
    let time = |time_s| metric("mean_time_s", time_s, &of("mean simulated time of successes in s"));
    metrics.extend(results.mean_time_s.map(time));
    result(&results.scenario, &metrics)
}

fn result(scenario: &str, metrics: &[Value]) -> Value {
    json!({
        "task": {"type": "reinforcement-learning", "name": "reinforcement-learning"},
        "dataset": {"type": "wayfield", "name": scenario},
        "metrics": metrics,
    })
}

fn metric(kind: &str, value: f64, name: &str) -> Value {
    json!({"type": kind, "value": value, "name": name, "verified": false})
}

/// JSON in which all characters beyond ASCII are escaped, because YAML forbids some of them. The escapes are those of YAML, which
/// has one for every character; it would not combine JSON's surrogate pairs.
fn ascii(value: &Value) -> String {
    let mut text = String::new();
    for c in value.to_string().chars() {
        let _ = match u32::from(c) {
            0x20..=0x7e => write!(text, "{c}"),
            code @ ..=0xffff => write!(text, "\\u{code:04x}"),
            code => write!(text, "\\U{code:08x}"),
        };
    }
    text
}

fn write_page(
    page: &mut String,
    policy: &Policy,
    card: &Card,
    scenario: &TrainedScenario,
    onnx_file: &str,
    results: &[EvalResults],
) -> std::fmt::Result {
    let (scenario_name, file) = (escaped(&scenario.name), escaped(onnx_file));
    writeln!(page, "# LIDAR navigation in {scenario_name}\n")?;
    writeln!(
        page,
        "This policy drives a mobile robot with a LIDAR to a goal among obstacles, without a map. It is a Q-network \
         ({}), trained in simulation with wayfield. No test on a real robot is recorded.\n",
        policy.shape()
    )?;
    write_tensors(page, card, scenario)?;
    write_actions(page, card)?;
    write_results(page, results, card.relative_actions.is_some())?;
    write_training(page, card, &scenario_name)?;
    write_use(page, card, scenario, onnx_file)?;
    writeln!(
        page,
        "The metadata of {file} contains the complete policy card as JSON under the key `wayfield`: every input and \
         action, the scenario, and a worked example to verify an implementation."
    )
}

fn write_use(
    page: &mut String,
    card: &Card,
    scenario: &TrainedScenario,
    onnx_file: &str,
) -> std::fmt::Result {
    writeln!(page, "## Use\n\n```python")?;
    if card.observation.is_some() {
        writeln!(page, "import json")?;
    }
    writeln!(page, "import numpy as np\nimport onnxruntime\n")?;
    writeln!(page, "session = onnxruntime.InferenceSession({})", json!(onnx_file))?;
    let mut inputs = Vec::new();
    if card.observation.is_some() {
        writeln!(page, "metadata = session.get_modelmeta().custom_metadata_map[\"wayfield\"]")?;
        writeln!(page, "example = json.loads(metadata)[\"card\"][\"example\"]")?;
        inputs.push(("observation", "np.array([example[\"observation\"]], np.float32)".to_owned()));
    } else {
        let (beams, range_m) = (beams(card), scenario.lidar.max_range_m / 2.0);
        writeln!(page, "ranges = np.full((1, {beams}), {range_m:?}, np.float32)  # m")?;
        writeln!(page, "goal = np.array([[0.5, 2.0]], np.float32)  # bearing in rad, distance in m")?;
        inputs.extend([("ranges", "ranges".to_owned()), ("goal", "goal".to_owned())]);
        let readings = card.count(Quantity::Sensor);
        if readings > 0 {
            inputs.push(("sensor_readings", format!("np.zeros((1, {readings}), np.float32)")));
        }
    }
    if card.relative_actions.is_some() {
        writeln!(page, "# The limits of your robot: speed in m/s, turning rate in rad/s.")?;
        writeln!(page, "highest, lowest = np.array([[[0.5, 1.0]], [[0.0, -1.0]]], np.float32)")?;
        inputs.extend([("highest_motion", "highest".to_owned()), ("lowest_motion", "lowest".to_owned())]);
    }
    let inputs: Vec<String> = inputs.iter().map(|(name, value)| format!("\"{name}\": {value}")).collect();
    writeln!(page, "inputs = {{{}}}", inputs.join(", "))?;
    writeln!(page, "q_values, action, velocity = session.run(None, inputs)")?;
    writeln!(page, "print(velocity)  # m/s, rad/s\n```\n")
}

fn write_tensors(page: &mut String, card: &Card, scenario: &TrainedScenario) -> std::fmt::Result {
    writeln!(page, "## Inputs and outputs\n\n| tensor | shape | meaning |\n|---|---|---|")?;
    if card.observation.is_some() {
        writeln!(
            page,
            "| `observation` | n x {}, f32 | what the robot senses and has sensed before, by sectors around it; computed by \
             wayfield: `Driver.observation` in Python, `SectorObserver` in Rust |",
            card.inputs.len()
        )?;
    } else {
        write_measurements(page, card, scenario)?;
    }
    if card.relative_actions.is_some() {
        for limit in ["highest", "lowest"] {
            writeln!(
                page,
                "| `{limit}_motion` | n x 2, f32 | the robot's {limit} speed in m/s and turning rate in rad/s |"
            )?;
        }
    }
    let actions = card.actions.len();
    writeln!(page, "| `q_values` | n x {actions}, f32 | the Q-value of each action |")?;
    writeln!(page, "| `action` | n, i64 | the best action |")?;
    writeln!(
        page,
        "| `velocity` | n x 2, f32 | the best action's speed in m/s and turning rate in rad/s, left positive; hold it for {} s |\n",
        card.control_period_s
    )
}

/// Writes the rows of the inputs of a policy with the paper's observation.
fn write_measurements(page: &mut String, card: &Card, scenario: &TrainedScenario) -> std::fmt::Result {
    let beams = beams(card);
    let angles: Vec<f32> = card.angles_rad();
    let (first, last) = (angles.first().copied().unwrap_or(0.0), angles.last().copied().unwrap_or(0.0));
    let max_range_m = scenario.lidar.max_range_m;
    writeln!(
        page,
        "| `ranges` | n x {beams}, f32 | LIDAR ranges in m, of beams from {first} to {last} rad, counterclockwise from the \
         heading; ranges beyond {max_range_m} m are clamped to {max_range_m} m |"
    )?;
    writeln!(
        page,
        "| `goal` | n x 2, f32 | bearing of the goal relative to the heading, in rad, left positive, in (-pi, pi]; distance in m |"
    )?;
    for (name, width) in card.sensors() {
        writeln!(
            page,
            "| `sensor_readings` | {width} of its columns, f32 | readings of the sensor {} |",
            escaped(name)
        )?;
    }
    Ok(())
}

fn write_actions(page: &mut String, card: &Card) -> std::fmt::Result {
    if let Some(motions) = &card.relative_actions {
        writeln!(
            page,
            "| action | fraction of the highest speed | fraction of the highest turning rate |\n|---|---|---|"
        )?;
        for (number, motion) in motions.iter().enumerate() {
            writeln!(page, "| {number} | {} | {} |", motion.speed, motion.turn)?;
        }
        return writeln!(
            page,
            "\nNegative fractions are relative to the highest speed backwards and the highest turning rate to the right.\n"
        );
    }
    writeln!(page, "| action | m/s | rad/s |\n|---|---|---|")?;
    for (number, action) in card.actions.iter().enumerate() {
        writeln!(page, "| {number} | {} | {} |", action.v_m_s, action.w_rad_s)?;
    }
    writeln!(page)
}

fn write_results(page: &mut String, results: &[EvalResults], has_relative_actions: bool) -> std::fmt::Result {
    if results.is_empty() {
        return Ok(());
    }
    writeln!(page, "## Evaluation\n\nMeasured by `wayfield --eval`, in simulation.")?;
    if has_relative_actions {
        writeln!(
            page,
            "Unlike the ONNX file, `wayfield --eval` also prevents foreseeable collisions, and keeps the robot from staying in \
             one place."
        )?;
    }
    writeln!(page)?;
    writeln!(page, "| scenario | success (95 %) | collisions | timeouts | mean time | episodes | seed |")?;
    writeln!(page, "|---|---:|---:|---:|---:|---:|---:|")?;
    for test in results {
        let [success, low, high, collisions, timeouts] = [
            test.success_rate,
            test.success_interval[0],
            test.success_interval[1],
            test.collision_rate,
            test.timeout_rate,
        ]
        .map(|fraction| format!("{:.1}", 100.0 * fraction));
        let time = test.mean_time_s.map_or("-".into(), |time_s| format!("{time_s:.1} s"));
        writeln!(
            page,
            "| {} | {success} % ({low} to {high}) | {collisions} % | {timeouts} % | {time} | {} | {} |",
            escaped(&test.scenario),
            test.episodes,
            test.seed
        )?;
    }
    writeln!(page)
}

fn write_training(page: &mut String, card: &Card, scenario_name: &str) -> std::fmt::Result {
    let (program, training) = (&card.program, &card.training);
    writeln!(page, "## Training\n\n| | |\n|---|---|")?;
    let mut row = |name: &str, value: &str| writeln!(page, "| {name} | {} |", escaped(value));
    row("program", &format!("{} {}", program.name, program.version))?;
    row("commit", program.commit.as_deref().unwrap_or("unknown"))?;
    row("scenario", &training.scenario_from)?;
    row("preset", &training.preset)?;
    row("seed", &training.seed.to_string())?;
    row("started from", training.init.as_deref().unwrap_or("random weights"))?;
    row("env steps", &training.env_steps.to_string())?;
    row("gradient steps", &training.gradient_steps.to_string())?;
    match training.success_rate {
        Some(rate) => writeln!(
            page,
            "\nIn the evaluation during training that selected the policy, it reached the goal in {:.1} % of the episodes in \
             {scenario_name}. That evaluation selected the best of several policies, so the rate is optimistic; \
             `wayfield --eval` measures it on other episodes.\n",
            100.0 * rate
        ),
        None => writeln!(page, "\nThe success rate of this policy was not measured.\n"),
    }
}

fn beams(card: &Card) -> usize {
    card.count(Quantity::Range)
}

/// Escapes text for Markdown, and leaves out unprintable characters.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars().filter(|&c| !is_unprintable(c)) {
        if "\\`*_[]<>|&~#!".contains(c) {
            escaped.push('\\');
        }
        escaped.push(c);
    }
    escaped
}

/// Whether `c` should not be printed as it is. The same characters as in the function of this name in `wayfield-scenario`, on
/// which this crate does not depend.
fn is_unprintable(c: char) -> bool {
    c.is_control()
        || u32::from(c) & 0xfffe == 0xfffe
        || matches!(c,
            '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}' | '\u{1160}' | '\u{180e}' | '\u{200b}' | '\u{200e}' | '\u{200f}'
            | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{3164}' | '\u{fdd0}'..='\u{fdef}' | '\u{feff}'
            | '\u{ffa0}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markdown_is_escaped_without_unprintable_characters() {
        let text = "a*\u{ad}b\u{115f}\u{180e}\u{3164}c\n\u{202e}d\u{ffff}\u{1f469}\u{200d}\u{1f680}";
        assert_eq!(escaped(text), "a\\*bcd\u{1f469}\u{200d}\u{1f680}");
    }

    #[test]
    fn front_matter_is_ascii_with_the_escapes_of_yaml() {
        let text = json!("a \"b\"\n\u{7f} \u{e9} \u{1f916}");
        assert_eq!(ascii(&text), r#""a \"b\"\n\u007f \u00e9 \U0001f916""#);
    }
}
