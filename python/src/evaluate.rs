//! Evaluations: a policy tested over episodes, as by `wayfield --eval`.

use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use wayfield::limits::MAX_EVAL_EPISODES;
use wayfield::policy::Policy;
use wayfield::run::evaluate::{Evaluation, Evaluator};
use wayfield::run::policy_card;
use wayfield::scenario::Scenario;
use wayfield::task::{EpisodeEnd, EpisodeSetup};

use crate::env_options::{self, scenario as find_scenario};
use crate::errors::{detached, run_error, setting_errors};
use crate::policy::NativePolicy;

/// The control steps between two looks for Ctrl-C.
const STEPS_BETWEEN_SIGNALS: u32 = 50;

/// One episode: how it ended, its steps, the robot's start (m, m, rad), the goal (m) and the seed of its layout.
type EpisodeRow = (&'static str, u32, (f32, f32, f32), (f32, f32), u64);

/// Tests `policy` in `scenario` (its own if `None`). Returns the scenario's name, the evaluation as JSON and the episodes.
#[pyfunction]
#[pyo3(signature = (policy, scenario, settings, seed, episodes, rounds, benchmark_route))]
pub fn evaluate(
    py: Python<'_>,
    policy: PyRef<'_, NativePolicy>,
    scenario: Option<&str>,
    settings: Vec<(String, String)>,
    seed: u64,
    episodes: u64,
    rounds: u64,
    benchmark_route: bool,
) -> PyResult<(String, String, Vec<EpisodeRow>)> {
    let count = episodes.saturating_mul(rounds);
    if !(1..=MAX_EVAL_EPISODES).contains(&count) {
        return Err(PyValueError::new_err(format!(
            "episodes={episodes} with rounds={rounds} is {count} episodes; help: give 1 to {MAX_EVAL_EPISODES} in total"
        )));
    }
    let policy = &policy.policy;
    let mut scenario = match scenario {
        Some(wanted) => find_scenario(wanted)?,
        None => own_scenario(policy)?,
    };
    let settings = env_options::settings(settings);
    settings.apply_to_scenario(&mut scenario).map_err(setting_errors)?;
    let scenario = Arc::new(scenario);
    let setup = if benchmark_route { EpisodeSetup::BenchmarkRoute } else { EpisodeSetup::Random };
    let results = detached(py, || {
        let mut evaluator = Evaluator::new(&scenario, count as usize);
        let mut run = evaluator.start(policy, seed, count as usize, setup).map_err(run_error)?;
        loop {
            for _ in 0..STEPS_BETWEEN_SIGNALS {
                if evaluator.step(&mut run).map_err(run_error)? {
                    return Ok(run.episodes);
                }
            }
            Python::attach(|py| {
                py.check_signals()?;
                PyResult::Ok(())
            })?;
        }
    })?;
    let evaluation = Evaluation::from_episodes(&results, episodes as usize, &scenario.task, seed);
    let json =
        serde_json::to_string(&evaluation).map_err(|error| PyValueError::new_err(error.to_string()))?;
    let rows = results.iter().map(|episode| {
        let end = match episode.end {
            EpisodeEnd::Reached => "goal",
            EpisodeEnd::Collided => "collision",
            EpisodeEnd::TimedOut => "timeout",
        };
        let (start, goal) = (&episode.start, &episode.goal);
        (
            end,
            episode.steps,
            (start.x_m, start.y_m, start.heading_rad),
            (goal.x_m, goal.y_m),
            episode.layout_seed,
        )
    });
    Ok((scenario.name.clone(), json, rows.collect()))
}

/// The scenario that `policy` was trained in, or Scenario I for a policy without a card.
fn own_scenario(policy: &Policy) -> PyResult<Scenario> {
    match policy_card::own_scenario(policy).map_err(run_error)? {
        Some(scenario) => Ok(scenario),
        None => find_scenario("scenario-1"),
    }
}
