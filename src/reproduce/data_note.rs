//! The amount of data that the arms learned from: whether they are compared on equal data, and over how many seeds.

use super::results::{ArmIndex, Results};
use super::rows::{row_name, trained_rows};
use super::test_point::TestPoint;
use crate::report::format::counted;
use crate::run::RunError;

/// Numbers of env steps or episodes that differ by at most this fraction count as equal.
const TOLERANCE: f64 = 0.01;

/// The data that an arm learned from up to a point, as means over its seeds.
struct Data {
    row: ArmIndex,
    episodes: f64,
    env_steps: f64,
}

/// A note on the data that the arms of an experiment learned from up to `point`: whether the amounts are equal (in env steps
/// or in episodes), and each arm's env steps and episodes.
///
/// # Errors
/// An arm's training is too short to reach `point`. The plan rules this out.
pub fn data_note(results: &Results<'_>, experiment: usize, point: TestPoint) -> Result<String, RunError> {
    let data = trained_rows(results, experiment)
        .into_iter()
        .map(|row| data(results, row, point))
        .collect::<Result<Vec<_>, _>>()?;
    let are_equal = |of: fn(&Data) -> f64| {
        let most = data.iter().map(of).fold(0.0, f64::max);
        data.iter().map(of).all(|amount| most - amount <= TOLERANCE * most)
    };
    let measured: Vec<String> = data
        .iter()
        .map(|arm| {
            let (env_steps, episodes) =
                (counted(arm.env_steps, "env step"), counted(arm.episodes, "episode"));
            format!("{} {env_steps} in {episodes}", row_name(results, arm.row))
        })
        .collect();
    let lead = match data.len() {
        1 => "Learned from",
        _ if are_equal(|arm| arm.env_steps) => "Equal data",
        _ if are_equal(|arm| arm.episodes) => "Equal numbers of episodes, not of env steps",
        _ => "The arms learned from unequal data",
    };
    let transfers: String = data
        .iter()
        .filter(|arm| has_unknown_origin(results, arm.row))
        .map(|arm| transfer_note(results, arm))
        .collect();
    Ok(format!("{lead} (means over the seeds): {}.{transfers}", measured.join("; ")))
}

/// Whether a run of an arm was trained elsewhere and started from a policy whose training is unknown.
fn has_unknown_origin(results: &Results<'_>, row: ArmIndex) -> bool {
    let mut training_runs =
        results.arm_runs(row).flat_map(|(_, run)| &run.stages).map(|stage| results.training(stage.0));
    training_runs.any(|training| training.elsewhere.is_some() && training.config.transfer.is_some())
}

fn transfer_note(results: &Results<'_>, arm: &Data) -> String {
    let name = row_name(results, arm.row);
    format!(" Runs of {name} started from a trained policy, whose training is not counted.")
}

fn data(results: &Results<'_>, row: ArmIndex, point: TestPoint) -> Result<Data, RunError> {
    let (mut episodes, mut env_steps, mut runs) = (0.0, 0.0, 0.0);
    for (_, run) in results.arm_runs(row) {
        let (training, policy) = results.policy(row, run, point)?;
        let before = run.stages.iter().take_while(|(stage, _)| *stage != training);
        let stages = before.map(|&(stage, length)| (stage, results.end(stage, length)));
        for (stage, end) in stages.chain([(training, policy)]) {
            episodes += results.records(stage).episodes(end) as f64;
            env_steps += results.records(stage).env_steps(end) as f64;
        }
        runs += 1.0;
    }
    Ok(Data { row, episodes: episodes / runs, env_steps: env_steps / runs })
}

/// The smallest number of seeds of any trained arm of the experiment.
pub fn fewest_seeds(results: &Results<'_>, experiment: usize) -> usize {
    let rows = trained_rows(results, experiment).into_iter();
    rows.map(|row| results.arm_runs(row).count()).min().unwrap_or(0)
}
