//! The notes below a table: how its numbers were obtained.

use std::collections::BTreeSet;

use crate::report::format::counted;
use crate::report::statistics::small_sample_note;
use crate::reproduce::data_note::{data_note, fewest_seeds};
use crate::reproduce::experiment::{Arm, Experiment, TestedPolicy};
use crate::reproduce::measure::Measure;
use crate::reproduce::policy_test::BENCHMARK_ROUTE_EPISODES;
use crate::reproduce::results::Results;
use crate::reproduce::rows::{seeds, trained_rows};
use crate::reproduce::seeds::seeds_text;
use crate::reproduce::table_spec::{TableKind, TableSpec};
use crate::reproduce::test_point::TestPoint;
use crate::run::RunError;

/// The notes of a table: the test, the intervals, the data, the policies and the measures.
///
/// # Errors
/// An arm's training ends before the point at which the table tests it. Planning rules this out.
pub(super) fn notes(results: &Results<'_>, index: usize, spec: &TableSpec) -> Result<Vec<String>, RunError> {
    let experiment = results.experiment(index);
    let (measures, point): (&[Measure], _) = match &spec.show {
        TableKind::Seeds { measure, after, .. } => (std::slice::from_ref(measure), Some(*after)),
        TableKind::Rounds { after, .. } => (&[Measure::Success], Some(*after)),
        TableKind::Measures { measures, after } => (measures, Some(*after)),
        TableKind::Contrast { measures, after, .. } => (measures, after.is_empty().then_some(None)),
    };
    let point = point.map(TestPoint::overall);
    let mut notes = vec![test_note(results, index, spec, point)];
    notes.extend(small_sample_note(fewest_seeds(results, index)));
    if let Some(point) = point {
        notes.push(data_note(results, index, point)?);
    }
    for arm in trained_arms(results, index).into_iter().filter(|arm| arm.policy == TestedPolicy::Best) {
        notes.push(format!(
            "{}: the best policy of its training, by the evaluations during training.",
            arm.name
        ));
    }
    notes.extend(measure_notes(experiment, measures));
    Ok(notes)
}

/// The trained arms, in the order of the experiment.
fn trained_arms<'a>(results: &Results<'a>, index: usize) -> Vec<&'a Arm> {
    let arms: BTreeSet<usize> = trained_rows(results, index).into_iter().map(|row| row.arm).collect();
    arms.into_iter().map(|arm| &results.experiment(index).arms[arm]).collect()
}

fn test_note(results: &Results<'_>, index: usize, spec: &TableSpec, point: Option<TestPoint>) -> String {
    let after = trained_arms(results, index).iter().any(|arm| arm.policy == TestedPolicy::After);
    let mut note = match point.filter(|_| after) {
        Some(point) => format!("Greedy policy after {}", point.words()),
        None => "Greedy policy".into(),
    };
    let seeds = seeds(results, index);
    note += &format!(", seed{} {}", if seeds.len() == 1 { "" } else { "s" }, seeds_text(&seeds));
    if !matches!(spec.show, TableKind::Rounds { .. }) {
        let n = fewest_seeds(results, index);
        note += &format!("; ± is the 95 % interval of the mean over the seeds (Student's t, n = {n})");
    }
    if matches!(&spec.show, TableKind::Seeds { paper, .. } if !paper.is_empty()) {
        note += "; the paper's value is taken as exact";
    }
    note + "."
}

/// A note for each measure that needs an explanation.
fn measure_notes(experiment: &Experiment, measures: &[Measure]) -> Vec<String> {
    let mut notes = Vec::new();
    if measures.contains(&Measure::Success) {
        notes.push(format!(
            "Success: the fraction of successful episodes. Each seed's policy is tested in {} of {} that it was not \
             trained on.",
            counted(experiment.test.rounds as f64, "round"),
            counted(experiment.test.episodes as f64, "episode")
        ));
    }
    if measures.contains(&Measure::SuccessRate) {
        notes.push(
            "Success in evaluations during training: that of the policy at that time, in the same episodes each time; between \
             two evaluations, interpolated linearly."
                .into(),
        );
    }
    if measures.contains(&Measure::BenchmarkRouteTime) {
        notes.push(format!(
            "Benchmark route: the mean time of {BENCHMARK_ROUTE_EPISODES} episodes of each seed's policy; a failed \
             episode counts as the time limit. Without moving obstacles and noise, all episodes of a policy are equal."
        ));
    }
    if measures.contains(&Measure::MeanTime) {
        notes.push("Mean time: over all test episodes; a failed episode counts as the time limit.".into());
    }
    if measures.contains(&Measure::TimeRatio) {
        notes.push(
            "Time / optimal: the total time of the successful test episodes over the planner's time for the same \
             episodes. If a policy often fails, these are the easy episodes."
                .into(),
        );
    }
    if measures.contains(&Measure::BoundRatio) {
        notes.push(
            "Time / lower bound: the same total time over the proven lower bounds of the optimal time."
                .into(),
        );
    }
    if measures.iter().any(|m| matches!(m, Measure::Return | Measure::Goals)) {
        notes.push(
            "Return, goals: the mean of the last 100 training episodes, which still include exploration."
                .into(),
        );
    }
    if measures.iter().any(|m| matches!(m, Measure::EpisodesTo(_) | Measure::StepsTo(_))) {
        notes.push(
            "Episodes (env steps) to a number of goals per episode: those of the last stage until the moving mean of goals \
             over 50 training episodes reaches that number. \"> n\": some seeds never reached it and count with the length of \
             their run."
                .into(),
        );
    }
    notes
}
